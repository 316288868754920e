/* weights.c - see weights.h.
 *
 * Sibson's weight of a natural neighbour v of q is the share of q's Voronoi cell that would be taken from v's
 * [Sibson, "A vector identity for the Dirichlet tessellation", 1980]. Laplace's weight is the length of the edge
 * between the two cells over the distance of v [Belikov et al., "The non-Sibsonian interpolation", 1997; Sugihara
 * 1999]. Both reproduce linear functions, so q is the weighted mean of its neighbours.
 *
 * The formulas are evaluated in doubles, with a bound of the error. If the bound is too large, they are evaluated in
 * double words, and if that is not enough, in numbers of 2,500 bits, which are always enough:
 *
 * 1. Differences of coordinates and the D of the formulas are exact.
 * 2. Circumcentres that are corners of the cell have coordinates below 2^610, with relative errors below 2^-2480.
 * 3. So the errors of areas add up to less than 2^-2480 2^1220 2^40, for any number of neighbours.
 * 4. The area of the cell is at least 2^-392: the area of the disc with half the distance to the nearest neighbour. */
#include "core/surface/weights.h"

#include "core/exact/bignum.h"
#include "core/exact/double2.h"
#include "core/exact/predicates.h"
#include "core/query/query.h"

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
#define MINUS(a, b) dt_double2_subtract(a, b)
#define TIMES(a, b) dt_double2_multiply(a, b)
#define OVER(a, b) dt_double2_divide(a, b)
#define ROUGH(a) ((a).hi)
#define UNIT 0x1p-102
#include "core/surface/weights_formula.h"

/* ---- in numbers that are always enough ---- */

#define NUMBER struct dt_big
#define F(name) name##_big
#define DIFFERENCE(a, b) dt_big_difference(a, b)
#define PLUS(a, b) dt_big_add(a, b)
#define MINUS(a, b) dt_big_subtract(a, b)
#define TIMES(a, b) dt_big_multiply(a, b)
#define OVER(a, b) dt_big_divide(a, b)
#define ROUGH(a) dt_big_to_double(a)
#define UNIT 0.0
#include "core/surface/weights_formula.h"

/* ---- room ---- */

void dt_weigher_clear(struct dt_weigher *w)
{
    free(w->id);
    free(w->weight);
    free(w->step);
    free(w->turn);
    *w = (struct dt_weigher){0};
}

/* Room for `cap` items of the array. */
static bool fits(const struct dt_weigher *w, void *array, size_t cap, size_t size)
{
    return dt_items_reserve(array, cap, &(size_t){w->cap}, size) == DT_OK;
}

/* Makes room for one more step, the point that it may add, and what it puts on the stack. */
static bool reserve(struct dt_weigher *w)
{
    if (w->steps < w->cap)
        return true;
    size_t cap = w->cap == 0 ? 16 : 2 * (size_t)w->cap;
    if (!fits(w, &w->id, cap, sizeof *w->id) || !fits(w, &w->weight, cap, sizeof *w->weight) ||
        !fits(w, &w->step, cap, sizeof *w->step) ||
        !fits(w, &w->turn, 2 * cap + 3, sizeof *w->turn))
        return false;
    w->cap = (uint32_t)cap;
    return true;
}

/* ---- the tour ---- */

/* The cost of a step of the tour, with its share of the weights, in steps of dt_work: it decides an incircle test. */
#define TOUR_WORK 4

static void enter(struct dt_weigher *w, const struct dt *t, uint32_t half)
{
    const struct dt_point *xy = t->points.xy;
    w->step[w->steps++] =
        (struct dt_tour_step){DT_TOUR_ENTER,
                              w->triangles++,
                              {xy[dt_origin(&t->mesh, half)], xy[dt_dest(&t->mesh, half)],
                               xy[dt_apex_of(&t->mesh, half)]}};
}

static void add_rim(struct dt_weigher *w, const struct dt *t, uint32_t half)
{
    uint32_t a = dt_origin(&t->mesh, half), b = dt_dest(&t->mesh, half);
    w->step[w->steps++] =
        (struct dt_tour_step){.kind = DT_TOUR_RIM, .p = {t->points.xy[a], t->points.xy[b]}};
    w->id[w->n++] = t->points.id[a];
}

static bool in_disc(const struct dt *t, uint32_t half, struct dt_point q)
{
    const struct dt_point *xy = t->points.xy;
    const uint32_t *v = t->mesh.half + dt_base(half);
    return v[2] != DT_NONE && dt_incircle(xy[v[0]], xy[v[1]], xy[v[2]], q) > 0;
}

static void take_turn(struct dt_weigher *w, const struct dt *t, struct dt_tour_turn turn)
{
    if (turn.half == DT_NONE) {
        w->step[w->steps++] = (struct dt_tour_step){DT_TOUR_LEAVE, turn.triangle, {{0, 0}}};
        return;
    }
    uint32_t beyond = dt_twin(&t->mesh, turn.half), here = w->triangles;
    if (!in_disc(t, beyond, w->place)) {
        add_rim(w, t, turn.half);
        return;
    }
    enter(w, t, beyond);
    w->turn[w->turns++] = (struct dt_tour_turn){DT_NONE, turn.triangle};
    w->turn[w->turns++] = (struct dt_tour_turn){dt_prev(beyond), here};
    w->turn[w->turns++] = (struct dt_tour_turn){dt_next(beyond), here};
}

/* From the triangle of the half edge `first`, around the place; the first rim edge begins at its origin. */
static enum dt_status make_tour(struct dt_weigher *w, const struct dt *t, uint32_t first,
                                struct dt_stop *work)
{
    enter(w, t, first);
    w->turn[0] = (struct dt_tour_turn){dt_prev(first), 0};
    w->turn[1] = (struct dt_tour_turn){dt_next(first), 0};
    w->turn[2] = (struct dt_tour_turn){first, 0};
    w->turns = 3;
    while (w->turns > 0) {
        if (!reserve(w))
            return DT_NOMEM;
        take_turn(w, t, w->turn[--w->turns]);
        bool poll = (w->steps & DT_WORK_MASK) == 0;
        enum dt_status s = poll ? dt_work(work, TOUR_WORK * DT_WORK_BLOCK) : DT_OK;
        if (s != DT_OK)
            return s;
    }
    return dt_work(work, TOUR_WORK * (w->steps & DT_WORK_MASK));
}

/* ---- reading the set ---- */

static void put(struct dt_weigher *w, uint32_t id, double weight)
{
    w->id[w->n] = id;
    w->weight[w->n++] = weight;
}

/* From the smaller id. q is on the edge, so one coordinate gives its position: the one in which the ends differ more. */
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

enum dt_status dt_weigh_foot(const struct dt *t, struct dt_point q, uint32_t ghost,
                             struct dt_weigher *w)
{
    uint32_t u = dt_origin(&t->mesh, ghost), v = dt_dest(&t->mesh, ghost);
    uint32_t first = t->points.id[u] < t->points.id[v] ? u : v, other = u + v - first;
    struct dt_point a = t->points.xy[first], b = t->points.xy[other];
    double along;
    w->n = 0;
    if (!reserve(w))
        return DT_NOMEM;
    if (!along_double(a, b, q, &along) && !along_double2(a, b, q, &along))
        (void)along_big(a, b, q, &along);
    along = along < 0 ? 0 : along > 1 ? 1 : along;
    put(w, t->points.id[first], 1 - along);
    put(w, t->points.id[other], along);
    return DT_OK;
}

/* Only the triangle, for linear weights. */
static void take_triangle(struct dt_weigher *w, const struct dt *t, uint32_t half)
{
    enter(w, t, half);
    for (int k = 0; k < 3; k++, half = dt_next(half))
        w->id[w->n++] = t->points.id[dt_origin(&t->mesh, half)];
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
    uint32_t twin = dt_twin(&t->mesh, half);
    return from_smallest(t, dt_triangle_precedes(t, half, twin) ? half : twin);
}

uint32_t dt_weigh_start(const struct dt *t, enum dt_where where, uint32_t half)
{
    return where == DT_ON_EDGE ? first_triangle(t, half) : from_smallest(t, half);
}

enum dt_status dt_weigh_begin(const struct dt *t, struct dt_point q, enum dt_where where,
                              uint32_t half, enum dt_interpolation how, struct dt_stop *work,
                              struct dt_weigher *w)
{
    w->n = 0;
    w->steps = w->triangles = 0;
    w->place = q;
    w->how = how;
    if (!reserve(w))
        return DT_NOMEM;
    if (where == DT_OUTSIDE)
        return DT_OK;
    if (where == DT_ON_VERTEX) {
        put(w, t->points.id[half == DT_NONE ? t->mesh.alone : dt_origin(&t->mesh, half)], 1);
        return DT_OK;
    }
    if (dt_weigh_along_edge(t, where, half, how)) {
        weigh_on_edge(t, half, w);
        return DT_OK;
    }
    half = dt_weigh_start(t, where, half);
    if (how != DT_LINEAR)
        return make_tour(w, t, half, work);
    take_triangle(w, t, half);
    return DT_OK;
}

enum dt_status dt_weigh_end(struct dt_weigher *w, const struct dt_stop *work)
{
    if (w->steps == 0)
        return DT_OK;
    enum dt_status s = weigh_double(w, work->cancel);
    w->long_doubles = s == DT_RANGE;
    if (s == DT_RANGE)
        s = weigh_double2(w, work->cancel);
    if (s != DT_RANGE)
        return s;
    if (w->how != DT_LINEAR && dt_work_is_limited(work))
        return DT_TOOLONG;
    return weigh_big(w, work->cancel);
}

/* ---- a place by itself ---- */

enum dt_status dt_weights_begin(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                const struct dt_options *opt, struct dt_weigher **out)
{
    uint32_t half;
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status s = how == DT_LINEAR ? dt_readable(t) : dt_readable_delaunay(t);
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
    size_t room = w->steps == 0 ? 0 : exact ? room_big(w) : room_double2(w);
    return w->cap * (sizeof *w->id + sizeof *w->weight + sizeof *w->step + 2 * sizeof *w->turn) +
           w->n * sizeof(struct dt_weight) + room;
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
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status s = dt_weigh_end(w, &work);
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
