/* places.c - the triangles and the values at many places. Walks go side by side (prefetch.h), pieces on several threads. */
#include <stdlib.h>
#include <string.h>

#include "core/arrays/arrays.h"
#include "core/arrays/workers.h"
#include "core/exact/predicates.h"
#include "core/query/locate.h"
#include "core/query/prefetch.h"
#include "core/query/query.h"
#include "core/surface/value.h"

struct places {
    const struct dt_arrays *a;
    const struct dt_point *q;
    double tol;
    /* of a question for triangles */
    uint32_t *row;
    /* of a question for values */
    struct dt_surface surface;
    double outside, *value;
};

/* Copies places, as predicates can take them, and walks to them. *ok: bit i says whether place i could be taken. */
static void walk(const struct places *p, size_t from, size_t n, struct dt_place *place,
                 uint64_t *ok)
{
    *ok = 0;
    for (size_t i = 0; i < n; i++) {
        place[i].at = p->q[from + i];
        if (dt_place_ok(&place[i].at))
            *ok |= (uint64_t)1 << i;
        else
            place[i].at = (struct dt_point){0, 0};
    }
    dt_walk_to_places(p->a->t, place, n, DT_PLACE_READ);
}

/* ---- triangles ---- */

static uint32_t first_row_round(const struct dt_arrays *a, uint32_t h)
{
    uint32_t least = DT_NONE, first = h;
    do {
        uint32_t row = dt_row_of(a, h); /* DT_NONE for a ghost, the largest number */
        least = row < least ? row : least;
        h = dt_turn_ccw(&a->t->mesh, h);
    } while (h != first);
    return least;
}

static uint32_t row_at(const struct places *p, const struct dt_place *place)
{
    const struct dt_arrays *a = p->a;
    uint32_t h, row, twin;
    double along;
    switch (dt_find(a->t, place, &h)) {
    case DT_ON_VERTEX:
        return first_row_round(a, h);
    case DT_ON_EDGE:
        row = dt_row_of(a, h);
        twin = dt_row_of(a, dt_twin(&a->t->mesh, h));
        return row < twin ? row : twin;
    case DT_INSIDE:
        return dt_row_of(a, h);
    case DT_OUTSIDE:
        h = dt_beside_hull(a, place->at, h, p->tol, &along);
        return h == DT_NONE ? DT_NONE : dt_row_of(a, h);
    }
    return DT_NONE;
}

static enum dt_status locate_piece(void *ctx, size_t from, size_t n)
{
    const struct places *p = ctx;
    struct dt_place place[DT_AHEAD];
    uint64_t ok;
    for (size_t end = from + n, many; from < end; from += many) {
        many = end - from < DT_AHEAD ? end - from : DT_AHEAD;
        walk(p, from, many, place, &ok);
        for (size_t i = 0; i < many; i++)
            p->row[from + i] = ok >> i & 1 ? row_at(p, &place[i]) : DT_NONE;
    }
    return DT_OK;
}

enum dt_status dt_arrays_locate(const struct dt_arrays *a, const struct dt_point *q, size_t n,
                                double tol, unsigned workers, uint32_t *row)
{
    struct places p = {.a = a, .q = q, .tol = tol, .row = row};
    fenv_t caller = dt_call_begin();
    enum dt_status s = DT_OK;
    if (dt_mesh_is_line(&a->t->mesh))
        memset(row, 0xff, n * sizeof *row);
    else if (a->place_of == NULL)
        s = DT_UNTRIANGULATED;
    else
        s = dt_answer_all(&(struct dt_pieces){locate_piece, &p}, n, workers);
    dt_call_end(&caller);
    return s;
}

/* ---- values ---- */

/* The surface of an array: its pages are parts of the array, except the last one, which is a copy. */
static enum dt_status surface_of(struct dt_surface *s, const double *value, size_t n)
{
    size_t full = n / DT_FIELD_PAGE, left = n % DT_FIELD_PAGE;
    double *rest;
    s->page = malloc((full + 2) * sizeof *s->page + 2 * DT_FIELD_PAGE * sizeof *rest);
    if (s->page == NULL)
        return DT_NOMEM;
    rest = (double *)(void *)(s->page + full + 2);
    for (size_t i = 0; i < 2 * DT_FIELD_PAGE; i++)
        rest[i] = (double)NAN;
    for (size_t i = 0; i < full; i++)
        s->page[i] = value + i * DT_FIELD_PAGE;
    if (left > 0)
        memcpy(rest, value + full * DT_FIELD_PAGE, left * sizeof *rest);
    s->page[full] = rest;
    s->page[full + 1] = rest + DT_FIELD_PAGE;
    s->pages = (uint32_t)full + 1;
    return DT_OK;
}

/* No edge of the triangle is longer than the surface allows. */
static bool is_short(const struct places *p, uint32_t half)
{
    const uint32_t *v = p->a->t->mesh.half + dt_base(half);
    const struct dt_point *xy = p->a->t->points.xy;
    bool all = true;
    for (unsigned k = 0; k < 3 && all; k++)
        all = dt_compare_radius(xy[v[k]], xy[v[(k + 1) % 3]], p->surface.max_edge) <= 0;
    return all;
}

/* The value at a place that would be on an edge of the hull without rounding: linear between its ends, by any method. */
static double value_beside(const struct places *p, struct dt_point at, uint32_t ghost)
{
    const struct dt *t = p->a->t;
    double along;
    uint32_t h = dt_beside_hull(p->a, at, ghost, p->tol, &along);
    if (h == DT_NONE || (p->surface.max_edge != HUGE_VAL && !is_short(p, h)))
        return p->outside;
    double from = dt_value_of_id(&p->surface, t->points.id[dt_origin(&t->mesh, h)]);
    double to = dt_value_of_id(&p->surface, t->points.id[dt_dest(&t->mesh, h)]);
    return along == 0 ? from : along == 1 ? to : from * (1 - along) + to * along;
}

/* Returns the value of a place for which dt_value_find gives none. */
static double no_value(const struct places *p, struct dt_point at, uint32_t half)
{
    const struct dt *t = p->a->t;
    bool is_outside = dt_place_find(t, at, half, &half) == DT_OUTSIDE;
    if (is_outside && !dt_mesh_is_line(&t->mesh))
        return value_beside(p, at, half);
    return is_outside || p->surface.max_edge != HUGE_VAL ? p->outside : (double)NAN;
}

static enum dt_status value_block(const struct places *p, struct dt_valuer *v, size_t from,
                                  size_t n)
{
    struct dt_place place[DT_AHEAD];
    enum dt_status s = DT_OK;
    uint64_t ok;
    walk(p, from, n, place, &ok);
    dt_values_fetch(v, place, n);
    for (size_t i = 0; i < n && s == DT_OK; i++) {
        double *out = &p->value[from + i];
        *out = p->outside;
        if (!(ok >> i & 1))
            continue;
        s = dt_value_find(v, place[i].at, &place[i].near, out);
        if (isnan(*out))
            *out = no_value(p, place[i].at, place[i].near);
    }
    return s;
}

static enum dt_status value_piece(void *ctx, size_t from, size_t n)
{
    const struct places *p = ctx;
    struct dt_valuer v;
    enum dt_status s = dt_valuer_init(&v, p->a->t, &p->surface, NULL);
    for (size_t end = from + n, many; s == DT_OK && from < end; from += many) {
        many = end - from < DT_AHEAD ? end - from : DT_AHEAD;
        s = value_block(p, &v, from, many);
    }
    dt_valuer_clear(&v);
    return s;
}

enum dt_status dt_arrays_values(const struct dt_arrays *a, const double *value,
                                enum dt_interpolation how, double max_edge,
                                const struct dt_point *q, size_t n, double tol, double outside,
                                unsigned workers, double *out)
{
    struct places p = {.a = a, .q = q, .tol = tol, .outside = outside, .value = out};
    fenv_t caller = dt_call_begin();
    enum dt_status s = DT_OK;
    if (!(max_edge == HUGE_VAL || (max_edge >= 0 && dt_coordinate_ok(max_edge))))
        s = DT_RANGE;
    if (s == DT_OK)
        s = surface_of(&p.surface, value, dt_next_id(a->t));
    if (s == DT_OK) {
        p.surface.how = how;
        p.surface.max_edge = max_edge;
        s = dt_answer_all(&(struct dt_pieces){value_piece, &p}, n, workers);
        free(p.surface.page);
    }
    dt_call_end(&caller);
    return s;
}
