/* nearest.c - a nearest vertex: from the triangle that the place is in, on to nearer neighbours.
 *
 * The search does not visit all neighbours of a vertex. Let v be at the origin, and let every neighbour w stand for
 * the point w* = w / |w|^2, infinity for the origin: by inversion these are the corners of a convex polygon, in the
 * order of the ring. A neighbour is as near to q as v, or nearer, if q.w* >= 1/2; and along a convex polygon q.w*
 * rises to its maximum from both sides. So an ascent finds the maximum, and neighbours beyond a descent on either side
 * of it need not be visited. At v, the nearest corner of the triangle that q is in, it begins at the top or beside it,
 * and two or three neighbours are enough; at a vertex of high degree it goes on from the best of a sample if the way is
 * long. */
#include "core/query/nearest.h"

#include "core/control/stop.h"
#include "core/grid/jump.h"
#include "core/mesh/hull.h"
#include "core/query/locate.h"
#include "core/set/set.h"

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

/* q.w* for the neighbour w of v, and its error bound. */
struct reach {
    double to, error;
};

static inline struct reach reach(const struct nearest *n, uint32_t v, uint32_t w)
{
    const struct dt_point *xy = n->t->points.xy;
    if (w == DT_NONE)
        return (struct reach){0, 0};
    double wx = xy[w].x - xy[v].x, wy = xy[w].y - xy[v].y;
    double x = wx * (n->q.x - xy[v].x), y = wy * (n->q.y - xy[v].y),
           square = dt_square_distance(xy[w], xy[v]);
    return (struct reach){(x + y) / square, DT_INVERSE_BOUND * (fabs(x) + fabs(y)) / square};
}

/* Considers the neighbour at the end of h, if it may be as near as the vertex. */
static struct reach look_at(struct nearest *n, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    struct reach r = reach(n, dt_origin(m, h), dt_dest(m, h));
    if (r.to + r.error >= 0.5)
        consider(n, dt_twin(m, h));
    return r;
}

/* The best half edge that leaves the origin of h in a sample of triangles; h if there is none. */
static uint32_t best_of_sample(const struct nearest *n, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    uint32_t v = dt_origin(m, h), samples = dt_jump_samples(m->tri_end);
    double most = reach(n, v, dt_dest(m, h)).to;
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t t = 8 * (uint32_t)((uint64_t)m->tri_end * i / samples);
        for (uint32_t k = t; k < t + 3 && !dt_is_dead(m, t); k++) {
            if (dt_origin(m, k) != v)
                continue;
            double to = reach(n, v, dt_dest(m, k)).to;
            h = to > most ? k : h;
            most = to > most ? to : most;
        }
    }
    return h;
}

/* What has been looked at of a ring: from `right`, counterclockwise, to `left`. */
struct arc {
    uint32_t right, left, top; /* half edges; top: where the best is */
    struct reach at_right, at_left, best;
};

static struct arc arc_at(struct nearest *n, uint32_t h)
{
    struct reach r = look_at(n, h);
    return (struct arc){h, h, h, r, r, r};
}

/* Takes the next half edge into the arc, at one of its ends. */
static struct reach extend(struct nearest *n, struct arc *a, uint32_t h)
{
    struct reach r = look_at(n, h);
    a->top = r.to > a->best.to ? h : a->top;
    a->best = r.to > a->best.to ? r : a->best;
    return r;
}

/* Whether it is worth going on from an end of the arc: else it has fallen there, for certain. */
static inline bool may_rise(const struct arc *a, struct reach end)
{
    return end.to + end.error >= a->best.to - a->best.error;
}

/* Considers all neighbours of the origin v of h that may be as near, from the one at the end of h on.
 *
 *          a ------- b       the usual case: v is the nearest corner of the triangle that q is in, h the half
 *           \  q   /        edge to b. If a certainly reaches less far than b, only what is to the right of b is
 *     left   \    /  right  looked at, and the other way round.
 *              v
 */
static void consider_around(struct nearest *n, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    struct arc a = arc_at(n, h);
    for (uint32_t steps = 0; may_go_on(n); steps++) {
        if (steps >= PATIENCE && steps == PATIENCE + dt_jump_samples(m->tri_end))
            a = arc_at(n, best_of_sample(n, a.top));
        bool go_left = may_rise(&a, a.at_left);
        if (go_left) {
            a.left = dt_turn_ccw(m, a.left);
            if (a.left == a.right)
                return;
            a.at_left = extend(n, &a, a.left);
        }
        if (may_rise(&a, a.at_right)) {
            a.right = dt_turn_cw(m, a.right);
            if (a.right == a.left)
                return;
            a.at_right = extend(n, &a, a.right);
        } else if (!go_left) {
            return;
        }
    }
}

/* Finds the triangle that q is in: its nearest corner is the best so far. */
static void begin(struct nearest *n, uint32_t near)
{
    const struct dt *t = n->t;
    uint32_t h;
    (void)dt_find(&t->mesh, t->points.xy, t->points.id, &t->hints, near, n->q, &h);
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
    begin(&n, q->near);
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
