/* nearest.c - nearest points, and the points within a disc.
 *
 * Two facts about Delaunay triangulations carry this file. Let q be any place.
 *   (1) A vertex none of whose neighbours is nearer to q is a nearest vertex: q lies in its Voronoi
 * cell, whose sides all belong to neighbours. So going to a nearer neighbour while there is one
 * finds a nearest vertex. (2) Every vertex p that is not a nearest one has a neighbour strictly
 * nearer to q: let a disc grow from p, its centre moving from p to q, until its circle meets
 * another vertex; it lies in the disc around q through p. So the nearest k, and all within a
 * radius, are connected by edges. The nearest ones, if several tie, are the corners of one empty
 * circle around q, which its triangulation connects. */
#include "core/hull.h"
#include "core/jump.h"
#include "core/predicates.h"
#include "core/query.h"
#include "core/reader.h"
#include "core/visited.h"
#include "core/work.h"

#include <math.h>
#include <stdlib.h>

#define PATIENCE 16 /* vertices on the way to a nearest one; mostly there are one or two */

/* A squared distance whose relative error is below 2^-50: four roundings. */
static double square_distance(struct dt_point a, struct dt_point b)
{
    double dx = a.x - b.x, dy = a.y - b.y;
    return dx * dx + dy * dy;
}

/* A vertex at squared distance d (rounded) from the place of the search. */
struct candidate {
    double d;
    uint32_t v;
};

/* < 0 if a is nearer to q than b, exactly. */
static int compare(const struct dt *t, struct dt_point q, struct candidate a, struct candidate b)
{
    if (fabs(a.d - b.d) > 0x1p-48 * (a.d + b.d))
        return a.d < b.d ? -1 : 1;
    return dt_compare_distance(q, t->points.xy[a.v], t->points.xy[b.v]);
}

static struct candidate candidate(const struct dt *t, struct dt_point q, uint32_t v)
{
    return (struct candidate){square_distance(t->points.xy[v], q), v};
}

/* The nearest vertex so far; tie: another one is as near. */
struct nearest {
    const struct dt *t;
    struct dt_point q;
    struct candidate best;
    bool tie;
    uint32_t steps; /* vertices considered and not yet taken off what the caller allows */
    struct dt_work *work;
    enum dt_status status; /* what the last look at that has said */
};

/* Whether the search may go on; every few vertices it asks. */
static bool may_go_on(struct nearest *n)
{
    if (++n->steps < DT_WORK_BLOCK)
        return true;
    n->steps = 0;
    n->status = dt_work(n->work, DT_WORK_BLOCK);
    return n->status == DT_OK;
}

static void consider(struct nearest *n, uint32_t w)
{
    struct candidate c = candidate(n->t, n->q, w);
    int sign = compare(n->t, n->q, c, n->best);
    n->tie = sign == 0 || (n->tie && sign > 0);
    n->best = sign < 0 ? c : n->best;
}

/* Considers all neighbours of v, which is the best so far. */
static void consider_around(struct nearest *n, uint32_t v)
{
    const struct dt_mesh *m = &n->t->mesh;
    uint32_t h = m->leaving[v];
    n->tie = false;
    do {
        uint32_t w = dt_dest(m, h);
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
    if (x + y < -0x1p-50 * (fabs(x) + fabs(y)))
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
    uint32_t v = dt_origin(m, h), right = h, left = dt_turn_ccw(m, h);
    bool go_right = consider_ahead(n, v, dt_dest(m, h)),
         go_left = consider_ahead(n, v, dt_apex_of(m, h));
    while ((go_right || go_left) && may_go_on(n)) {
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
    n->best = candidate(t, n->q, dt_origin(&t->mesh, h));
    for (uint32_t k = h + 1; k < h + 3 && dt_origin(&t->mesh, k) != DT_NONE; k++) {
        struct candidate c = candidate(t, n->q, dt_origin(&t->mesh, k));
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

/* The way is long, along a line of points say. The grid's hint for q comes from about the nearest
 * cell that has points. */
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

/* As dt_nearest_vertex; *tie: there are others as near. */
static enum dt_status descend(const struct dt *t, const struct dt_place *q, struct dt_work *work,
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

/* ---- the nearest k ---- */

/* A search outward from q: a heap of vertices seen and not yet given out, nearest on top, ties by
 * id. */
struct search {
    const struct dt *t;
    struct dt_point q;
    struct dt_work *work;
    struct dt_visited seen;
    struct candidate *heap; /* owned */
    size_t n, cap;
};

static bool before(const struct search *s, struct candidate a, struct candidate b)
{
    int sign = compare(s->t, s->q, a, b);
    return sign != 0 ? sign < 0 : s->t->points.id[a.v] < s->t->points.id[b.v];
}

static enum dt_status push(struct search *s, struct candidate c)
{
    if (s->n == s->cap) {
        size_t cap = s->cap * 2 + 32;
        struct candidate *heap = realloc(s->heap, cap * sizeof *heap);
        if (heap == NULL)
            return DT_NOMEM;
        s->heap = heap;
        s->cap = cap;
    }
    size_t i = s->n++;
    for (; i > 0 && before(s, c, s->heap[(i - 1) / 2]); i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = c;
    return DT_OK;
}

static struct candidate pop(struct search *s)
{
    struct candidate top = s->heap[0], last = s->heap[--s->n];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < s->n; i = child) {
        if (child + 1 < s->n && before(s, s->heap[child + 1], s->heap[child]))
            child++;
        if (!before(s, s->heap[child], last))
            break;
        s->heap[i] = s->heap[child];
    }
    s->heap[i] = last;
    return top;
}

/* Pushes v unless it was seen before. */
static enum dt_status push_fresh(struct search *s, uint32_t v)
{
    bool fresh;
    enum dt_status st = dt_visited_add(&s->seen, v, &fresh);
    return st == DT_OK && fresh ? push(s, candidate(s->t, s->q, v)) : st;
}

static enum dt_status push_neighbours(struct search *s, uint32_t v)
{
    const struct dt_mesh *m = &s->t->mesh;
    enum dt_status st = DT_OK;
    uint32_t h = m->leaving[v], steps = 0;
    if (h == DT_NONE)
        return DT_OK;
    do {
        uint32_t w = dt_dest(m, h);
        if (w != DT_NONE)
            st = push_fresh(s, w);
        h = dt_turn_ccw(m, h);
        if (st == DT_OK && (++steps & DT_WORK_MASK) == 0)
            st = dt_work(s->work, DT_WORK_BLOCK);
    } while (st == DT_OK && h != m->leaving[v]);
    return st == DT_OK ? dt_work(s->work, steps & DT_WORK_MASK) : st;
}

/* Pushes all vertices that tie with the nearest vertex v, itself included: round the empty circle
 * on which they are, always on to a neighbour that has not been pushed. */
static enum dt_status push_ties(struct search *s, uint32_t v)
{
    const struct dt_mesh *m = &s->t->mesh;
    struct dt_ids ties = {0};
    enum dt_status st = dt_ids_append(&ties, v);
    for (size_t i = 0; st == DT_OK && i < ties.n; i++) {
        size_t pushed = s->n;
        st = push_fresh(s, ties.v[i]);
        if (st != DT_OK || s->n == pushed)
            continue;
        uint32_t first = m->leaving[ties.v[i]], h = first;
        do {
            uint32_t w = dt_dest(m, h);
            st = dt_work(s->work, 1);
            if (st == DT_OK && w != DT_NONE &&
                dt_compare_distance(s->q, s->t->points.xy[w], s->t->points.xy[v]) == 0)
                st = dt_ids_append(&ties, w);
            h = dt_turn_ccw(m, h);
        } while (st == DT_OK && h != first);
    }
    free(ties.v);
    return st;
}

/* Appends the nearest k; v is one of the nearest, tie: there are others as near. */
static enum dt_status search_nearest(struct search *s, uint32_t v, bool tie, size_t k,
                                     struct dt_ids *out)
{
    enum dt_status st = tie ? push_ties(s, v) : push_fresh(s, v);
    for (size_t end = out->n + k; st == DT_OK && out->n < end;) {
        struct candidate c = pop(s);
        out->v[out->n++] = s->t->points.id[c.v];
        if (out->n < end)
            st = push_neighbours(s, c.v);
    }
    return st;
}

/* There is room for them. */
static enum dt_status append_nearest(const struct dt *t, struct dt_point q, uint32_t v, bool tie,
                                     uint32_t k, struct dt_work *work, struct dt_ids *out)
{
    struct search s = {.t = t, .q = q, .work = work};
    size_t n = out->n;
    dt_visited_init(&s.seen);
    enum dt_status st = search_nearest(&s, v, tie, k, out);
    dt_visited_clear(&s.seen);
    free(s.heap);
    if (st != DT_OK)
        out->n = n;
    return st;
}

enum dt_status dt_nearest_place(const struct dt *t, const struct dt_place *q, uint32_t k,
                                const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_work work = dt_work_of(opt);
    enum dt_status st = dt_readable(t);
    k = k < t->mesh.vertices ? k : t->mesh.vertices;
    if (st != DT_OK || k == 0)
        return st;
    bool tie;
    uint32_t v;
    st = descend(t, q, &work, &v, &tie);
    if (st == DT_OK)
        st = dt_ids_reserve(out, k);
    if (st != DT_OK)
        return st;
    if (k > 1 || tie)
        return append_nearest(t, q->at, v, tie, k, &work, out);
    out->v[out->n++] = t->points.id[v];
    return DT_OK;
}

enum dt_status dt_nearest(const struct dt *t, struct dt_point q, uint32_t k, struct dt_ids *out)
{
    return dt_nearest_place(t, &(struct dt_place){q, DT_NONE}, k, NULL, out);
}

/* ---- within a disc ---- */

static bool in_disc(const struct dt *t, uint32_t v, struct dt_point centre, double r)
{
    return dt_compare_radius(t->points.xy[v], centre, r) <= 0;
}

static enum dt_status scan_disc(const struct dt *t, struct dt_point centre, double r,
                                struct dt_work *work, struct dt_ids *out)
{
    enum dt_status st = DT_OK;
    for (uint32_t v = 0; v < t->points.end && st == DT_OK; v++) {
        if (t->points.id[v] != DT_NONE && in_disc(t, v, centre, r))
            st = dt_ids_append(out, v);
        if (st == DT_OK && (v & DT_WORK_MASK) == 0)
            st = dt_work(work, DT_WORK_BLOCK);
    }
    return st;
}

/* Appends all vertices within r of the centre that can be reached from the one at out->v[n], until
 * a scan pays. */
static enum dt_status flood_disc(const struct dt *t, struct dt_point centre, double r,
                                 struct dt_visited *seen, size_t n, struct dt_work *work,
                                 struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    for (size_t i = n; i < out->n && m->vertices > 1 && !dt_scan_pays(t, out->n - n); i++) {
        uint32_t first = m->leaving[out->v[i]], h = first;
        do {
            uint32_t w = dt_dest(m, h);
            bool fresh = false;
            enum dt_status st = dt_work(work, 1);
            if (st == DT_OK && w != DT_NONE && in_disc(t, w, centre, r))
                st = dt_visited_add(seen, w, &fresh);
            if (st == DT_OK && fresh)
                st = dt_ids_append(out, w);
            if (st != DT_OK)
                return st;
            h = dt_turn_ccw(m, h);
        } while (h != first);
    }
    return DT_OK;
}

enum dt_status dt_within_disc(const struct dt *t, struct dt_point centre, double r,
                              const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_work work = dt_work_of(opt);
    enum dt_status st = dt_readable(t);
    if (st != DT_OK || t->mesh.vertices == 0)
        return st;
    bool tie;
    uint32_t v = DT_NONE;
    st = descend(t, &(struct dt_place){centre, DT_NONE}, &work, &v, &tie);
    if (st != DT_OK || !in_disc(t, v, centre, r))
        return st;
    struct dt_visited seen;
    bool fresh;
    size_t n = out->n;
    dt_visited_init(&seen);
    st = dt_visited_add(&seen, v, &fresh);
    if (st == DT_OK)
        st = dt_ids_append(out, v);
    if (st == DT_OK)
        st = flood_disc(t, centre, r, &seen, n, &work, out);
    dt_visited_clear(&seen);
    if (st == DT_OK && dt_scan_pays(t, out->n - n)) {
        out->n = n;
        st = scan_disc(t, centre, r, &work, out);
    }
    if (st == DT_OK)
        dt_vertices_to_ids(t, out->v + n, out->n - n);
    else
        out->n = n;
    return st;
}
