/* value.c - see value.h. */
#include "core/surface/value.h"

#include "core/exact/predicates.h"
#include "core/fields/column.h"
#include "core/query/locate.h"
#include "core/query/nearest.h"

#include <stdlib.h>

enum dt_status dt_surface_begin(struct dt_surface *s, const struct dt_field *f,
                                const struct dt_view *v)
{
    const double *page;
    uint32_t room = f->blocks * DT_FIELD_SLOTS;
    uint64_t id = 0;
    s->pages = 0;
    s->page = calloc(room + 1, sizeof *s->page);
    if (s->page == NULL)
        return DT_NOMEM;
    while (s->pages < room && (page = dt_field_page(f, v, &id)) != NULL) {
        s->page[id / DT_FIELD_PAGE] = page;
        s->pages = (uint32_t)(id / DT_FIELD_PAGE) + 1;
        id += DT_FIELD_PAGE;
    }
    return DT_OK;
}

void dt_surface_end(struct dt_surface *s)
{
    free(s->page);
    s->page = NULL;
    s->pages = 0;
}

enum dt_status dt_valuer_init(struct dt_valuer *v, const struct dt *t, const struct dt_surface *s,
                              struct dt_work *work, uint32_t circles)
{
    *v = (struct dt_valuer){.t = t, .s = s, .work = work, .judged = DT_NONE};
    v->plane.triangle = DT_NONE;
    bool wanted = s->how == DT_NATURAL || s->how == DT_LAPLACE;
    return wanted ? dt_circles_init(&v->circles, circles) : DT_OK;
}

void dt_valuer_clear(struct dt_valuer *v)
{
    dt_circles_clear(&v->circles);
    dt_vicinity_clear(&v->vicinity);
    dt_weigher_clear(&v->weigher);
    free(v->ids.v);
}

/* ---- what has a surface ---- */

static bool is_edge_short(const struct dt_valuer *v, uint32_t half)
{
    const struct dt_point *xy = v->t->points.xy;
    const struct dt_mesh *m = &v->t->mesh;
    return dt_compare_radius(xy[dt_origin(m, half)], xy[dt_dest(m, half)], v->s->max_edge) <= 0;
}

/* Whether the triangle of the half edge has a surface; a ghost has none. */
static bool has_surface(struct dt_valuer *v, uint32_t half)
{
    uint32_t base = dt_base(half);
    if (dt_is_ghost(&v->t->mesh, half))
        return false;
    if (v->s->max_edge == HUGE_VAL)
        return true;
    if (v->judged != base) {
        v->judged = base;
        v->is_short =
            is_edge_short(v, base) && is_edge_short(v, base + 1) && is_edge_short(v, base + 2);
    }
    return v->is_short;
}

/* Whether one of the triangles at the edge does, or the edge itself where all points are on one line. */
static bool edge_has_surface(struct dt_valuer *v, uint32_t half)
{
    uint32_t twin = dt_twin(&v->t->mesh, half);
    if (dt_is_ghost(&v->t->mesh, half) && dt_is_ghost(&v->t->mesh, twin))
        return v->s->max_edge == HUGE_VAL || is_edge_short(v, half);
    return has_surface(v, half) || has_surface(v, twin);
}

/* ---- linear ---- */

static double within(double value, double least, double most)
{
    return value < least ? least : value > most ? most : value;
}

/* Slopes are exact enough unless the triangle is thin. With z the range of its values, m the longer side from the
 * corner and f = m^2 over twice its area, a slope errs by less than z 2 m / area (4 u) and by 1 + 4 f u of itself, so its
 * product with a side by z f 16 u and by what the area's error, 4 f u, makes of the sum of both products, which is
 * at most z: in all by less than 40 f u z, which is less than DT_WEIGHTS_ERROR z. */
#define PLANE_FLAT 128.0

/* The ratio of the weights' sum is 1, so only differences to the first value matter. */
static void make_plane(struct dt_valuer *v, uint32_t half)
{
    const struct dt *t = v->t;
    struct dt_plane *p = &v->plane;
    uint32_t h = dt_weigh_start(t, DT_INSIDE, half), a = dt_origin(&t->mesh, h),
             b = dt_dest(&t->mesh, h), c = dt_apex_of(&t->mesh, h);
    struct dt_point o = t->points.xy[a], to_b = t->points.xy[b], to_c = t->points.xy[c];
    double za = dt_value_of(v, a), zb = dt_value_of(v, b), zc = dt_value_of(v, c);
    double bx = to_b.x - o.x, by = to_b.y - o.y, cx = to_c.x - o.x, cy = to_c.y - o.y;
    double area = bx * cy - by * cx, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    p->triangle = dt_base(half);
    p->corner = o;
    p->value = za;
    p->dx = ((zb - za) * cy - (zc - za) * by) / area;
    p->dy = ((zc - za) * bx - (zb - za) * cx) / area;
    p->least = za < zb ? za : zb;
    p->least = zc < p->least ? zc : p->least;
    p->most = za > zb ? za : zb;
    p->most = zc > p->most ? zc : p->most;
    bool missing = isnan(za) || isnan(zb) || isnan(zc);
    if (missing)
        p->value = p->dx = p->dy = (double)NAN;
    p->sure = missing || ((bb > cc ? bb : cc) < PLANE_FLAT * area && isfinite(p->dx + p->dy));
}

/* ---- by weights ---- */

/* The ends of an edge, from the smaller id. */
static void order_ends(struct dt_weigher *w)
{
    if (w->n != 2 || w->id[0] < w->id[1])
        return;
    uint32_t id = w->id[0];
    double weight = w->weight[0];
    w->id[0] = w->id[1];
    w->weight[0] = w->weight[1];
    w->id[1] = id;
    w->weight[1] = weight;
}

/* The mean by the weights of the weigher's points, in their order. */
static double weighted_mean(const struct dt_valuer *v)
{
    const struct dt_weigher *w = &v->weigher;
    double z0 = (double)NAN, least = HUGE_VAL, most = -HUGE_VAL, sum = 0, plain = 0;
    for (size_t i = 0; i < w->n; i++) {
        double z = dt_value_of_id(v->s, w->id[i]);
        if (isnan(z))
            return z;
        z0 = i == 0 ? z : z0;
        least = z < least ? z : least;
        most = z > most ? z : most;
        sum += w->weight[i] * (z - z0);
        plain += w->weight[i] * z;
    }
    return within(isfinite(z0 + sum) ? z0 + sum : plain, least, most);
}

static enum dt_status by_weights(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                 uint32_t half, double *out)
{
    bool limited = dt_work_is_limited(v->work);
    const atomic_bool *cancel = v->work == NULL ? NULL : v->work->cancel;
    enum dt_status s = dt_weigh_begin(v->t, q, where, half, v->s->how, v->work, &v->weigher);
    if (s == DT_OK)
        s = dt_weigh_end(&v->weigher, limited, cancel);
    if (s != DT_OK)
        return s;
    order_ends(&v->weigher);
    *out = weighted_mean(v);
    return DT_OK;
}

static enum dt_status nearest_value(struct dt_valuer *v, struct dt_point q, uint32_t half,
                                    double *out)
{
    struct dt_place place = {q, half};
    v->ids.n = 0;
    enum dt_status s = dt_nearest_within_work(v->t, &place, 1, v->work, &v->ids);
    if (s == DT_OK)
        *out = dt_value_of_id(v->s, v->ids.v[0]);
    return s;
}

/* ---- a place ---- */

static enum dt_status value_in_plane(struct dt_valuer *v, struct dt_point q, uint32_t half,
                                     double *out)
{
    const struct dt_plane *p = &v->plane;
    if (p->triangle != dt_base(half))
        make_plane(v, half);
    *out = within(p->value + (p->dx * (q.x - p->corner.x) + p->dy * (q.y - p->corner.y)), p->least,
                  p->most);
    return p->sure ? DT_OK : by_weights(v, q, DT_INSIDE, half, out);
}

static enum dt_status natural_value(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                    uint32_t half, double *out)
{
    if (dt_natural_mean(v, q, dt_weigh_start(v->t, where, half), out))
        return DT_OK;
    return by_weights(v, q, where, half, out);
}

static enum dt_status value_inside(struct dt_valuer *v, struct dt_point q, uint32_t half,
                                   double *out)
{
    switch (v->s->how) {
    case DT_CLOSEST:
        return nearest_value(v, q, half, out);
    case DT_LINEAR:
        return value_in_plane(v, q, half, out);
    case DT_NATURAL:
    case DT_LAPLACE:
        break;
    }
    return natural_value(v, q, DT_INSIDE, half, out);
}

static enum dt_status value_on_edge(struct dt_valuer *v, struct dt_point q, uint32_t half,
                                    double *out)
{
    const struct dt_mesh *m = &v->t->mesh;
    bool hull = dt_is_ghost(m, half) || dt_is_ghost(m, dt_twin(m, half));
    if (v->s->how == DT_CLOSEST)
        return nearest_value(v, q, half, out);
    if (v->s->how == DT_LINEAR || hull)
        return by_weights(v, q, DT_ON_EDGE, half, out);
    return natural_value(v, q, DT_ON_EDGE, half, out);
}

enum dt_status dt_value_at(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                           uint32_t half, double *out)
{
    const struct dt_mesh *m = &v->t->mesh;
    *out = (double)NAN;
    switch (where) {
    case DT_OUTSIDE:
        return DT_OK;
    case DT_ON_VERTEX:
        *out = dt_value_of(v, half == DT_NONE ? m->alone : dt_origin(m, half));
        return DT_OK;
    case DT_ON_EDGE:
        return edge_has_surface(v, half) ? value_on_edge(v, q, half, out) : DT_OK;
    case DT_INSIDE:
        break;
    }
    return has_surface(v, half) ? value_inside(v, q, half, out) : DT_OK;
}
