/* flip.c - see flip.h.
 *
 * 1. A triangulation is Delaunay if all its triangles turn left and all its edges are locally Delaunay. With
 *    ties broken, it is the canonical one.
 * 2. A flip lowers the surface over the plane that the lifted, perturbed points span. So no triangulation
 *    occurs twice, and the flips end [Lawson 1977; Edelsbrunner 2001, sec. 1.2].
 * 3. An edge that is not locally Delaunay is a diagonal of a strictly convex quadrilateral. So it can always
 *    be flipped, and hull edges never change. */
#include "core/edit/flip.h"

#include "core/constraints/mend.h"
#include "core/exact/predicates.h"
#include "core/mesh/diagonal.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

static bool add_suspect(struct dt_flips *f, uint32_t h)
{
    if (f->suspects == sizeof f->suspect / sizeof *f->suspect)
        return false;
    f->suspect[f->suspects++] = h;
    return true;
}

enum { SPOKES = 16, MET = 4 };

/* Successive spokes of the star of v. Triangle i is (v, u[i + 1], u[i + 2]); beyond[i] is the corner on the other side of its
 * rim edge, or u[i] if that is at infinity. */
struct spokes {
    uint32_t n;
    bool fixed; /* one is: the vertex is an end of a constraint, or constraints run through it */
    uint32_t u[SPOKES + 2], beyond[SPOKES];
    uint32_t h[SPOKES]; /* v->u[i + 1] */
};

/* Lists the next spokes, from h on, and drops those in *s, except u[n] and u[n + 1]. Returns the spoke after them.
 * The way round is a chain of cache misses: a second one, clockwise, meets it half way. The surroundings are fetched. */
static uint32_t next_spokes(const struct dt_mesh *m, const struct dt_point *xy, uint32_t first,
                            uint32_t h, struct spokes *s)
{
    uint32_t n = 0, other = first;
    bool has_fixed = m->fixed != NULL;
    s->u[0] = s->u[s->n];
    s->u[1] = s->u[s->n + 1];
    do {
        uint32_t last = dt_prev(h), twin = dt_twin(m, dt_next(h)), u = dt_origin(m, last);
        dt_fetch(&m->half[dt_base(twin)]);
        dt_fetch(&xy[u]);
        s->h[n] = h;
        s->fixed |= has_fixed && dt_is_fixed(m, h);
        s->beyond[n] = twin;
        s->u[++n + 1] = u;
        h = dt_twin(m, last);
        if (n < MET) {
            other = dt_turn_cw(m, other);
            dt_fetch(&m->half[other]);
        }
    } while (h != first && n < SPOKES);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t beyond = dt_apex_of(m, s->beyond[i]);
        s->beyond[i] = beyond == DT_NONE ? s->u[i] : beyond;
        dt_fetch(&xy[s->beyond[i]]);
    }
    s->n = n;
    return h;
}

/* For the triangle (to, *a, *b) and corners beyond two of its edges: 1 if *c lies in its circle, plus 2 if *d does.
 * The four points are seen from `to`, so both tests share the squares of a and b and their cross product. */
static uint32_t in_circle(struct dt_point to, const struct dt_point *a, const struct dt_point *b,
                          const struct dt_point *c, const struct dt_point *d)
{
    struct dt_lifted p = dt_lift(*a, to), q = dt_lift(*b, to);
    dt_lanes both_c = dt_lanes_load(&c->x), both_d = dt_lanes_load(&d->x);
    dt_lanes x = dt_lanes_first(both_c, both_d) - to.x, y = dt_lanes_second(both_c, both_d) - to.y;
    dt_lanes square = x * x + y * y, qx = q.x * y - q.y * x, xp = x * p.y - y * p.x;
    dt_lanes det = p.square * qx + q.square * xp + square * dt_lifted_cross(p, q);
    dt_lanes most = dt_lanes_most(dt_lanes_both(p.square), dt_lanes_both(q.square));
    most = dt_lanes_most(most, square);
    int in = dt_lanes_bits(det < dt_lanes_both(0));
    if (dt_lanes_bits(dt_lanes_abs(det) > DT_LIFTED_DET_BOUND * (most * most)) != 3)
        in = (dt_incircle_perturbed(to, *a, *b, *c) > 0) |
             (dt_incircle_perturbed(to, *a, *b, *d) > 0) << 1;
    return (uint32_t)in;
}

/* Looks at the triangles of the spokes, and at their edges to the triangles before and beyond. A hull edge may be
 * suspected; it is not flipped. False: the move is not allowed. */
static bool look_at(const struct dt_point *xy, const struct spokes *s, struct dt_point to,
                    struct dt_flips *f)
{
    uint32_t in = 0; /* two bits for each spoke */
    for (uint32_t i = 0; i < s->n; i++) {
        const struct dt_point *p = &xy[s->u[i + 1]], *q = &xy[s->u[i + 2]];
        if (dt_orient2d(*p, *q, to) <= 0)
            return false;
        in |= in_circle(to, p, q, &xy[s->u[i]], &xy[s->beyond[i]]) << 2 * i;
    }
    for (; in != 0; in &= in - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(in), h = s->h[i / 2];
        if (!add_suspect(f, i % 2 == 0 ? h : dt_next(h)))
            return false;
    }
    return true;
}

enum dt_status dt_star_allows(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                              struct dt_point to, bool bound, struct dt_stop *work,
                              struct dt_flips *f, bool *allowed)
{
    enum dt_status status = DT_OK;
    *allowed = !dt_on_hull(m, v);
    f->suspects = f->flipped = 0;
    uint32_t first = m->leaving[v], h = first;
    if (!*allowed)
        return DT_OK;
    struct spokes s;
    s.n = 0;
    s.fixed = false;
    s.u[0] = dt_dest(m, dt_turn_cw(m, h));
    s.u[1] = dt_dest(m, h);
    do {
        h = next_spokes(m, xy, first, h, &s);
        status = dt_work(work, s.n);
        *allowed = status == DT_OK && (bound || !s.fixed) && look_at(xy, &s, to, f);
    } while (*allowed && h != first);
    return status;
}

/* Flips the edge of h and suspects those around it. */
static enum dt_status flip_one(struct dt_mesh *m, struct dt_flips *f, uint32_t h,
                               const struct dt_cavity *scratch)
{
    enum dt_status status = dt_work(scratch->work, 1);
    uint32_t g = dt_twin(m, h);
    if (status == DT_OK && f->flipped == DT_FLIPS)
        status = DT_TOOBIG;
    if (status != DT_OK)
        return status;
    dt_flip_noting(m, h, scratch->changes);
    f->flip[f->flipped++] = h;
    bool room = add_suspect(f, h) && add_suspect(f, dt_next(h)) && add_suspect(f, g) &&
                add_suspect(f, dt_next(g));
    return room ? DT_OK : DT_TOOBIG;
}

enum dt_status dt_flip_all(struct dt_mesh *m, const struct dt_point *xy, struct dt_flips *f,
                           const struct dt_cavity *scratch)
{
    enum dt_status status = DT_OK;
    while (status == DT_OK && f->suspects > 0) {
        uint32_t h = f->suspect[--f->suspects];
        if (dt_must_flip(m, xy, h))
            status = flip_one(m, f, h, scratch);
    }
    while (status != DT_OK && f->flipped > 0)
        dt_flip_back(m, f->flip[--f->flipped]);
    m->recycled = m->recycled || f->flipped > 0;
    return status;
}
