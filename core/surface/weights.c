/* weights.c - see weights.h.
 *
 * Sibson's weight of a natural neighbour v of q is the share of q's Voronoi cell that would be taken from v's
 * [Sibson, "A vector identity for the Dirichlet tessellation", 1980]; Laplace's is the length of the edge
 * between the two cells over the distance of v [Belikov et al., "The non-Sibsonian interpolation", 1997; Sugihara
 * 1999]. Both reproduce linear functions, so q is the weighted mean of its neighbours.
 *
 * The formulas are evaluated in doubles, with a bound of the error; where it is too large in double words; and
 * where that is not enough in numbers of 2,500 bits, which are always enough: differences of coordinates and
 * the D of the formulas are then exact, the coordinates of circumcentres that are corners of the cell are below
 * 2^610, their relative errors below 2^-2480, and the area of the cell is at least that of the disc of half the
 * distance to the nearest neighbour, 2^-392: so errors of areas are below 2^-2480 2^1220 2^40 of 2^-392, whatever
 * the number of neighbours. */
#include "core/surface/weights.h"

#include "core/exact/bignum.h"
#include "core/exact/double2.h"
#include "core/exact/predicates.h"
#include "core/query/query.h"
#include "core/set/set.h"

#include <math.h>
#include <stdlib.h>

static bool is_cancelled(const atomic_bool *cancel, uint32_t step)
{
    return (step & DT_WORK_MASK) == 0 && cancel != NULL &&
           atomic_load_explicit(cancel, memory_order_relaxed);
}

/* ---- in doubles ---- */

#define NUMBER double
#define F(name) name##_double
#define DIFFERENCE(a, b) ((double)(a) - (double)(b))
#define PLUS(a, b) ((a) + (b))
#define MINUS(a, b) ((a) - (b))
#define TIMES(a, b) ((a) * (b))
#define OVER(a, b) ((a) / (b))
#define ROUGH(a) (a)
#define UNIT 0x1p-53
#include "core/surface/weights_formula.h"

/* ---- in double words ---- */

#define NUMBER struct dt_double2
#define F(name) name##_double2
#define DIFFERENCE(a, b) dt_double2_difference(a, b)
#define PLUS(a, b) dt_double2_add(a, b)
#define MINUS(a, b) dt_double2_add(a, dt_double2_negate(b))
#define TIMES(a, b) dt_double2_multiply(a, b)
#define OVER(a, b) dt_double2_divide(a, b)
#define ROUGH(a) ((a).hi)
#define UNIT 0x1p-102
#include "core/surface/weights_formula.h"

/* ---- in numbers that are always enough ---- */

static struct dt_big big_difference(double a, double b)
{
    struct dt_big r;
    dt_big_difference(a, b, &r);
    return r;
}

static struct dt_big big_plus(struct dt_big a, struct dt_big b)
{
    dt_big_add(&a, &b, &a);
    return a;
}

static struct dt_big big_minus(struct dt_big a, struct dt_big b)
{
    dt_big_subtract(&a, &b, &a);
    return a;
}

static struct dt_big big_times(struct dt_big a, struct dt_big b)
{
    dt_big_multiply(&a, &b, &a);
    return a;
}

static struct dt_big big_over(struct dt_big a, struct dt_big b)
{
    dt_big_divide(&a, &b, &a);
    return a;
}

static double big_rough(struct dt_big a)
{
    return dt_big_to_double(&a);
}

#define NUMBER struct dt_big
#define F(name) name##_big
#define DIFFERENCE(a, b) big_difference(a, b)
#define PLUS(a, b) big_plus(a, b)
#define MINUS(a, b) big_minus(a, b)
#define TIMES(a, b) big_times(a, b)
#define OVER(a, b) big_over(a, b)
#define ROUGH(a) big_rough(a)
#define UNIT 0.0
#include "core/surface/weights_formula.h"

/* ---- room ---- */

void dt_weigher_clear(struct dt_weigher *w)
{
    dt_tour_clear(&w->tour);
    free(w->id);
    free(w->weight);
    free(w->room);
    *w = (struct dt_weigher){0};
}

static bool reserve(struct dt_weigher *w, size_t n)
{
    if (n <= w->cap)
        return true;
    size_t cap = n < 32 ? 32 : n + n / 2;
    uint32_t *id = realloc(w->id, cap * sizeof *id);
    if (id != NULL)
        w->id = id;
    double *weight = realloc(w->weight, cap * sizeof *weight);
    if (weight != NULL)
        w->weight = weight;
    if (id == NULL || weight == NULL)
        return false;
    w->cap = cap;
    return true;
}

/* For all centres and numbers of the tour, of these sizes. */
static size_t room_bytes(const struct dt_tour *tour, size_t centre, size_t number)
{
    size_t rims = tour->rims;
    return (tour->triangles + rims) * centre + 3 * rims * number;
}

static bool reserve_room(struct dt_weigher *w, size_t centre, size_t number)
{
    size_t bytes = room_bytes(&w->tour, centre, number);
    if (bytes <= w->room_cap)
        return true;
    void *room = realloc(w->room, bytes + bytes / 2);
    if (room == NULL)
        return false;
    w->room = room;
    w->room_cap = bytes + bytes / 2;
    return true;
}

/* ---- what is read from the set ---- */

static void put(struct dt_weigher *w, uint32_t id, double weight)
{
    w->id[w->n] = id;
    w->weight[w->n++] = weight;
}

/* From the smaller id. q is on the edge, so one coordinate tells how far along: the one in which the ends differ more. */
static void weigh_on_edge(const struct dt *t, uint32_t half, struct dt_weigher *w)
{
    uint32_t u = dt_origin(&t->mesh, half), v = dt_dest(&t->mesh, half);
    struct dt_point a = t->points.xy[u], b = t->points.xy[v], q = w->place;
    bool along_x = fabs(b.x - a.x) >= fabs(b.y - a.y);
    double from = along_x ? q.x - a.x : q.y - a.y, to = along_x ? b.x - q.x : b.y - q.y;
    double whole = along_x ? b.x - a.x : b.y - a.y;
    bool ascending = t->points.id[u] < t->points.id[v];
    put(w, t->points.id[ascending ? u : v], (ascending ? to : from) / whole);
    put(w, t->points.id[ascending ? v : u], (ascending ? from : to) / whole);
}

static void take_triangle(const struct dt *t, uint32_t half, struct dt_weigher *w)
{
    w->in_triangle = true;
    for (w->n = 0; w->n < 3; w->n++, half = dt_next(half)) {
        uint32_t v = dt_origin(&t->mesh, half);
        w->id[w->n] = t->points.id[v];
        w->corner[w->n] = t->points.xy[v];
    }
}

static enum dt_status take_tour(const struct dt *t, uint32_t half, struct dt_stop *work,
                                struct dt_weigher *w)
{
    const struct dt_tour *tour = &w->tour;
    enum dt_status s = dt_tour_make(t, w->place, half, work, &w->tour);
    if (s != DT_OK)
        return s;
    if (!reserve(w, tour->rims))
        return DT_NOMEM;
    w->by_cells = true;
    for (uint32_t i = 0; i < tour->steps; i++)
        if (tour->step[i].kind == DT_TOUR_RIM)
            w->id[w->n++] = tour->step[i].id;
    return DT_OK;
}

/* Where rounding begins, so that the same set gives the same bytes: the half edge of its triangle that leaves the
 * corner with the smallest id; */
static uint32_t from_smallest(const struct dt *t, uint32_t half)
{
    uint32_t best = half;
    for (uint32_t h = dt_next(half); h != half; h = dt_next(h))
        if (t->points.id[dt_origin(&t->mesh, h)] < t->points.id[dt_origin(&t->mesh, best)])
            best = h;
    return best;
}

/* and of the two triangles at an edge in the one that comes first in TRIANGLES. */
static uint32_t first_triangle(const struct dt *t, uint32_t half)
{
    uint32_t twin = dt_twin(&t->mesh, half), one[3], other[3];
    dt_triangle_ids(t, half, false, one);
    dt_triangle_ids(t, twin, false, other);
    return from_smallest(t, dt_triangle_compare(one, other) < 0 ? half : twin);
}

uint32_t dt_weigh_start(const struct dt *t, enum dt_where where, uint32_t half)
{
    return where == DT_ON_EDGE ? first_triangle(t, half) : from_smallest(t, half);
}

static bool is_on_hull(const struct dt_mesh *m, uint32_t half)
{
    return dt_is_ghost(m, half) || dt_is_ghost(m, dt_twin(m, half));
}

enum dt_status dt_weigh_begin(const struct dt *t, struct dt_point q, enum dt_where where,
                              uint32_t half, enum dt_interpolation how, struct dt_stop *work,
                              struct dt_weigher *w)
{
    const struct dt_mesh *m = &t->mesh;
    w->n = 0;
    w->place = q;
    w->how = how;
    w->by_cells = w->in_triangle = false;
    if (!reserve(w, 3))
        return DT_NOMEM;
    switch (where) {
    case DT_OUTSIDE:
        return DT_OK;
    case DT_ON_VERTEX:
        put(w, t->points.id[half == DT_NONE ? m->alone : dt_origin(m, half)], 1);
        return DT_OK;
    case DT_ON_EDGE:
        if (how == DT_LINEAR || is_on_hull(m, half)) {
            weigh_on_edge(t, half, w);
            return DT_OK;
        }
        break;
    case DT_INSIDE:
        break;
    }
    half = dt_weigh_start(t, where, half);
    if (how != DT_LINEAR)
        return take_tour(t, half, work, w);
    take_triangle(t, half, w);
    return DT_OK;
}

/* ---- what is computed ---- */

static enum dt_status weigh_in_triangle(struct dt_weigher *w)
{
    enum dt_status s = linear_double(w->corner, w->place, w->weight);
    if (s == DT_RANGE)
        s = linear_double2(w->corner, w->place, w->weight);
    return s == DT_RANGE ? linear_big(w->corner, w->place, w->weight) : s;
}

static enum dt_status weigh_by_cells(struct dt_weigher *w, bool quick, const atomic_bool *cancel)
{
    const struct dt_tour *tour = &w->tour;
    bool sibson = w->how == DT_NATURAL;
    if (!reserve_room(w, sizeof(struct centre_double2), sizeof(struct dt_double2)))
        return DT_NOMEM;
    enum dt_status s = sibson ? sibson_double(tour, w->place, cancel, w->room, w->weight)
                              : laplace_double(tour, w->place, cancel, w->room, w->weight);
    if (s == DT_RANGE)
        s = sibson ? sibson_double2(tour, w->place, cancel, w->room, w->weight)
                   : laplace_double2(tour, w->place, cancel, w->room, w->weight);
    if (s != DT_RANGE)
        return s;
    if (quick)
        return DT_TOOLONG;
    if (!reserve_room(w, sizeof(struct centre_big), sizeof(struct dt_big)))
        return DT_NOMEM;
    return sibson ? sibson_big(tour, w->place, cancel, w->room, w->weight)
                  : laplace_big(tour, w->place, cancel, w->room, w->weight);
}

enum dt_status dt_weigh_end(struct dt_weigher *w, bool quick, const atomic_bool *cancel)
{
    if (w->in_triangle)
        return weigh_in_triangle(w);
    return w->by_cells ? weigh_by_cells(w, quick, cancel) : DT_OK;
}

/* ---- a place by itself ---- */

enum dt_status dt_weights_begin(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                const struct dt_options *opt, struct dt_weigher **out)
{
    uint32_t half;
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status s = dt_readable(t);
    *out = NULL;
    if (s != DT_OK)
        return s;
    struct dt_weigher *w = calloc(1, sizeof *w);
    if (w == NULL)
        return DT_NOMEM;
    enum dt_where where = dt_place_find(t, q, DT_NONE, &half);
    s = dt_weigh_begin(t, q, where, half, how, &work, w);
    if (s == DT_OK)
        *out = w;
    else
        dt_weights_free(w);
    return s;
}

size_t dt_weights_memory(const struct dt_weigher *w, bool exact)
{
    const struct dt_tour *tour = &w->tour;
    size_t room = 0;
    if (w->by_cells && exact)
        room = room_bytes(tour, sizeof(struct centre_big), sizeof(struct dt_big));
    else if (w->by_cells)
        room = room_bytes(tour, sizeof(struct centre_double2), sizeof(struct dt_double2));
    return w->cap * (sizeof *w->id + sizeof *w->weight) + w->n * sizeof(struct dt_weight) +
           tour->step_cap * sizeof *tour->step + tour->turn_cap * sizeof *tour->turn + room +
           room / 2;
}

static int compare_weights(const void *a, const void *b)
{
    const struct dt_weight *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

enum dt_status dt_weights_end(struct dt_weigher *w, const struct dt_options *opt,
                              struct dt_weight **out, size_t *n)
{
    *out = NULL;
    *n = 0;
    bool quick = opt != NULL && opt->steps > 0;
    enum dt_status s = dt_weigh_end(w, quick, opt == NULL ? NULL : opt->cancel);
    if (s != DT_OK)
        return s;
    struct dt_weight *row = malloc((w->n + 1) * sizeof *row);
    if (row == NULL)
        return DT_NOMEM;
    for (size_t i = 0; i < w->n; i++)
        row[i] = (struct dt_weight){w->id[i], w->weight[i]};
    qsort(row, w->n, sizeof *row, compare_weights);
    *out = row;
    *n = w->n;
    return DT_OK;
}

void dt_weights_free(struct dt_weigher *w)
{
    if (w == NULL)
        return;
    dt_weigher_clear(w);
    free(w);
}
