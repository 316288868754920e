/* update.c - insert, delete, move, one point after the other, on points, mesh and grid.
 *
 * The points are the truth and the mesh follows. If the mesh cannot follow for want of memory, it
 * is given up (lose_mesh): the next dt_refresh builds it anew from the points, and the result is
 * the same, since the triangulation is canonical. */
#include "core/update.h"

#include "core/batch.h"
#include "core/hints_live.h"
#include "core/insert.h"
#include "core/local_move.h"
#include "core/memory.h"
#include "core/query.h"
#include "core/remove.h"
#include "core/renew.h"

#define BULK_SHARE 8  /* a batch of more than 1 / BULK_SHARE of the set is left to a rebuild */
#define USUAL_STEPS 4 /* triangles on the way of a walk from a good hint */

bool dt_update_is_bulk(const struct dt *t, size_t n)
{
    return n > 64 && n > dt_points_vertices(&t->points) / BULK_SHARE;
}

static void lose_mesh(struct dt *t)
{
    t->current = false;
}

/* ---- the grid ---- */

enum dt_where dt_update_find(struct dt *t, struct dt_point q, uint32_t *half)
{
    uint32_t steps;
    enum dt_where where = dt_find_counting(&t->mesh, t->points.xy, &t->hints, q, half, &steps);
    if (steps > USUAL_STEPS)
        t->steps += steps - USUAL_STEPS;
    return where;
}

/* ---- one vertex ---- */

/* Where a point is going to be. */
struct place {
    enum dt_where where;
    uint32_t half; /* as dt_insert wants it */
    uint32_t at;   /* the vertex at that very place, DT_NONE if none */
};

/* The vertex of a mesh that has just one. The points may have `except` in addition, which is
 * between two places. */
static uint32_t only_vertex(const struct dt *t, uint32_t except)
{
    const struct dt_points *p = &t->points;
    uint32_t id = dt_points_next_live(p, 0);
    while (dt_points_vertex(p, id) == except)
        id = dt_points_next_live(p, id + 1);
    return dt_points_vertex(p, id);
}

/* Where q is in the mesh; `except` is a vertex that the mesh has not, DT_NONE if there is none. */
static struct place look_up(struct dt *t, struct dt_point q, uint32_t except)
{
    struct place p = {.where = DT_OUTSIDE, .half = DT_NONE, .at = DT_NONE};
    const struct dt_point *xy = t->points.xy;
    if (t->mesh.vertices == 1) {
        p.half = only_vertex(t, except);
        if (xy[p.half].x == q.x && xy[p.half].y == q.y)
            p.at = p.half;
    } else if (t->mesh.vertices > 1) {
        p.where = dt_update_find(t, q, &p.half);
        if (p.where == DT_ON_VERTEX)
            p.at = dt_origin(&t->mesh, p.half);
    }
    return p;
}

/* The same when the triangle of half edge `near` is near q, unless that is DT_NONE. */
static struct place look_up_from(struct dt *t, struct dt_point q, uint32_t near)
{
    if (near == DT_NONE)
        return look_up(t, q, DT_NONE);
    struct place p = {.at = DT_NONE};
    p.where = dt_walk(&t->mesh, t->points.xy, near, q, &p.half);
    if (p.where == DT_ON_VERTEX)
        p.at = dt_origin(&t->mesh, p.half);
    return p;
}

/* The vertex that a point at q, which was looked up, coincides with, `except` left out; DT_NONE if
 * there is none. Without a tolerance the mesh itself has found it; with one, the points must be
 * indexed. */
static uint32_t coincident(const struct dt *t, struct dt_point q, const struct place *p,
                           uint32_t except)
{
    return t->points.tol > 0 ? dt_points_find(&t->points, q, except) : p->at;
}

static void insert_vertex(struct dt *t, uint32_t v, const struct place *p,
                          struct dt_cavity *scratch)
{
    if (!t->current)
        return;
    if (dt_insert(&t->mesh, t->points.xy, v, p->where, p->half, scratch) != DT_OK) {
        lose_mesh(t);
        return;
    }
    if (t->mesh.vertices >= 2)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[v]);
    dt_tend(t);
}

static void remove_vertex(struct dt *t, uint32_t v, struct dt_cavity *scratch)
{
    if (!t->current)
        return;
    uint32_t h = t->mesh.leaving[v], near = h == DT_NONE ? DT_NONE : dt_dest(&t->mesh, h);
    if (near == DT_NONE && h != DT_NONE)
        near = dt_dest(&t->mesh, dt_turn_ccw(&t->mesh, h));
    if (dt_remove(&t->mesh, t->points.xy, v, scratch) != DT_OK) {
        lose_mesh(t);
        return;
    }
    if (t->mesh.vertices >= 2)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[near]);
    dt_tend(t);
}

/* ---- adding ---- */

/* The point q with this id, for which there is room, arrives; `near` as for look_up_from. */
static enum dt_status add_one(struct dt *t, uint32_t id, struct dt_point q, uint32_t near,
                              struct dt_added *done)
{
    q = (struct dt_point){q.x + 0.0, q.y + 0.0}; /* -0 becomes 0 */
    struct place p = look_up_from(t, q, near);
    uint32_t at = coincident(t, q, &p, DT_NONE);
    if (at != DT_NONE) {
        done->coincident++;
        return dt_points_join(&t->points, id, q, at);
    }
    insert_vertex(t, dt_points_enter(&t->points, id, q), &p, &t->scratch);
    return DT_OK;
}

enum dt_status dt_update_add(struct dt *t, const struct dt_point *q, size_t n, struct dt_added *out)
{
    dt_tend(t); /* the batch wants a grid */
    struct dt_batch b;
    struct dt_added done = {.first = t->points.next_id, .added = (uint32_t)n};
    enum dt_status status = dt_points_reserve(&t->points, n);
    if (status == DT_OK && t->points.tol > 0)
        status = dt_points_index(&t->points);
    if (status == DT_OK)
        status = dt_batch_begin(&b, t, q, (uint32_t)n);
    if (status != DT_OK)
        return status;
    uint32_t i = 0;
    for (; i < n && status == DT_OK && t->current; i++) {
        uint32_t near = dt_batch_turn(t, &b, i), k = dt_batch_index(&b, i);
        status = add_one(t, done.first + k, q[k], near, &done);
    }
    dt_batch_end(&b);
    if (status == DT_OK && i == n) {
        dt_points_arrived(&t->points, (uint32_t)n);
        *out = done;
        return DT_OK;
    }
    /* Out of memory. Without the mesh, the points are added, or not, in the way of a set that is
     * not live. */
    dt_points_take_back(&t->points, (uint32_t)n);
    lose_mesh(t);
    return dt_points_add(&t->points, q, n, NULL, out);
}

/* ---- deleting ---- */

/* Fetches what the removal of v begins with; its triangles are probably where they are after a
 * build. */
static void fetch_star(const struct dt *t, uint32_t v)
{
    dt_fetch(&t->mesh.leaving[v]);
    dt_fetch(&t->points.id[v]);
    dt_hint_fetch(&t->mesh, t->points.xy, NULL, v << 4);
}

/* The point leaves its vertex, if it has one: to its heir, or it is removed. */
static void leave(struct dt *t, uint32_t id)
{
    struct dt_points *p = &t->points;
    uint32_t v = dt_points_is_alias(p, id) ? DT_NONE : dt_points_vertex(p, id);
    if (v != DT_NONE)
        fetch_star(t, v);
    const struct dt_alias *heir = v == DT_NONE ? NULL : dt_points_heir(p, v);
    bool moves = heir != NULL && (heir->xy.x != p->xy[v].x || heir->xy.y != p->xy[v].y);
    uint32_t next = heir == NULL ? DT_NONE : heir->id;
    if (v != DT_NONE && (heir == NULL || moves))
        remove_vertex(t, v, &t->scratch);
    dt_points_delete(p, id);
    if (moves && t->current && p->id[v] == next) { /* else its place was taken already */
        struct place place = look_up(t, p->xy[v], v);
        insert_vertex(t, v, &place, &t->scratch);
    }
}

enum dt_status dt_update_delete(struct dt *t, const uint32_t *ids, size_t n)
{
    struct dt_points *p = &t->points;
    if (dt_points_delete_ready(p, ids, n) != DT_OK)
        return DT_NOMEM;
    for (size_t i = 0; i < n; i++) /* aliases first, so that each group has one heir */
        if (dt_points_is_alias(p, ids[i]))
            dt_points_delete(p, ids[i]);
    for (size_t i = 0; i < n; i++)
        if (dt_points_vertex(p, ids[i]) != DT_NONE)
            leave(t, ids[i]);
    return DT_OK;
}

/* ---- moving ---- */

enum dt_status dt_update_move(struct dt *t, uint32_t id, struct dt_point to)
{
    struct dt_points *p = &t->points;
    to = (struct dt_point){to.x + 0.0, to.y + 0.0};
    struct dt_point from = dt_points_xy(p, id);
    if (from.x == to.x && from.y == to.y)
        return DT_OK;
    uint32_t v = dt_points_is_alias(p, id) ? DT_NONE : dt_points_vertex(p, id);
    if (v != DT_NONE)
        fetch_star(t, v);
    if (v != DT_NONE && p->tol == 0 && dt_points_heir(p, v) == NULL &&
        dt_stays_delaunay(&t->mesh, p->xy, v, to)) {
        dt_points_shift(p, v, to);
        dt_hint_put(&t->hints, to, t->mesh.leaving[v]);
        return DT_OK;
    }
    enum dt_status status = p->tol > 0 ? dt_points_index(p) : DT_OK;
    if (status != DT_OK)
        return status;
    struct place place = look_up(t, to, DT_NONE);
    uint32_t at = coincident(t, to, &place, v);
    status = dt_points_move_ready(p, id, at);
    if (status != DT_OK)
        return status;
    leave(t, id);
    if (t->current)
        place = look_up(t, to, DT_NONE);
    if (p->tol > 0)
        at = dt_points_find(p, to, DT_NONE);
    uint32_t fresh = dt_points_arrive(p, id, to, at);
    if (fresh != DT_NONE)
        insert_vertex(t, fresh, &place, &t->scratch);
    return DT_OK;
}
