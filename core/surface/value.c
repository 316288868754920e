/* value.c - see value.h. */
#include "core/surface/value.h"

#include "core/exact/predicates.h"
#include "core/fields/column.h"
#include "core/mesh/fixed.h"
#include "core/query/nearest.h"
#include "core/query/query.h"

#include <stdlib.h>
#include <string.h>

enum dt_status dt_surface_begin(struct dt_surface *s, const struct dt_field *f,
                                const struct dt_view *v)
{
    const double *page;
    size_t room = (f->blocks * (size_t)DT_FIELD_SLOTS) |
                  1; /* odd: doubles follow an even number of pointers */
    uint64_t id = 0;
    double *missing;
    s->pages = 0;
    s->page = malloc((room + 1) * sizeof *s->page + DT_FIELD_PAGE * sizeof *missing);
    if (s->page == NULL)
        return DT_NOMEM;
    missing = (double *)(void *)(s->page + room + 1);
    for (uint32_t i = 0; i < DT_FIELD_PAGE; i++)
        missing[i] = (double)NAN;
    for (uint32_t i = 0; i <= room; i++)
        s->page[i] = missing;
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

static bool is_natural(const struct dt_valuer *v)
{
    return v->s->how == DT_NATURAL || v->s->how == DT_LAPLACE;
}

enum { FEW_SLOPES = 256, MANY_SLOPES = 1 << 14 }; /* that are kept */

/* The number of surfaces. */
static uint32_t surfaces_of(const struct dt_valuer *v)
{
    uint32_t n = 0;
    for (const struct dt_surface *k = v->s; k != NULL; k = k->next)
        n++;
    return n;
}

/* Makes smoothers, which keep about this many slopes together. */
static enum dt_status keep_slopes(struct dt_valuer *v, uint32_t slopes)
{
    uint32_t surfaces = surfaces_of(v);
    while (slopes > 1 && slopes > MANY_SLOPES / surfaces)
        slopes /= 2;
    dt_smoothers_free(v->smoother);
    v->smoother = dt_smoothers_new(slopes, surfaces);
    return v->smoother == NULL ? DT_NOMEM : DT_OK;
}

enum dt_status dt_valuer_init(struct dt_valuer *v, const struct dt *t, const struct dt_surface *s,
                              const struct dt_options *opt)
{
    *v = (struct dt_valuer){.t = t,
                            .s = s,
                            .work = dt_stop_of(opt),
                            .sloped = DT_NONE,
                            .judged = DT_NONE,
                            .edge.ghost = DT_NONE};
    for (const struct dt_surface *k = s; k != NULL; k = k->next)
        v->numbers += dt_surface_numbers(k);
    enum dt_status status = is_natural(v) ? dt_readable_delaunay(t) : dt_readable(t);
    if (status == DT_OK && s->how == DT_SMOOTH)
        status = keep_slopes(v, FEW_SLOPES);
    return status == DT_OK && s->inside ? dt_enclosure_of(t, s->number, &v->enclosure) : status;
}

enum dt_status dt_valuer_scan(struct dt_valuer *v, size_t n)
{
    enum { WORTH = 1000 }; /* places for which blocks are fetched */
    if (n >= WORTH) {
        v->fetched = malloc(2 * DT_BLOCKS * sizeof *v->fetched);
        if (v->fetched == NULL)
            return DT_NOMEM;
        memset(v->fetched, 0xff, 2 * DT_BLOCKS * sizeof *v->fetched);
    }
    if (v->s->how == DT_SMOOTH && n >= WORTH && keep_slopes(v, MANY_SLOPES) != DT_OK)
        return DT_NOMEM;
    return is_natural(v) ? dt_natural_keep(v, n) : DT_OK;
}

void dt_valuer_clear(struct dt_valuer *v)
{
    free(v->circle);
    free(v->fetched);
    dt_smoothers_free(v->smoother);
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

/* Whether the triangle is inside the borders at which the surface ends. */
static bool is_inside(const struct dt_valuer *v, uint32_t half)
{
    return !v->s->inside || dt_encloses(&v->enclosure, dt_face(&v->t->mesh, half));
}

/* Whether a triangle at the origin of the half edge is. */
static bool is_vertex_inside(const struct dt_valuer *v, uint32_t half)
{
    bool inside = !v->s->inside;
    for (uint32_t h = half; !inside && h != DT_NONE;) {
        inside = is_inside(v, h);
        h = dt_turn_ccw(&v->t->mesh, h);
        h = h == half ? DT_NONE : h;
    }
    return inside;
}

bool dt_has_surface(struct dt_valuer *v, uint32_t half)
{
    uint32_t base = dt_base(half);
    if (dt_is_ghost(&v->t->mesh, half) || !is_inside(v, half))
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
        return !v->s->inside && (v->s->max_edge == HUGE_VAL || is_edge_short(v, half));
    return dt_has_surface(v, half) || dt_has_surface(v, twin);
}

static double within(double value, double least, double most)
{
    return value < least ? least : value > most ? most : value;
}

/* ---- by weights ---- */

/* The mean by the weights of the weigher's points, in their order. Values are scaled where their differences may be too
 * large, or products may lose bits at the least doubles. */
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
    double largest = fmax(-least, most);
    double scale = largest > DT_MEAN_MOST ? 0x1p-2 : largest < DT_MEAN_LEAST ? 0x1p200 : 1;
    double z0 = dt_value_of_id(v->s, w->id[0]) * scale;
    for (size_t i = 0; i < w->n; i++)
        sum += w->weight[i] * (dt_value_of_id(v->s, w->id[i]) * scale - z0);
    return within((z0 + sum) / scale, least, most);
}

enum { LONG_WORK = 8 }; /* what weights in double words take for a step of the tour */

static enum dt_status by_weights(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                 uint32_t half, enum dt_interpolation how, double *out)
{
    enum dt_status s = dt_weigh_begin(v->t, q, where, half, how, &v->work, &v->weigher);
    if (s == DT_OK)
        s = dt_weigh_end(&v->weigher, &v->work);
    if (s == DT_OK && v->weigher.long_doubles)
        s = dt_work(&v->work, LONG_WORK * (uint64_t)v->weigher.steps);
    if (s == DT_OK)
        *out = weighted_mean(v);
    return s;
}

/* Linear where smooth values are beyond the range of doubles. */
static enum dt_status smooth_value(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                   uint32_t half, double *out)
{
    enum dt_status s = where == DT_ON_EDGE ? by_weights(v, q, where, half, DT_LINEAR, out) : DT_OK;
    if (s == DT_OK && where == DT_ON_EDGE)
        s = dt_smooth_on_edge(v, half, v->weigher.weight, out);
    else if (s == DT_OK)
        s = dt_smooth_value(v, q, half, out);
    return s == DT_OK && isinf(*out) ? by_weights(v, q, where, half, DT_LINEAR, out) : s;
}

static enum dt_status nearest_value(struct dt_valuer *v, struct dt_point q, uint32_t half,
                                    double *out)
{
    struct dt_place place = {q, half};
    v->ids.n = 0;
    enum dt_status s = dt_nearest_within_work(v->t, &place, 1, &v->work, &v->ids);
    if (s == DT_OK)
        *out = dt_value_of_id(v->s, v->ids.v[0]);
    return s;
}

/* ---- a place ---- */

/* False: doubles are not exact enough, or the place is on an edge and linear along it. */
static inline bool value_in_doubles(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                    uint32_t half, double *out)
{
    if (dt_weigh_along_edge(v->t, where, half, v->s->how))
        return false;
    if (v->s->how == DT_LINEAR)
        return dt_plane_value(v, q, half, out);
    return dt_natural_mean(v, q, dt_weigh_start(v->t, where, half), out);
}

static inline enum dt_status value_at(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                      uint32_t half, double *out)
{
    const struct dt_mesh *m = &v->t->mesh;
    *out = (double)NAN;
    switch (where) {
    case DT_OUTSIDE:
        return DT_OK;
    case DT_ON_VERTEX:
        if (is_vertex_inside(v, half))
            *out = dt_value_of(v, half == DT_NONE ? m->alone : dt_origin(m, half));
        return DT_OK;
    case DT_ON_EDGE:
        if (!edge_has_surface(v, half))
            return DT_OK;
        break;
    case DT_INSIDE:
        if (!dt_has_surface(v, half))
            return DT_OK;
        break;
    }
    if (v->s->how == DT_CLOSEST)
        return nearest_value(v, q, half, out);
    if (v->s->how == DT_SMOOTH)
        return smooth_value(v, q, where, half, out);
    return value_in_doubles(v, q, where, half, out) ? DT_OK
                                                    : by_weights(v, q, where, half, v->s->how, out);
}

/* ---- outside the hull ---- */

/* The value inside of the hull's edge of the ghost, at the place nearest to q. */
static enum dt_status value_at_foot(struct dt_valuer *v, struct dt_point q, uint32_t ghost,
                                    double *out)
{
    *out = (double)NAN;
    if (!edge_has_surface(v, ghost))
        return DT_OK;
    if (v->s->how == DT_CLOSEST)
        return nearest_value(v, q, ghost, out);
    enum dt_status s = dt_weigh_foot(v->t, q, ghost, &v->weigher);
    if (s == DT_OK && v->s->how == DT_SMOOTH)
        s = dt_smooth_on_edge(v, ghost, v->weigher.weight, out);
    if (s == DT_OK && (v->s->how != DT_SMOOTH || isinf(*out)))
        *out = weighted_mean(v);
    return s;
}

/* *half: as dt_place_find has found. */
static enum dt_status value_outside(struct dt_valuer *v, struct dt_point q, uint32_t *half,
                                    double *out)
{
    bool corner;
    *out = (double)NAN;
    if (v->t->mesh.vertices == 0)
        return DT_OK;
    if (*half == DT_NONE)
        return value_at(v, q, DT_ON_VERTEX, DT_NONE, out);
    *half = dt_base(*half);
    enum dt_status s = dt_foot_find(v, q, half, &corner);
    if (s != DT_OK)
        return s;
    return corner ? value_at(v, q, DT_ON_VERTEX, *half + 1, out) : value_at_foot(v, q, *half, out);
}

/* The same for a place near the ghost; false: it may not be outside the ghost's edge. */
static bool value_near_ghost(struct dt_valuer *v, struct dt_point q, uint32_t *ghost, double *out,
                             enum dt_status *s)
{
    bool planes = v->s->how < DT_CLOSEST && v->s->max_edge == HUGE_VAL && !v->s->inside;
    *s = DT_OK;
    if (planes && dt_foot_value(v, q, *ghost, out))
        return true;
    if (!dt_foot_sees(v->t, *ghost, q))
        return false;
    *s = value_outside(v, q, ghost, out);
    return true;
}

enum dt_status dt_value_there(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                              uint32_t half, double *out)
{
    return value_at(v, q, where, half, out);
}

/* Values are scaled where their difference may be too large, or where products may lose bits at the least doubles. */
static double between(double from, double to, struct dt_double2 share)
{
    double size = fmax(fabs(from), fabs(to));
    double scale = size > 0x1p900 ? 0x1p-200 : size < 0x1p-700 ? 0x1p300 : 1;
    struct dt_double2 range = dt_double2_difference(to * scale, from * scale);
    struct dt_double2 value =
        dt_double2_add((struct dt_double2){from * scale, 0}, dt_double2_multiply(share, range));
    return within(value.hi / scale, fmin(from, to), fmax(from, to)) + 0.0;
}

double dt_value_along(struct dt_valuer *v, uint32_t half, struct dt_double2 share)
{
    const struct dt_mesh *m = &v->t->mesh;
    double from = dt_value_of(v, dt_origin(m, half)), to = dt_value_of(v, dt_dest(m, half));
    if (isnan(from) || isnan(to) || !edge_has_surface(v, half))
        return (double)NAN;
    return between(from, to, share);
}

/* The numbers of the surface v->s at a place that dt_place_find has found, not beyond the hull. */
static enum dt_status value_found(struct dt_valuer *v, struct dt_point q, enum dt_where where,
                                  uint32_t half, double *out)
{
    return v->s->quantity == DT_HEIGHT ? value_at(v, q, where, half, out)
                                       : dt_slope_at(v, where, half, out);
}

/* The numbers of the surface v->s. *where: as dt_place_find has found. */
static enum dt_status find_value(struct dt_valuer *v, struct dt_point q, uint32_t *half,
                                 enum dt_where *where, double *out)
{
    enum dt_status s;
    bool beyond = v->s->beyond && v->s->quantity == DT_HEIGHT;
    *where = DT_OUTSIDE;
    if (beyond && *half != DT_NONE && dt_is_ghost(&v->t->mesh, *half)) {
        *half = dt_base(*half);
        if (value_near_ghost(v, q, half, out, &s))
            return s;
    }
    *where = dt_place_find(v->t, q, *half, half);
    if (*where == DT_OUTSIDE && beyond)
        return value_outside(v, q, half, out);
    return value_found(v, q, *where, *half, out);
}

/* Makes the surface after the last one, or the first one, the one whose numbers are computed. */
static void choose(struct dt_valuer *v, const struct dt_surface *s)
{
    v->s = s;
    v->edge.ghost = DT_NONE; /* it has values of the other one */
    if (v->smoother != NULL)
        v->smoother = dt_smoother_next(v->smoother);
}

enum dt_status dt_value_find(struct dt_valuer *v, struct dt_point q, uint32_t *half, double *out)
{
    const struct dt_surface *first = v->s;
    enum dt_where where;
    enum dt_status s = find_value(v, q, half, &where, out);
    if (first->next == NULL)
        return s;
    for (const struct dt_surface *k = first->next; k != NULL; k = k->next) {
        out += dt_surface_numbers(v->s);
        choose(v, k);
        if (s == DT_OK)
            s = where == DT_OUTSIDE ? find_value(v, q, half, &where, out)
                                    : value_found(v, q, where, *half, out);
    }
    choose(v, first);
    return s;
}

/* ---- many places ---- */

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
    for (const struct dt_surface *s = v->s; s != NULL; s = s->next)
        for (int k = 0; k < 3; k++)
            dt_fetch(dt_value_place(s, v->t->points.id[corner[k]]));
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
    for (const struct dt_surface *s = v->s; s != NULL; s = s->next)
        for (uint32_t i = 0; i < 3 * n; i++)
            if (apex[i] != DT_NONE)
                dt_fetch(dt_value_place(s, t->points.id[apex[i]]));
}

void dt_values_fetch(const struct dt_valuer *v, const struct dt_place *p, size_t n)
{
    const struct dt_mesh *m = &v->t->mesh;
    bool natural = is_natural(v);
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

/* The values of cells in triangles that may have no surface. Returns the cells that may be on an edge. */
static uint64_t values_in_triangles(struct dt_valuer *v, const uint32_t *half, const double *x,
                                    double y, uint32_t n, double *out, enum dt_status *s)
{
    const struct dt_point *xy = v->t->points.xy;
    uint64_t doubtful = 0;
    for (uint32_t i = 0; *s == DT_OK && i < n; i++) {
        const uint32_t *corner = v->t->mesh.half + dt_base(half[i]);
        struct dt_point q = {x[i], y};
        if (is_level(&xy[corner[0]], &xy[corner[1]], &xy[corner[2]], y))
            doubtful |= (uint64_t)1 << i;
        else if (v->s->quantity == DT_HEIGHT)
            *s = value_at(v, q, DT_INSIDE, half[i], &out[i]);
        else
            *s = dt_slope_at(v, DT_INSIDE, half[i], &out[i * dt_surface_numbers(v->s)]);
    }
    return doubtful;
}

/* The numbers of the surface v->s in a row. */
static enum dt_status one_in_row(struct dt_valuer *v, const uint32_t *half, const double *x,
                                 double y, uint32_t n, double *out)
{
    enum dt_status s = DT_OK;
    enum dt_where where = DT_INSIDE;
    uint32_t numbers = dt_surface_numbers(v->s);
    bool planes = v->s->how == DT_LINEAR && v->s->max_edge == HUGE_VAL && !v->s->inside &&
                  v->s->quantity == DT_HEIGHT;
    uint64_t doubtful = planes ? dt_plane_values(v, half, x, y, n, out)
                               : values_in_triangles(v, half, x, y, n, out, &s);
    for (uint32_t i = 0; s == DT_OK && doubtful != 0 && i < n; i++)
        if (doubtful >> i & 1)
            s = find_value(v, (struct dt_point){x[i], y}, &(uint32_t){half[i]}, &where,
                           &out[i * numbers]);
    return s;
}

/* Puts the numbers of n places of one surface among the numbers of all. */
static inline void spread(const struct dt_valuer *v, const double *number, uint32_t n, double *out)
{
    const size_t step = v->numbers, numbers = dt_surface_numbers(v->s);
    for (uint32_t k = 0; k < numbers; k++)
        for (uint32_t i = 0; i < n; i++)
            out[i * step + k] = number[i * numbers + k];
}

enum dt_status dt_values_in_row(struct dt_valuer *v, const uint32_t *half, const double *x,
                                double y, uint32_t n, double *out)
{
    const struct dt_surface *first = v->s;
    enum dt_status s = DT_OK;
    double number[2 * DT_ROOM];
    if (v->numbers == 1)
        return one_in_row(v, half, x, y, n, out);
    for (const struct dt_surface *k = first; k != NULL; k = k->next) {
        if (s == DT_OK)
            s = one_in_row(v, half, x, y, n, number);
        if (s == DT_OK)
            spread(v, number, n, out);
        out += dt_surface_numbers(k);
        choose(v, k->next != NULL ? k->next : first);
    }
    return s;
}

/* ---- prefetches by blocks ---- */

void dt_fetch_triangles(struct dt_valuer *v, uint32_t block)
{
    const struct dt_mesh *m = &v->t->mesh;
    uint32_t first = block * DT_BLOCK_TRIANGLES;
    v->fetched[block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < first + DT_BLOCK_TRIANGLES && i < m->tri_end; i += 2)
        dt_fetch(&m->half[8 * i]);
}

void dt_fetch_vertices(struct dt_valuer *v, uint32_t block)
{
    const struct dt_points *p = &v->t->points;
    uint32_t first = block * DT_BLOCK_VERTICES, next = first + DT_BLOCK_VERTICES;
    v->fetched[DT_BLOCKS + block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < next && i < p->end; i += 4)
        dt_fetch(&p->xy[i]);
    for (const struct dt_surface *s = v->s; s != NULL; s = s->next)
        for (uint32_t i = first; i < next && i < p->end; i++)
            dt_fetch(dt_value_place(s, p->id[i]));
    for (uint32_t i = next; i < next + DT_BLOCK_VERTICES && i < p->end; i += 16)
        dt_fetch(&p->id[i]);
}
