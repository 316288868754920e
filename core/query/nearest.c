/* nearest.c - a nearest vertex: from the triangle that the place is in, on to nearer neighbours.
 *
 * The search does not visit all neighbours of a vertex v:
 *
 * 1. Put v at the origin. A neighbour w stands for the point w* = w / |w|^2, infinity for the origin. By inversion these
 *    points are the corners of a convex polygon, in the order of the ring.
 * 2. A neighbour w is at least as near to q as v if and only if q.w* >= 1/2.
 * 3. Along a convex polygon q.w* rises to its maximum from both sides. So an ascent finds the maximum. Neighbours beyond
 *    a descent on either side of the maximum need not be visited.
 *
 * At v, the nearest corner of the triangle that q is in, the ascent begins at the top or beside it, and two or three
 * neighbours are enough. At a vertex of high degree it continues from the best of a sample if the way is long. */
#include "core/query/nearest.h"

#include "core/control/stop.h"
#include "core/hints/jump.h"
#include "core/mesh/hull.h"
#include "core/query/locate.h"

#define PATIENCE 16 /* steps from vertex to vertex, or round one; mostly there are one or two */

/* The nearest vertex so far; tie: another one is as near. */
struct nearest {
    const struct dt *t;
    struct dt_point q;
    struct dt_candidate best;
    uint32_t at; /* a half edge that leaves it */
    bool tie;
    struct dt_ids *ties; /* borrows: those that are as near; NULL: not needed */
    uint32_t steps;      /* vertices considered and not yet taken off what the caller allows */
    struct dt_stop *work;
    enum dt_status status; /* the result of the last poll */
};

/* Whether the search may continue; polls every few vertices. */
static bool may_go_on(struct nearest *n)
{
    if (++n->steps >= DT_WORK_BLOCK && n->status == DT_OK) {
        n->steps = 0;
        n->status = dt_work(n->work, DT_WORK_BLOCK);
    }
    return n->status == DT_OK;
}

/* Considers the vertex that h leaves. */
static void consider(struct nearest *n, uint32_t h)
{
    struct dt_candidate c = dt_candidate(n->t, n->q, dt_origin(&n->t->mesh, h));
    int sign = dt_compare_candidates(n->t, n->q, c, n->best);
    n->tie = sign == 0 || (n->tie && sign > 0);
    n->at = sign < 0 ? h : n->at;
    n->best = sign < 0 ? c : n->best;
    if (sign == 0 && n->ties != NULL && n->status == DT_OK)
        n->status = dt_ids_append(n->ties, c.v);
}

/* ---- around a vertex ---- */

/* A vertex v, and q relative to it. */
struct centre {
    uint32_t v;
    struct dt_point at, q;
};

/* q.w* is between least / square and most / square. */
struct reach {
    double least, most, square;
};

static inline struct reach reach(const struct nearest *n, const struct centre *c, uint32_t w)
{
    if (w == DT_NONE)
        return (struct reach){0, 0, 1};
    struct dt_point p = n->t->points.xy[w];
    double wx = p.x - c->at.x, wy = p.y - c->at.y, x = wx * c->q.x, y = wy * c->q.y;
    double error = DT_INVERSE_BOUND * (fabs(x) + fabs(y));
    return (struct reach){x + y - error, x + y + error, wx * wx + wy * wy};
}

static inline bool certainly_below(struct reach a, struct reach b)
{
    return a.most * b.square < b.least * a.square;
}

static inline bool seems_above(struct reach a, struct reach b)
{
    return a.most * b.square > b.most * a.square;
}

/* Considers the neighbour that h leaves, if it may be as near as the vertex. */
static inline struct reach look_at(struct nearest *n, const struct centre *c, uint32_t h)
{
    struct reach r = reach(n, c, dt_origin(&n->t->mesh, h));
    if (2 * r.most >= r.square)
        consider(n, h);
    return r;
}

/* The best half edge that leaves the vertex in a sample of triangles, and h. */
static uint32_t best_of_sample(const struct nearest *n, const struct centre *c, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    uint32_t samples = dt_jump_samples(m->tri_end);
    struct reach best = reach(n, c, dt_dest(m, h));
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t t = 8 * (uint32_t)((uint64_t)m->tri_end * i / samples);
        for (uint32_t k = t; k < t + 3 && !dt_is_dead(m, t); k++) {
            if (dt_origin(m, k) != c->v)
                continue;
            struct reach r = reach(n, c, dt_dest(m, k));
            h = seems_above(r, best) ? k : h;
            best = seems_above(r, best) ? r : best;
        }
    }
    return h;
}

/* Looks at the neighbours after the end of h, counterclockwise or clockwise, until one certainly reaches less far than
 * the best so far, or `until` is reached. Returns DT_NONE, but where the way is long, unless `patient`, the half edge to
 * the last one. */
static uint32_t climb(struct nearest *n, const struct centre *c, uint32_t h, uint32_t until,
                      bool ccw, bool patient, struct reach *best)
{
    const struct dt_mesh *m = &n->t->mesh;
    for (uint32_t steps = 0; may_go_on(n); steps++) {
        if (steps >= PATIENCE && !patient && steps == PATIENCE + dt_jump_samples(m->tri_end))
            return h;
        uint32_t beside = ccw ? h : dt_twin(m, h), from = dt_prev(beside);
        h = ccw ? dt_twin(m, from) : dt_next(beside);
        if (h == until)
            break;
        struct reach r = look_at(n, c, from);
        if (certainly_below(r, *best))
            break;
        *best = seems_above(r, *best) ? r : *best;
    }
    return DT_NONE;
}

/* The same both ways, from the half edge h and the one counterclockwise of it on, first on the side of the higher one. */
static uint32_t climb_both_ways(struct nearest *n, const struct centre *c, uint32_t h, bool patient)
{
    uint32_t left = dt_turn_ccw(&n->t->mesh, h);
    struct reach at_right = look_at(n, c, dt_next(h)), at_left = look_at(n, c, dt_prev(h));
    bool ccw = seems_above(at_left, at_right);
    struct reach best = ccw ? at_left : at_right, other = ccw ? at_right : at_left;
    uint32_t far = climb(n, c, ccw ? left : h, ccw ? h : left, ccw, patient, &best);
    if (far == DT_NONE && !certainly_below(other, best))
        far = climb(n, c, ccw ? h : left, ccw ? left : h, !ccw, patient, &best);
    return far;
}

/* Considers all neighbours of the origin v of h that may be as near, from the triangle of h on.
 *
 *          a ------- b       the usual case: v is the nearest corner of the triangle that q is in, h the half
 *           \  q   /        edge to b. If a certainly reaches less far than b, only what is to the right of b is
 *     left   \    /  right  looked at, and the other way round.
 *              v
 */
static void consider_around(struct nearest *n, uint32_t h)
{
    uint32_t v = dt_origin(&n->t->mesh, h);
    struct dt_point at = n->t->points.xy[v];
    struct centre c = {v, at, {n->q.x - at.x, n->q.y - at.y}};
    h = climb_both_ways(n, &c, h, false);
    if (h != DT_NONE)
        climb_both_ways(n, &c, best_of_sample(n, &c, h), true);
}

/* Finds the triangle that q is in: its nearest corner is the best so far. */
static void begin(struct nearest *n, const struct dt_place *place)
{
    const struct dt *t = n->t;
    uint32_t h;
    (void)dt_find(t, place, &h);
    n->at = h = dt_base(h);
    n->best = dt_candidate(t, n->q, dt_origin(&t->mesh, h));
    for (uint32_t k = h + 1; k < h + 3 && dt_origin(&t->mesh, k) != DT_NONE; k++) {
        struct dt_candidate c = dt_candidate(t, n->q, dt_origin(&t->mesh, k));
        n->at = c.d < n->best.d ? k : n->at;
        n->best = c.d < n->best.d ? c : n->best;
    }
}

/* The way is long, for instance along a line of points. The grid's hint for q comes from one of the nearest
 * cells that have points. */
static void consider_hint(struct nearest *n)
{
    const struct dt *t = n->t;
    if (t->hints.grids == 0)
        return;
    uint32_t h = dt_hint(&t->hints, n->q);
    for (uint32_t k = h; k < h + 3 && !dt_is_dead(&t->mesh, h); k++)
        if (dt_origin(&t->mesh, k) != DT_NONE)
            consider(n, k);
}

static void consider_sample(struct nearest *n)
{
    const struct dt_mesh *m = &n->t->mesh;
    consider(n, m->leaving[dt_jump_vertex(m, n->t->points.xy, n->best.v, n->q)]);
}

enum dt_status dt_nearest_vertex(const struct dt *t, const struct dt_place *q, struct dt_stop *work,
                                 uint32_t *nearest, bool *tie)
{
    *tie = false;
    if (t->mesh.vertices == 1) {
        *nearest = t->mesh.alone;
        return DT_OK;
    }
    struct nearest n = {.t = t, .q = q->at, .work = work};
    uint32_t v = DT_NONE;
    begin(&n, q);
    for (uint32_t steps = 0; v != n.best.v && n.best.d > 0 && n.status == DT_OK; steps++) {
        if (steps == PATIENCE)
            consider_hint(&n);
        if (steps >= PATIENCE && steps == PATIENCE + dt_jump_samples(t->mesh.vertices))
            consider_sample(&n);
        v = n.best.v;
        n.tie = false;
        consider_around(&n, n.at);
    }
    *tie = n.tie;
    *nearest = n.best.v;
    return n.status == DT_OK ? dt_work(work, n.steps) : n.status;
}

enum dt_status dt_nearest_ties(const struct dt *t, struct dt_point q, uint32_t v,
                               struct dt_stop *work, struct dt_ids *ties)
{
    struct nearest n = {.t = t, .q = q, .best = dt_candidate(t, q, v), .ties = ties, .work = work};
    consider_around(&n, t->mesh.leaving[v]);
    return n.status == DT_OK ? dt_work(work, n.steps) : n.status;
}
