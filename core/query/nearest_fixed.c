/* nearest_fixed.c - the nearest k vertices in a mesh with fixed edges, where a vertex none of whose neighbours is
 * nearer need not be a nearest one.
 *
 * 1. Triangles are visited in the order of a lower bound: the distance from q of the edge across which they are reached.
 * 2. A disc around q and the hull are convex. So triangles that meet both are connected across edges that meet the disc.
 * 3. So a vertex is next if it is nearer than all edges that wait: any vertex that is as near is in a triangle that has
 *    been visited. */
#include "core/query/locate.h"
#include "core/query/nearest.h"
#include "core/query/nearest_heap.h"
#include "core/query/visited.h"

#include <stdlib.h>

/* A triangle that waits, and the bound. */
struct waiting {
    double least;
    uint32_t h;
};

struct search {
    const struct dt *t;
    struct dt_stop *work;
    struct dt_visited triangles, vertices;
    struct dt_nearest_heap near;
    struct waiting *heap; /* owns: the least on top */
    size_t n, cap;
};

/* The triangle of h, unless it is a ghost. It may be waiting already, with a larger bound. */
static enum dt_status push(struct search *s, uint32_t h, double least)
{
    if (dt_is_ghost(&s->t->mesh, h) || least > s->near.limit)
        return DT_OK;
    struct waiting last = {least, h};
    if (dt_items_append(&s->heap, &s->n, &s->cap, &last, sizeof last) != DT_OK)
        return DT_NOMEM;
    size_t i = s->n - 1;
    for (; i > 0 && least < s->heap[(i - 1) / 2].least; i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = last;
    return DT_OK;
}

static uint32_t pop(struct search *s)
{
    uint32_t top = s->heap[0].h;
    struct waiting last = s->heap[--s->n];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < s->n; i = child) {
        child += child + 1 < s->n && s->heap[child + 1].least < s->heap[child].least;
        if (last.least <= s->heap[child].least)
            break;
        s->heap[i] = s->heap[child];
    }
    s->heap[i] = last;
    return top;
}

static enum dt_status see_vertex(struct search *s, uint32_t v)
{
    bool fresh;
    enum dt_status st = dt_visited_add(&s->vertices, v, &fresh);
    if (st != DT_OK || !fresh)
        return st;
    struct dt_seen c = dt_nearest_heap_see(&s->near, s->t->points.xy[v], v);
    return c.d > s->near.limit ? DT_OK : dt_nearest_heap_push(&s->near, c, s->work);
}

static enum dt_status visit(struct search *s, uint32_t h)
{
    const struct dt_mesh *m = &s->t->mesh;
    const struct dt_point *xy = s->t->points.xy;
    bool fresh;
    uint32_t base = dt_base(h);
    enum dt_status st = dt_visited_add(&s->triangles, h >> 3, &fresh);
    if (st != DT_OK || !fresh)
        return st;
    st = dt_work(s->work, 1);
    for (uint32_t k = base; k < base + 3 && st == DT_OK; k++)
        st = see_vertex(s, dt_origin(m, k));
    for (uint32_t k = base; k < base + 3 && st == DT_OK; k++)
        if (k != h)
            st = push(s, dt_twin(m, k),
                      dt_edge_least(s->near.q, xy[dt_origin(m, k)], xy[dt_dest(m, k)]));
    return st;
}

/* Whether the nearest vertex seen is nearer than all that wait. */
static bool is_next(const struct search *s)
{
    return s->near.n > 0 &&
           (s->n == 0 || s->near.heap[0].d * (1 + 4 * DT_DISTANCE_BOUND) < s->heap[0].least);
}

static enum dt_status search_on(struct search *s, const struct dt_place *q, struct dt_ids *out)
{
    uint32_t h;
    if (dt_find(s->t, q, &h) == DT_OUTSIDE)
        h = dt_twin(&s->t->mesh, dt_base(h));
    enum dt_status st = push(s, h | 3, 0); /* across none of its edges */
    while (st == DT_OK && s->near.wanted > 0 && s->near.n + s->n > 0) {
        if (is_next(s)) {
            out->v[out->n++] = dt_nearest_heap_pop(&s->near).key;
            s->near.wanted--;
        } else {
            st = visit(s, pop(s));
        }
    }
    return st;
}

/* ---- one ---- */

/* The nearest corner so far of the triangles visited; ties by id. */
static void consider(const struct dt *t, struct dt_point q, uint32_t v, struct dt_candidate *best)
{
    struct dt_candidate c = dt_candidate(t, q, v);
    int sign = dt_compare_candidates(t, q, c, *best);
    if (sign < 0 || (sign == 0 && t->points.id[v] < t->points.id[best->v]))
        *best = c;
}

/* Whether the edge p-r may meet the open disc around q, on whose circle is a vertex, or which has none inside. If the place of
 * the edge next to q is an end, it does not. */
static bool meets_disc(struct dt_point q, struct dt_point p, struct dt_point r, double square)
{
    double dx = r.x - p.x, dy = r.y - p.y, past = 0x1p-40 * (dx * dx + dy * dy);
    double from_p = (q.x - p.x) * dx + (q.y - p.y) * dy,
           from_r = (q.x - r.x) * dx + (q.y - r.y) * dy;
    return from_p > -past && from_r < past &&
           dt_edge_least(q, p, r) <= square * (1 + 4 * DT_DISTANCE_BOUND);
}

/* Returns the nearest vertex if q is inside of the triangle of h and at most MOST triangles meet the disc up to it.
 * Edges that meet an open disc without vertices divide it into a tree. DT_NONE: unknown. */
static uint32_t nearest_at_once(const struct dt *t, struct dt_point q, uint32_t h)
{
    enum { MOST = 32 };
    const struct dt_mesh *m = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    uint32_t edge[2 * MOST + 3], n = 0, base = dt_base(h);
    struct dt_candidate best = dt_candidate(t, q, dt_origin(m, base));
    for (uint32_t k = base; k < base + 3; k++) {
        dt_fetch(&m->half[dt_base(dt_twin(m, k))]);
        edge[n++] = k;
    }
    for (uint32_t k = base; k < base + 3; k++)
        consider(t, q, dt_origin(m, k), &best);
    for (uint32_t visited = 0; n > 0;) {
        uint32_t k = edge[--n];
        if (!meets_disc(q, xy[dt_origin(m, k)], xy[dt_dest(m, k)], best.d))
            continue;
        uint32_t g = dt_twin(m, k), apex = dt_apex_of(m, g);
        if (apex == DT_NONE)
            continue;
        if (visited++ == MOST)
            return DT_NONE;
        dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(g)))]);
        dt_fetch(&m->half[dt_base(dt_twin(m, dt_prev(g)))]);
        consider(t, q, apex, &best);
        edge[n++] = dt_next(g);
        edge[n++] = dt_prev(g);
    }
    return best.v;
}

/* ---- any number ---- */

enum dt_status dt_nearest_fixed(const struct dt *t, const struct dt_place *q, uint32_t k,
                                struct dt_stop *work, struct dt_ids *out)
{
    uint32_t h, v = DT_NONE;
    if (k == 1 && dt_find(t, q, &h) != DT_OUTSIDE)
        v = nearest_at_once(t, q->at, h);
    if (v != DT_NONE)
        return dt_ids_append(out, v);
    struct search s = {.t = t, .work = work, .near = dt_nearest_heap_of(q->at, t->points.id, k)};
    size_t n = out->n;
    dt_visited_init(&s.triangles, 5 * (size_t)k);
    dt_visited_init(&s.vertices, 5 * (size_t)k);
    enum dt_status st = dt_ids_reserve(out, k);
    if (st == DT_OK)
        st = search_on(&s, q, out);
    dt_visited_clear(&s.triangles);
    dt_visited_clear(&s.vertices);
    dt_nearest_heap_clear(&s.near);
    free(s.heap);
    if (st != DT_OK)
        out->n = n;
    return st;
}
