/* nearest_many.c - the nearest k, now or at the moment of a view: from a nearest vertex outward along edges, by a heap
 * of those seen. A vertex of high degree costs little more than one visit of each neighbour (nearest_heap.h). */
#include "core/query/nearest.h"
#include "core/query/nearest_heap.h"
#include "core/query/query.h"
#include "core/query/visited.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>

/* A search outward from near.q. Points are keyed by their vertices or, at the moment of a view, by their ids. */
struct search {
    const struct dt *t;
    const struct dt_view *then;   /* NULL: now */
    struct dt_neighbours *around; /* borrows: the star then that was read last */
    struct dt_stop *work;
    struct dt_visited seen;
    struct dt_nearest_heap near; /* seen and not yet given out */
};

static inline struct dt_seen look_at(const struct search *s, uint32_t key)
{
    struct dt_point at = s->then == NULL ? s->t->points.xy[key] : dt_view_place(s->t, s->then, key);
    return dt_nearest_heap_see(&s->near, at, key);
}

/* Pushes a point that has not been seen before, unless it is too far away; *fresh says whether it is new. */
static enum dt_status push_fresh(struct search *s, uint32_t key, bool *fresh)
{
    enum dt_status st = dt_visited_add(&s->seen, key, fresh);
    if (st != DT_OK || !*fresh)
        return st;
    struct dt_seen c = look_at(s, key);
    if (c.d > s->near.limit)
        return DT_OK;
    if (s->then == NULL)
        dt_fetch(&s->t->mesh.leaving[key]);
    return dt_nearest_heap_push(&s->near, c, s->work);
}

static enum dt_status push_star(struct search *s, uint32_t v)
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

static enum dt_status read_star(struct search *s, uint32_t id)
{
    enum dt_status st = dt_neighbours_read(s->t, s->then, id, s->around);
    return st == DT_OK ? dt_work(s->work, s->around->ring.n) : st;
}

static enum dt_status push_ring_then(struct search *s, uint32_t id)
{
    bool fresh;
    enum dt_status st = read_star(s, id);
    for (size_t i = 0; st == DT_OK && i < s->around->ring.n; i++)
        st = push_fresh(s, s->around->ring.v[i], &fresh);
    return st;
}

/* As dt_nearest_ties. */
static enum dt_status nearest_ties_then(struct search *s, uint32_t id, struct dt_ids *ties)
{
    struct dt_seen centre = look_at(s, id);
    enum dt_status st = read_star(s, id);
    for (size_t i = 0; st == DT_OK && i < s->around->ring.n; i++) {
        struct dt_seen c = look_at(s, s->around->ring.v[i]);
        if (dt_nearest_heap_compare(&s->near, &c, &centre) == 0)
            st = dt_ids_append(ties, c.key);
    }
    return st;
}

/* Pushes all points that tie with a nearest one, itself included: round the empty circle
 * on which they are, always on to a neighbour that has not been pushed. */
static enum dt_status push_ties(struct search *s, uint32_t nearest)
{
    struct dt_ids ties = {0};
    enum dt_status st = dt_ids_append(&ties, nearest);
    for (size_t i = 0; st == DT_OK && i < ties.n; i++) {
        bool fresh;
        st = push_fresh(s, ties.v[i], &fresh);
        if (st == DT_OK && fresh)
            st = s->then == NULL ? dt_nearest_ties(s->t, s->near.q, ties.v[i], s->work, &ties)
                                 : nearest_ties_then(s, ties.v[i], &ties);
    }
    free(ties.v);
    return st;
}

/* Appends the wanted points, for which there is room; `nearest` is one of the nearest, tie: there may be others as near. */
static enum dt_status search_outward(struct search *s, uint32_t nearest, bool tie,
                                     struct dt_ids *out)
{
    bool fresh;
    const uint32_t *id = s->near.id;
    enum dt_status st = tie ? push_ties(s, nearest) : push_fresh(s, nearest, &fresh);
    while (st == DT_OK && s->near.wanted > 0 && s->near.n > 0) {
        struct dt_seen c = dt_nearest_heap_pop(&s->near);
        out->v[out->n++] = id == NULL ? c.key : id[c.key];
        if (--s->near.wanted > 0)
            st = s->then == NULL ? push_star(s, c.key) : push_ring_then(s, c.key);
    }
    return st;
}

static enum dt_status append_nearest(struct search *s, uint32_t nearest, bool tie,
                                     struct dt_ids *out)
{
    size_t n = out->n;
    dt_visited_init(&s->seen, 5 * s->near.wanted);
    enum dt_status st = search_outward(s, nearest, tie, out);
    dt_visited_clear(&s->seen);
    dt_nearest_heap_clear(&s->near);
    if (st != DT_OK)
        out->n = n;
    return st;
}

/* ---- now ---- */

static enum dt_status nearest_fixed(const struct dt *t, const struct dt_place *q, uint32_t k,
                                    struct dt_stop *work, struct dt_ids *out)
{
    size_t n = out->n;
    enum dt_status st = dt_nearest_fixed(t, q, k, work, out);
    for (size_t i = n; st == DT_OK && i < out->n; i++)
        out->v[i] = t->points.id[out->v[i]];
    return st;
}

enum dt_status dt_nearest_within_work(const struct dt *t, const struct dt_place *q, uint32_t k,
                                      struct dt_stop *work, struct dt_ids *out)
{
    enum dt_status st = dt_readable(t);
    k = k < t->mesh.vertices ? k : t->mesh.vertices;
    if (st != DT_OK || k == 0)
        return st;
    if (t->mesh.fixed != NULL && !dt_mesh_is_line(&t->mesh))
        return nearest_fixed(t, q, k, work, out);
    bool tie;
    uint32_t v;
    st = dt_nearest_vertex(t, q, work, &v, &tie);
    if (st == DT_OK)
        st = dt_ids_reserve(out, k);
    if (st != DT_OK)
        return st;
    if (k > 1 || tie) {
        struct search s = {
            .t = t, .work = work, .near = dt_nearest_heap_of(q->at, t->points.id, k)};
        return append_nearest(&s, v, tie, out);
    }
    out->v[out->n++] = t->points.id[v];
    return DT_OK;
}

enum dt_status dt_nearest_place(const struct dt *t, const struct dt_place *q, uint32_t k,
                                const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    return dt_nearest_within_work(t, q, k, &work, out);
}

enum dt_status dt_nearest(const struct dt *t, struct dt_point q, uint32_t k, struct dt_ids *out)
{
    return dt_nearest_place(t, &(struct dt_place){q, DT_NONE}, k, NULL, out);
}

/* ---- at the moment of a view ---- */

/* *id becomes one of which none is nearer. */
static enum dt_status descend(struct search *s, uint32_t *id)
{
    struct dt_seen best = look_at(s, *id);
    enum dt_status st = DT_OK;
    do {
        *id = best.key;
        st = read_star(s, *id);
        for (size_t i = 0; st == DT_OK && i < s->around->ring.n; i++) {
            struct dt_seen c = look_at(s, s->around->ring.v[i]);
            if (dt_nearest_heap_compare(&s->near, &c, &best) < 0)
                best = c;
        }
    } while (st == DT_OK && best.key != *id);
    return st;
}

/* Looks at every row: for moments at which rings do not lead to the nearest points. */
static enum dt_status nearest_of_rows(struct search *s, struct dt_ids *out)
{
    struct dt_view_ids ids = dt_view_ids_begin(s->t, s->then, 0);
    enum dt_status st = DT_OK;
    uint32_t steps = 0;
    for (uint32_t id = 0; st == DT_OK && (id = dt_view_ids_next(&ids, id)) != DT_NONE; id++) {
        if (dt_view_representative(s->t, s->then, id) == id) {
            struct dt_seen c = look_at(s, id);
            st = c.d > s->near.limit ? DT_OK : dt_nearest_heap_push(&s->near, c, s->work);
        }
        if (st == DT_OK && (++steps & DT_WORK_MASK) == 0)
            st = dt_work(s->work, DT_WORK_BLOCK);
    }
    for (; st == DT_OK && s->near.wanted > 0 && s->near.n > 0; s->near.wanted--)
        out->v[out->n++] = dt_nearest_heap_pop(&s->near).key;
    dt_nearest_heap_clear(&s->near);
    return st;
}

enum dt_status dt_nearest_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                               uint32_t from, uint32_t k, struct dt_stop *work,
                               struct dt_neighbours *around, struct dt_ids *out)
{
    if (k == 0 || from == DT_NONE)
        return DT_OK;
    struct search s = {
        .t = t, .then = v, .around = around, .work = work, .near = dt_nearest_heap_of(q, NULL, k)};
    enum dt_status st = dt_ids_reserve(out, k);
    if (st == DT_OK && v->constrained)
        return nearest_of_rows(&s, out);
    if (st == DT_OK)
        st = descend(&s, &from);
    return st == DT_OK ? append_nearest(&s, from, true, out) : st;
}
