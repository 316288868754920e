/* nearest.c - a nearest vertex: from the triangle that the place is in, on to nearer neighbours.
 *
 * The search does not visit all neighbours of a vertex of high degree. Let v be at the origin, and let every
 * neighbour w stand for the point w* = w / |w|^2, infinity for the origin: by inversion these are the
 * corners of a convex polygon, in the order of the ring. A neighbour is as near to q as v, or nearer, if
 * q.w* >= 1/2; and along a convex polygon q.w* rises to its maximum from both sides. So an ascent finds the
 * maximum, from the best of a sample if the way is long, and neighbours beyond a descent on either side of it
 * need not be visited. */
#include "core/query/nearest.h"

#include "core/control/work.h"
#include "core/grid/jump.h"
#include "core/mesh/hull.h"
#include "core/query/locate.h"
#include "core/set/reader.h"

#define PATIENCE 16 /* vertices on the way to a nearest one; mostly there are one or two */
#define USUAL 32    /* neighbours that are examined one after the other */

/* The nearest vertex so far; tie: another one is as near. */
struct nearest {
    const struct dt *t;
    struct dt_point q;
    struct dt_candidate best;
    bool tie;
    struct dt_ids *ties; /* borrows: those that are as near; NULL: not needed */
    uint32_t steps;      /* vertices considered and not yet taken off what the caller allows */
    struct dt_work *work;
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

static void consider(struct nearest *n, uint32_t w)
{
    struct dt_candidate c = dt_candidate(n->t, n->q, w);
    int sign = dt_compare_candidates(n->t, n->q, c, n->best);
    n->tie = sign == 0 || (n->tie && sign > 0);
    n->best = sign < 0 ? c : n->best;
    if (sign == 0 && n->ties != NULL && n->status == DT_OK)
        n->status = dt_ids_append(n->ties, w);
}

/* ---- around a vertex of high degree ---- */

/* q.w* for the neighbour w of v, and its error bound. */
struct reach {
    double to, error;
};

static struct reach reach(const struct nearest *n, uint32_t v, uint32_t w)
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
        consider(n, dt_dest(m, h));
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
    struct reach best;
};

static struct arc arc_at(struct nearest *n, uint32_t h)
{
    return (struct arc){h, h, h, look_at(n, h)};
}

/* Takes the next half edge into the arc; returns whether it is worth going on beyond it. */
static bool extend(struct nearest *n, struct arc *a, uint32_t h)
{
    struct reach r = look_at(n, h);
    if (r.to > a->best.to) {
        a->best = r;
        a->top = h;
    }
    return r.to + r.error >= a->best.to - a->best.error; /* else it has fallen, for certain */
}

/* Considers all neighbours of the origin of h that may be as near. */
static void consider_hub(struct nearest *n, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    struct arc a = arc_at(n, h);
    bool go_right = true, go_left = true;
    uint32_t sample_at = dt_jump_samples(m->tri_end);
    for (uint32_t steps = 0; (go_right || go_left) && may_go_on(n); steps++) {
        if (steps == sample_at && (h = best_of_sample(n, a.top)) != a.top) {
            a = arc_at(n, h);
            go_right = go_left = true;
        }
        if (go_right) {
            a.right = dt_turn_cw(m, a.right);
            if (a.right == a.left)
                return;
            go_right = extend(n, &a, a.right);
        }
        if (go_left) {
            a.left = dt_turn_ccw(m, a.left);
            if (a.left == a.right)
                return;
            go_left = extend(n, &a, a.left);
        }
    }
}

/* ---- around any vertex ---- */

/* Considers all neighbours of v, which is the best so far, that may be as near. */
static void consider_around(struct nearest *n, uint32_t v)
{
    const struct dt_mesh *m = &n->t->mesh;
    uint32_t h = m->leaving[v], looks = 0;
    n->tie = false;
    do {
        uint32_t w = dt_dest(m, h);
        if (++looks > USUAL) {
            consider_hub(n, h);
            return;
        }
        if (w != DT_NONE)
            consider(n, w);
        h = dt_turn_ccw(m, h);
    } while (may_go_on(n) && h != m->leaving[v]);
}

/* Considers w, a neighbour of v, unless it is infinity or lies behind v as seen from q, where none is
 * nearer than v. False: that is so, certainly, and further round they are no better. */
static bool consider_ahead(struct nearest *n, uint32_t v, uint32_t w)
{
    const struct dt_point *xy = n->t->points.xy;
    if (w == DT_NONE)
        return false;
    double x = (xy[w].x - xy[v].x) * (n->q.x - xy[v].x),
           y = (xy[w].y - xy[v].y) * (n->q.y - xy[v].y);
    if (x + y < -DT_DOT_BOUND * (fabs(x) + fabs(y)))
        return false;
    consider(n, w);
    return true;
}

/* The same as consider_around for the origin of h, a corner of the triangle that q is in: from the
 * two other corners on, to the right and to the left, as far as neighbours lie ahead.
 *
 *          a ------- b       v: the origin of h, the nearest corner of the triangle that q is in
 *           \  q   /        what is nearer than v lies ahead of it: within a right angle of the
 *     left   \    /  right   direction to q
 *              v
 */
static void consider_front(struct nearest *n, uint32_t h)
{
    const struct dt_mesh *m = &n->t->mesh;
    uint32_t v = dt_origin(m, h), right = h, left = dt_turn_ccw(m, h), looks = 0;
    bool go_right = consider_ahead(n, v, dt_dest(m, h)),
         go_left = consider_ahead(n, v, dt_apex_of(m, h));
    while ((go_right || go_left) && may_go_on(n)) {
        if (++looks > USUAL) {
            consider_hub(n, h);
            return;
        }
        if (go_right) {
            right = dt_turn_cw(m, right);
            go_right = right != left && consider_ahead(n, v, dt_dest(m, right));
        }
        if (go_left) { /* the triangle behind the neighbour need not be read to know it */
            uint32_t w = dt_apex_of(m, left);
            left = dt_turn_ccw(m, left);
            go_left = left != right && consider_ahead(n, v, w);
        }
    }
}

/* Finds the triangle that q is in and begins at its nearest corner, which is returned: considers
 * all of that corner's neighbours that may be nearer. */
static uint32_t begin(struct nearest *n, uint32_t near)
{
    const struct dt *t = n->t;
    uint32_t h, first, v;
    enum dt_where where = dt_find(&t->mesh, t->points.xy, t->points.id, &t->hints, near, n->q, &h);
    h = first = dt_base(h);
    n->best = dt_candidate(t, n->q, dt_origin(&t->mesh, h));
    for (uint32_t k = h + 1; k < h + 3 && dt_origin(&t->mesh, k) != DT_NONE; k++) {
        struct dt_candidate c = dt_candidate(t, n->q, dt_origin(&t->mesh, k));
        first = c.d < n->best.d ? k : first;
        n->best = c.d < n->best.d ? c : n->best;
    }
    v = n->best.v;
    if (where == DT_OUTSIDE || dt_is_ghost(&t->mesh, h))
        consider_around(n, v);
    else if (n->best.d > 0)
        consider_front(n, first);
    return v;
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
            consider(n, dt_origin(&t->mesh, k));
}

enum dt_status dt_nearest_vertex(const struct dt *t, const struct dt_place *q, struct dt_work *work,
                                 uint32_t *nearest, bool *tie)
{
    *tie = false;
    if (t->mesh.vertices == 1) {
        *nearest = t->mesh.alone;
        return DT_OK;
    }
    struct nearest n = {.t = t, .q = q->at, .work = work};
    uint32_t v = begin(&n, q->near), sample_at = PATIENCE + dt_jump_samples(t->mesh.vertices);
    for (uint32_t steps = 0; v != n.best.v && n.status == DT_OK; steps++) {
        if (steps == PATIENCE)
            consider_hint(&n);
        if (steps == sample_at)
            consider(&n, dt_jump_vertex(&t->mesh, t->points.xy, n.best.v, n.q));
        v = n.best.v;
        consider_around(&n, v);
    }
    *tie = n.tie;
    *nearest = n.best.v;
    return n.status == DT_OK ? dt_work(work, n.steps) : n.status;
}

enum dt_status dt_nearest_ties(const struct dt *t, struct dt_point q, uint32_t v,
                               struct dt_work *work, struct dt_ids *ties)
{
    struct nearest n = {.t = t, .q = q, .best = dt_candidate(t, q, v), .ties = ties, .work = work};
    consider_around(&n, v);
    return n.status == DT_OK ? dt_work(work, n.steps) : n.status;
}
