/* natural.c - means of natural neighbours in doubles, in one pass: the tour of tour.h without recording it.
 *
 * Let c(T) be the circumcentres of the triangles of the disc and r(i) those of the rim edges v(i) v(i+1) with q. Each
 * edge a b between two triangles S and T of the disc adds c(S) x c(T) to the part of a's cell, and takes it from b's;
 * each rim edge a b of T does so with c(T) x r; and r(i) x r(i-1) is added to the part of v(i). So the mean of the
 * values z is, with z0 that of v(0),
 *
 *     z0 + (sum c(S) x c(T) (z(a) - z(b)) + sum c(T) x r(i) (z(v(i)) - z(v(i+1))) + sum r(i) x r(i-1) (z(v(i)) - z0))
 *          / sum r(i) x r(i-1)
 *
 * with errors as in weights_formula.h: those of the first two sums count for two points each. For Laplace's mean,
 * the edges between r(i-1) and r(i) are enough. */
#include "core/surface/value.h"

#define MOST 96 /* triangles of a disc; nearly all have fewer than ten */

struct crossing {
    uint32_t half; /* of the disc, to be crossed */
    uint32_t from; /* its triangle, by its number in the disc */
};

struct rim {
    struct dt_point at; /* a vertex, relative to q */
    double square;      /* its distance, squared */
    double z;
};

struct mean {
    double sum;   /* of shares by how far the values are from z0 */
    double whole; /* the sum of the shares */
    double error,
        size; /* of the shares: of all their terms, and the sum of the terms' magnitudes */
    double z0, least, most;
    bool missing; /* a value is nan */
};

static inline void note_value(struct mean *m, double z)
{
    m->least = z < m->least ? z : m->least;
    m->most = z > m->most ? z : m->most;
    m->missing |= z != z;
}

/* a x b is a term of the shares of so many points. */
static inline double term(struct mean *m, const struct dt_centre *a, const struct dt_centre *b,
                          double points)
{
    m->error += points * (a->length * b->error + b->length * a->error + a->error * b->error);
    m->size += points * (a->length * b->length);
    return a->x * b->y - a->y * b->x;
}

/* Adds the share of a rim vertex, the cell's corners before and after it. */
static inline void add_share(struct mean *m, bool sibson, const struct rim *v,
                             const struct dt_centre *before, const struct dt_centre *after)
{
    double share;
    if (sibson) {
        share = term(m, after, before, 1);
    } else {
        double x = before->x - after->x, y = before->y - after->y, inverse = 1 / v->square;
        double over = (fabs(v->at.x) + fabs(v->at.y)) * inverse;
        double ends = before->error + after->error;
        share = (x * v->at.y - y * v->at.x) * inverse;
        m->error += 1.01 * ends * over;
        m->size += (fabs(x) + fabs(y) + ends) * over;
    }
    m->whole += share;
    m->sum += share * (v->z - m->z0);
}

static inline struct rim rim_at(const struct dt_valuer *v, uint32_t vertex, struct dt_point q)
{
    struct dt_point p = v->t->points.xy[vertex], at = {p.x - q.x, p.y - q.y};
    return (struct rim){at, at.x * at.x + at.y * at.y, dt_value_of(v, vertex)};
}

/* Whether the shares' errors add up to less than DT_WEIGHTS_ERROR, and no product of a share and a difference of values loses
 * bits at the least doubles. steps: how many terms a share may have. */
static inline bool is_sure(const struct mean *m, bool sibson, uint32_t steps)
{
    if (!((m->most - m->least) * fabs(m->whole) >= 0x1p-1000) && m->most != m->least)
        return false;
    double rounding = ((sibson ? 8 : 16) + steps) * DT_U * m->size;
    return m->error + rounding < DT_WEIGHTS_ERROR / 2 * fabs(m->whole);
}

static inline bool mean_of(struct dt_valuer *v, struct dt_point q, uint32_t first, bool sibson,
                           double *out)
{
    const struct dt *t = v->t;
    const struct dt_mesh *mesh = &t->mesh;
    struct dt_centre in[MOST], before = {0}, after, begin = {0};
    struct crossing todo[MOST + 3];
    uint32_t inside = 1, left = 3, rims = 0;
    struct rim start = rim_at(v, dt_origin(mesh, first), q), here = start;
    struct mean m = {
        .z0 = start.z, .least = start.z, .most = start.z, .missing = start.z != start.z};
    in[0] = dt_centre_from(dt_circle_of(&v->circles, t, dt_base(first)), q);
    todo[0] = (struct crossing){dt_prev(first), 0};
    todo[1] = (struct crossing){dt_next(first), 0};
    todo[2] = (struct crossing){first, 0};
    while (left > 0) {
        struct crossing c = todo[--left];
        uint32_t beyond = dt_twin(mesh, c.half);
        const struct dt_centre *from = &in[c.from];
        dt_vicinity_enter(&v->vicinity, t, beyond);
        struct rim there = rim_at(v, dt_dest(mesh, c.half), q);
        if (!dt_is_ghost(mesh, beyond) &&
            dt_circle_contains(dt_circle_of(&v->circles, t, dt_base(beyond)), t, q, &in[inside])) {
            if (sibson)
                m.sum += term(&m, from, &in[inside], 2) * (here.z - there.z);
            todo[left++] = (struct crossing){dt_prev(beyond), inside};
            todo[left++] = (struct crossing){dt_next(beyond), inside};
            if (++inside == MOST)
                return false;
            continue;
        }
        after = dt_centre_at(here.at, there.at, here.square, there.square);
        if (sibson)
            m.sum += term(&m, from, &after, 2) * (here.z - there.z);
        if (rims++ == 0)
            begin = after;
        else
            add_share(&m, sibson, &here, &before, &after);
        before = after;
        here = there;
        note_value(&m, there.z);
    }
    add_share(&m, sibson, &start, &before, &begin);
    if (!is_sure(&m, sibson, 3 * (inside + rims)))
        return false;
    double mean = m.z0 + m.sum / m.whole;
    *out = mean < m.least ? m.least : mean > m.most ? m.most : mean;
    if (m.missing)
        *out = (double)NAN;
    return m.missing || isfinite(mean);
}

bool dt_natural_mean(struct dt_valuer *v, struct dt_point q, uint32_t first, double *out)
{
    return v->s->how == DT_NATURAL ? mean_of(v, q, first, true, out)
                                   : mean_of(v, q, first, false, out);
}
