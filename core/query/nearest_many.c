/* nearest_many.c - the nearest k: from a nearest vertex outward, by a heap of those seen.
 *
 * If k results are still wanted, only the nearest k candidates matter: now and then the heap is cut down to
 * these, and from then on candidates farther than the last of them are not added. So a vertex of high degree
 * costs little more than one visit of each neighbour. */
#include "core/control/work.h"
#include "core/query/nearest.h"
#include "core/query/query.h"
#include "core/query/visited.h"
#include "core/set/reader.h"

#include <stdlib.h>

enum { SPARE = 64 }; /* candidates, so that small searches cut nothing */

/* A search outward from q: a heap of vertices seen and not yet given out, nearest on top, ties by
 * id. */
struct search {
    const struct dt *t;
    struct dt_point q;
    struct dt_work *work;
    struct dt_visited seen;
    struct dt_candidate *heap; /* owned */
    size_t n, cap;
    size_t wanted;  /* results still to come */
    double nothing; /* beyond this square of a distance, rounded, nothing is wanted */
};

static bool before(const struct search *s, struct dt_candidate a, struct dt_candidate b)
{
    int sign = dt_compare_candidates(s->t, s->q, a, b);
    return sign != 0 ? sign < 0 : s->t->points.id[a.v] < s->t->points.id[b.v];
}

static struct dt_candidate pop(struct search *s)
{
    struct dt_candidate top = s->heap[0], last = s->heap[--s->n];
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

/* Cuts the heap down to the results still wanted, which is less than half of it: the nearest ones are popped
 * into the room that they leave at its end, then brought to the front, where their order is a heap. */
static enum dt_status cut(struct search *s)
{
    size_t n = s->n, keep = s->wanted;
    enum dt_status st = DT_OK;
    for (size_t i = 0; st == DT_OK && i < keep; i++) {
        struct dt_candidate c = pop(s);
        s->heap[s->n] = c;
        if ((i & DT_WORK_MASK) == DT_WORK_MASK)
            st = dt_work(s->work, DT_WORK_BLOCK);
    }
    for (size_t i = 0; st == DT_OK && i < keep; i++)
        s->heap[i] = s->heap[n - 1 - i];
    s->n = keep;
    s->nothing = s->heap[keep - 1].d * (1 + 4 * DT_DISTANCE_BOUND);
    return st;
}

static enum dt_status push(struct search *s, struct dt_candidate c)
{
    if (s->n == s->cap) {
        size_t cap = s->cap * 2 + 32;
        struct dt_candidate *heap = realloc(s->heap, cap * sizeof *heap);
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

/* Pushes v if it is neither too far away nor seen before; *fresh says whether. */
static enum dt_status push_fresh(struct search *s, uint32_t v, bool *fresh)
{
    struct dt_candidate c = dt_candidate(s->t, s->q, v);
    *fresh = false;
    if (c.d > s->nothing)
        return DT_OK;
    enum dt_status st = dt_visited_add(&s->seen, v, fresh);
    if (st == DT_OK && *fresh) {
        dt_fetch(&s->t->mesh.leaving[v]);
        st = push(s, c);
    }
    return st == DT_OK && s->n > 2 * s->wanted + SPARE ? cut(s) : st;
}

static enum dt_status push_neighbours(struct search *s, uint32_t v)
{
    const struct dt_mesh *m = &s->t->mesh;
    enum dt_status st = DT_OK;
    uint32_t h = m->leaving[v], steps = 0;
    bool fresh;
    if (h == DT_NONE)
        return DT_OK;
    do {
        uint32_t w = dt_dest(m, h);
        dt_fetch_beyond_star(m, h);
        if (w != DT_NONE)
            st = push_fresh(s, w, &fresh);
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
    struct dt_ids ties = {0};
    enum dt_status st = dt_ids_append(&ties, v);
    for (size_t i = 0; st == DT_OK && i < ties.n; i++) {
        bool fresh;
        st = push_fresh(s, ties.v[i], &fresh);
        if (st == DT_OK && fresh)
            st = dt_nearest_ties(s->t, s->q, ties.v[i], s->work, &ties);
    }
    free(ties.v);
    return st;
}

/* Appends what is wanted; v is one of the nearest, tie: there are others as near. */
static enum dt_status search_nearest(struct search *s, uint32_t v, bool tie, struct dt_ids *out)
{
    bool fresh;
    enum dt_status st = tie ? push_ties(s, v) : push_fresh(s, v, &fresh);
    while (st == DT_OK && s->wanted > 0) {
        struct dt_candidate c = pop(s);
        out->v[out->n++] = s->t->points.id[c.v];
        if (--s->wanted > 0)
            st = push_neighbours(s, c.v);
    }
    return st;
}

/* There is room for them. */
static enum dt_status append_nearest(const struct dt *t, struct dt_point q, uint32_t v, bool tie,
                                     uint32_t k, struct dt_work *work, struct dt_ids *out)
{
    struct search s = {.t = t, .q = q, .work = work, .wanted = k, .nothing = HUGE_VAL};
    size_t n = out->n;
    dt_visited_init(&s.seen);
    enum dt_status st = search_nearest(&s, v, tie, out);
    dt_visited_clear(&s.seen);
    free(s.heap);
    if (st != DT_OK)
        out->n = n;
    return st;
}

enum dt_status dt_nearest_within_work(const struct dt *t, const struct dt_place *q, uint32_t k,
                                      struct dt_work *work, struct dt_ids *out)
{
    enum dt_status st = dt_readable(t);
    k = k < t->mesh.vertices ? k : t->mesh.vertices;
    if (st != DT_OK || k == 0)
        return st;
    bool tie;
    uint32_t v;
    st = dt_nearest_vertex(t, q, work, &v, &tie);
    if (st == DT_OK)
        st = dt_ids_reserve(out, k);
    if (st != DT_OK)
        return st;
    if (k > 1 || tie)
        return append_nearest(t, q->at, v, tie, k, work, out);
    out->v[out->n++] = t->points.id[v];
    return DT_OK;
}

enum dt_status dt_nearest_place(const struct dt *t, const struct dt_place *q, uint32_t k,
                                const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_work work = dt_work_of(opt);
    return dt_nearest_within_work(t, q, k, &work, out);
}

enum dt_status dt_nearest(const struct dt *t, struct dt_point q, uint32_t k, struct dt_ids *out)
{
    return dt_nearest_place(t, &(struct dt_place){q, DT_NONE}, k, NULL, out);
}
