/* value.c - see value.h. */
#include "core/surface/value.h"

#include "core/exact/lanes.h"
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

/* Products may lose bits at the least doubles, 2^-1074. Let s be the sum of both slopes. A side is at least 2^-195, so an area is at
 * least 2^-397, and where s is this steep, the products of which the slopes are quotients add up to 2^-997 or more, and z to 2^-795 or
 * more: what is lost is less than 2^-60 z. */
#define PLANE_STEEP 0x1p-600

/* The corners of a triangle and their values, counterclockwise from the smallest id, where rounding begins. */
struct corners {
    struct dt_point a, b, c;
    double za, zb, zc;
};

/* The ratio of the weights' sum is 1, so only differences to the first value matter. */
static inline struct dt_plane plane_of(const struct corners *t)
{
    struct dt_plane p = {.corner = t->a, .value = t->za};
    double bx = t->b.x - t->a.x, by = t->b.y - t->a.y, cx = t->c.x - t->a.x, cy = t->c.y - t->a.y;
    double area = bx * cy - by * cx, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    double zb = t->zb - t->za, zc = t->zc - t->za;
    dt_lanes rise =
        (dt_lanes){zb, zc} * (dt_lanes){cy, bx} - (dt_lanes){zc, zb} * (dt_lanes){by, cx};
    dt_lanes slope = rise / dt_lanes_both(area);
    p.dx = slope[0];
    p.dy = slope[1];
    p.least = t->za < t->zb ? t->za : t->zb;
    p.least = t->zc < p.least ? t->zc : p.least;
    p.most = t->za > t->zb ? t->za : t->zb;
    p.most = t->zc > p.most ? t->zc : p.most;
    bool missing = isnan(t->za) | isnan(t->zb) | isnan(t->zc);
    if (missing)
        p.value = p.dx = p.dy = (double)NAN;
    double steep = fabs(p.dx) + fabs(p.dy);
    bool level = zb == 0 && zc == 0;
    p.sure = missing || ((bb > cc ? bb : cc) < PLANE_FLAT * area &&
                         ((steep >= PLANE_STEEP && steep < HUGE_VAL) || level));
    return p;
}

static inline double value_in(const struct dt_plane *p, struct dt_point q)
{
    return within(p->value + (p->dx * (q.x - p->corner.x) + p->dy * (q.y - p->corner.y)), p->least,
                  p->most);
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
    double least = HUGE_VAL, most = -HUGE_VAL, sum = 0;
    for (size_t i = 0; i < w->n; i++) {
        double z = dt_value_of_id(v->s, w->id[i]);
        if (isnan(z))
            return z;
        least = z < least ? z : least;
        most = z > most ? z : most;
    }
    /* so that no difference is too large, and no product loses bits at the least doubles */
    double largest = fmax(-least, most);
    double scale = largest > 0x1p1000 ? 0x1p-2 : largest < 0x1p-800 ? 0x1p200 : 1;
    double z0 = dt_value_of_id(v->s, w->id[0]) * scale;
    for (size_t i = 0; i < w->n; i++)
        sum += w->weight[i] * (dt_value_of_id(v->s, w->id[i]) * scale - z0);
    return within((z0 + sum) / scale, least, most);
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
    const struct dt_point *xy = v->t->points.xy;
    const struct dt_mesh *m = &v->t->mesh;
    uint32_t h = dt_weigh_start(v->t, DT_INSIDE, half), a = dt_origin(m, h), b = dt_dest(m, h),
             c = dt_apex_of(m, h);
    struct corners k = {
        xy[a], xy[b], xy[c], dt_value_of(v, a), dt_value_of(v, b), dt_value_of(v, c)};
    struct dt_plane p = plane_of(&k);
    *out = value_in(&p, q);
    return p.sure ? DT_OK : by_weights(v, q, DT_INSIDE, half, out);
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

/* ---- many places ---- */

/* Corners of a triangle, by vertex and id, counterclockwise from the smallest id. */
struct numbered {
    uint32_t vertex[3], id[3];
};

static inline struct numbered number(const struct dt *t, uint32_t half)
{
    const uint32_t *v = t->mesh.half + dt_base(half), *id = t->points.id;
    uint32_t i = id[v[0]], j = id[v[1]], k = id[v[2]];
    uint32_t first = (uint32_t)((j < i) & (j < k)) | (uint32_t)((k < i) & (k < j)) << 1;
    uint32_t second = dt_next(first), third = dt_prev(first);
    return (struct numbered){{v[first], v[second], v[third]},
                             {id[v[first]], id[v[second]], id[v[third]]}};
}

static inline const double *value_place(const struct dt_surface *s, uint32_t id)
{
    static const double missing = (double)NAN;
    uint32_t page = id / DT_FIELD_PAGE;
    return page < s->pages && s->page[page] != NULL ? &s->page[page][id % DT_FIELD_PAGE] : &missing;
}

static enum dt_status look_up(struct dt_valuer *v, struct dt_point q, uint32_t near, double *out)
{
    uint32_t half;
    enum dt_where where = dt_place_find(v->t, q, near, &half);
    return dt_value_at(v, q, where, half, out);
}

/* Whether a place may be on an edge because both have the same y. */
static inline bool is_level(const struct dt_point *a, const struct dt_point *b,
                            const struct dt_point *c, double y)
{
    return (a->y == y) + (b->y == y) + (c->y == y) > 1;
}

/* Fetches the values at the corners. */
static inline void fetch_values(const struct dt_valuer *v, uint32_t half)
{
    const uint32_t *corner = v->t->mesh.half + dt_base(half);
    for (int k = 0; k < 3; k++)
        dt_fetch(value_place(v->s, v->t->points.id[corner[k]]));
}

/* Fetches the values at the corners beyond the edges of n triangles, which are natural neighbours of most places inside. */
static void fetch_beyond(const struct dt_valuer *v, const uint32_t *triangle, uint32_t n)
{
    const struct dt *t = v->t;
    uint32_t apex[3 * DT_AHEAD];
    for (uint32_t i = 0; i < 3 * n; i++) {
        apex[i] = dt_apex_of(&t->mesh, dt_twin(&t->mesh, triangle[i / 3] + i % 3));
        if (apex[i] != DT_NONE) {
            dt_fetch(&t->points.id[apex[i]]);
            dt_fetch(&t->points.xy[apex[i]]);
        }
    }
    for (uint32_t i = 0; i < 3 * n; i++)
        if (apex[i] != DT_NONE)
            dt_fetch(value_place(v->s, t->points.id[apex[i]]));
}

void dt_values_fetch(const struct dt_valuer *v, const struct dt_place *p, size_t n)
{
    const struct dt_mesh *m = &v->t->mesh;
    bool natural = v->s->how == DT_NATURAL || v->s->how == DT_LAPLACE;
    uint32_t triangle[DT_AHEAD], left = 0;
    for (size_t i = 0; i < n; i++)
        if (p[i].near != DT_NONE && !dt_is_ghost(m, p[i].near))
            triangle[left++] = dt_base(p[i].near);
    for (uint32_t i = 0; i < 3 * left; i++) {
        uint32_t h = triangle[i / 3] + i % 3;
        dt_fetch(&v->t->points.id[m->half[h]]);
        if (natural)
            dt_fetch(&m->half[dt_twin(m, h)]);
    }
    for (uint32_t i = 0; i < left; i++)
        fetch_values(v, triangle[i]);
    if (natural)
        fetch_beyond(v, triangle, left);
}

/* The values of n cells of a row; almost without branches that cannot be predicted, so that the loads of many run at once. */
static enum dt_status values_in_planes(struct dt_valuer *v, const uint32_t *half, const double *x,
                                       double y, size_t n, double *out)
{
    const struct dt_point *xy = v->t->points.xy;
    struct dt_plane p = {0};
    uint32_t of_plane = DT_NONE;
    bool sure = false; /* of the plane, and that no cell is on an edge */
    enum dt_status s = DT_OK;
    for (size_t i = 0; s == DT_OK && i < n; i++) {
        if (half[i] == DT_NONE)
            continue;
        if (half[i] != of_plane) {
            struct numbered of = number(v->t, half[i]);
            struct corners k = {xy[of.vertex[0]],
                                xy[of.vertex[1]],
                                xy[of.vertex[2]],
                                *value_place(v->s, of.id[0]),
                                *value_place(v->s, of.id[1]),
                                *value_place(v->s, of.id[2])};
            p = plane_of(&k);
            sure = p.sure && !is_level(&k.a, &k.b, &k.c, y);
            of_plane = half[i];
        }
        struct dt_point q = {x[i], y};
        out[i] = value_in(&p, q);
        if (!sure)
            s = look_up(v, q, half[i], &out[i]);
    }
    return s;
}

/* The same where some triangles have no surface. */
static enum dt_status values_in_triangles(struct dt_valuer *v, const uint32_t *half,
                                          const double *x, double y, size_t n, double *out)
{
    const struct dt_point *xy = v->t->points.xy;
    enum dt_status s = DT_OK;
    for (size_t i = 0; s == DT_OK && i < n; i++) {
        if (half[i] == DT_NONE)
            continue;
        const uint32_t *corner = v->t->mesh.half + dt_base(half[i]);
        struct dt_point q = {x[i], y};
        bool level = is_level(&xy[corner[0]], &xy[corner[1]], &xy[corner[2]], y);
        s = level ? look_up(v, q, half[i], &out[i])
                  : dt_value_at(v, q, DT_INSIDE, half[i], &out[i]);
    }
    return s;
}

enum dt_status dt_values_in_row(struct dt_valuer *v, const uint32_t *half, const double *x,
                                double y, size_t n, double *out)
{
    enum { TOGETHER = 16 };
    enum dt_status s = DT_OK;
    bool planes = v->s->how == DT_LINEAR && v->s->max_edge == HUGE_VAL;
    for (size_t i = 0; s == DT_OK && i < n; i += TOGETHER) {
        size_t m = n - i < TOGETHER ? n - i : TOGETHER;
        for (size_t k = i; k < i + m; k++)
            if (half[k] != DT_NONE)
                fetch_values(v, half[k]);
        s = planes ? values_in_planes(v, half + i, x + i, y, m, out + i)
                   : values_in_triangles(v, half + i, x + i, y, m, out + i);
    }
    return s;
}
