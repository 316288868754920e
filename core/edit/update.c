/* update.c - insert, delete, move, one point after the other, on points, mesh and grid.
 *
 * Without a triangulation, or if it awaits a rebuild (t->current is false), the points are edited in the same way. Steps
 * that would read or change the mesh do nothing, and coincident points are found by their places.
 *
 * An edit may end early: out of memory, the caller's flag, the caller's limit. Each of its changes of the
 * mesh is all or nothing, and is undone by its inverse, the latest first: the triangulation is canonical, so
 * this restores the previous one. The points change after the mesh, or where nothing can fail any more.
 *
 *     add      a point is added, its vertex is inserted, the next point ...   undo: remove, take back
 *     delete   the vertices are removed, then their points                    undo: insert
 *     move     the vertex shifts within its star, and edges are flipped       undo: flip back, shift back
 *              or it is removed, its point shifts, it is inserted             undo: the same in reverse
 *
 * If an inverse also runs out of memory, or too many inverses are needed, the mesh is discarded (lose_mesh): the next
 * dt_refresh rebuilds it from the points. */
#include "core/edit/update.h"

#include "core/control/stop.h"
#include "core/edit/batch.h"
#include "core/edit/flip.h"
#include "core/edit/insert.h"
#include "core/edit/remove.h"
#include "core/hints/hints.h"
#include "core/memory/memory.h"
#include "core/memory/sort.h"
#include "core/query/locate.h"
#include "core/query/prefetch.h"
#include "core/query/query.h"

#define LARGE_SHARE 8   /* a batch of more than 1 / LARGE_SHARE of the set is left to a rebuild */
#define USUAL_STEPS 4   /* triangles on the way of a walk from a good hint */
#define UNDO_MOST 65536 /* vertices whose edits are undone one by one */

bool dt_is_large_batch(const struct dt *t, size_t n)
{
    return n > 64 && n > dt_points_vertices(&t->points) / LARGE_SHARE;
}

bool dt_view_blocks(const struct dt *t, size_t n)
{
    return dt_is_live(t) && dt_is_large_batch(t, n) && dt_views_read_rings(&t->views);
}

static void lose_mesh(struct dt *t)
{
    t->current = false;
}

/* ---- the grid ---- */

/* As dt_find; counts how far walks go, which shows that edits have degraded the grid. */
static enum dt_where find(struct dt *t, struct dt_point q, uint32_t *half)
{
    uint32_t steps;
    enum dt_where where = dt_find_counting(t, q, half, &steps);
    if (steps > USUAL_STEPS)
        t->steps += steps - USUAL_STEPS;
    return where;
}

/* Prefetches the data that dt_hint_put at q will read. */
static void fetch_cell(const struct dt *t, struct dt_point q)
{
    if (t->hints.grids > 0)
        dt_fetch(&t->hints.cell[dt_hint_cell(t->hints.grid, q)]);
}

/* ---- one vertex ---- */

/* The place of a new point in the mesh. */
struct place {
    enum dt_where where;
    uint32_t half; /* the argument of dt_insert */
    uint32_t at;   /* the vertex at exactly that place, DT_NONE if none */
};

/* Finds q in the mesh, for the insertion of a vertex at q. */
static struct place look_up(struct dt *t, struct dt_point q)
{
    struct place p = {.where = DT_OUTSIDE, .half = DT_NONE, .at = DT_NONE};
    const struct dt_point *xy = t->points.xy;
    if (!t->current)
        return p;
    if (t->mesh.vertices == 1) {
        p.half = t->mesh.alone;
        if (xy[p.half].x == q.x && xy[p.half].y == q.y)
            p.at = p.half;
    } else if (t->mesh.vertices > 1) {
        p.where = find(t, q, &p.half);
        dt_fetch_around(t, p.half);
        if (p.where == DT_ON_VERTEX)
            p.at = dt_origin(&t->mesh, p.half);
    }
    return p;
}

/* The same when the triangle of half edge `near` is near q, unless that is DT_NONE. */
static struct place look_up_from(struct dt *t, struct dt_point q, uint32_t near)
{
    if (near == DT_NONE || t->mesh.fixed != NULL)
        return look_up(t, q);
    struct place p = {.where = DT_INSIDE, .half = near, .at = DT_NONE};
    if (dt_is_certain_conflict(&t->mesh, t->points.xy, near, q))
        return p;
    p.where = dt_walk(&t->mesh, t->points.xy, near, q, &p.half);
    if (p.where == DT_ON_VERTEX)
        p.at = dt_origin(&t->mesh, p.half);
    return p;
}

/* Makes `coincident` possible. */
static enum dt_status index_places(struct dt *t, struct dt_stop *work)
{
    return t->points.tol > 0 || !t->current ? dt_points_index(&t->points, work) : DT_OK;
}

/* The vertex other than `except` that a point at q, which was looked up, coincides with; DT_NONE if there is
 * none. Without a tolerance the mesh itself has found it. */
static uint32_t coincident(const struct dt *t, struct dt_point q, const struct place *p,
                           uint32_t except)
{
    return t->points.tol > 0 || !t->current ? dt_points_find(&t->points, q, except) : p->at;
}

static enum dt_status insert_at(struct dt *t, uint32_t v, const struct place *p)
{
    if (!t->current)
        return DT_OK;
    enum dt_status status = dt_insert(&t->mesh, t->points.xy, v, p->where, p->half, &t->scratch);
    if (status == DT_OK && t->mesh.vertices >= 2)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[v]);
    return status;
}

static enum dt_status insert_vertex(struct dt *t, uint32_t v)
{
    struct place p = look_up(t, t->points.xy[v]);
    return insert_at(t, v, &p);
}

static enum dt_status remove_vertex(struct dt *t, uint32_t v)
{
    if (!t->current)
        return DT_OK;
    uint32_t h = t->mesh.leaving[v], near = h == DT_NONE ? DT_NONE : dt_dest(&t->mesh, h);
    if (near == DT_NONE && h != DT_NONE)
        near = dt_dest(&t->mesh, dt_turn_ccw(&t->mesh, h));
    fetch_cell(t, t->points.xy[v]);
    enum dt_status status = dt_remove(&t->mesh, t->points.xy, v, &t->scratch);
    if (status == DT_OK && t->mesh.vertices >= 2)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[near]);
    return status;
}

/* Insert a vertex, where the edit can no longer be undone. */
static void settle_vertex(struct dt *t, uint32_t v)
{
    if (insert_vertex(t, v) != DT_OK)
        lose_mesh(t);
}

/* From now on the edit cannot be cancelled. */
static void commit(struct dt *t)
{
    t->scratch.work = NULL;
}

/* ---- adding ---- */

/* Adds the point q with this id, for which there is room; `near` as for look_up_from. */
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
    return insert_at(t, dt_points_enter(&t->points, id, q), &p);
}

/* Takes the vertex of a new point out of the mesh again. */
static void withdraw_one(struct dt *t, uint32_t id)
{
    const struct dt_points *p = &t->points;
    if (!dt_points_is_alias(p, id) && remove_vertex(t, dt_points_vertex(p, id)) != DT_OK)
        lose_mesh(t);
}

/* The same for the first `done` points of the batch. */
static void withdraw(struct dt *t, const struct dt_batch *b, uint32_t done)
{
    commit(t);
    if (done > UNDO_MOST)
        lose_mesh(t);
    while (done-- > 0 && t->current)
        withdraw_one(t, t->points.next_id + dt_batch_index(b, done));
}

void dt_update_take_back(struct dt *t, uint32_t n)
{
    if (n > UNDO_MOST)
        lose_mesh(t);
    for (uint32_t i = 1; i <= n && t->current; i++)
        withdraw_one(t, t->points.next_id - i);
    t->points.next_id -= n;
    dt_points_take_back(&t->points, n);
}

/* The way in which points of a batch find triangles near them. */
struct guide {
    enum {
        BY_TURNS,
        BY_WALK,
        ALONE
    } way;                /* of batch.h; from point to point; every point by the grid */
    uint32_t half, steps; /* of a walk: where it is; how many triangles it may still pass */
};

/* Walks on to q. Returns a half edge there, DT_NONE if that is not known. A walk that is too long ends: a grid is made. */
static uint32_t walk_on(struct dt *t, struct guide *w, struct dt_point q,
                        const struct dt_stop *work)
{
    if (dt_mesh_is_line(&t->mesh))
        return DT_NONE;
    if (dt_walk_within(&t->mesh, t->points.xy, w->half, q, &w->steps, &w->half))
        return w->half;
    w->way = ALONE;
    dt_tend(t, work);
    return DT_NONE;
}

/* A half edge near the point whose turn is i; DT_NONE: none is known. */
static uint32_t near_turn(struct dt *t, struct dt_batch *b, uint32_t i, struct guide *w,
                          const struct dt_stop *work)
{
    switch (w->way) {
    case BY_TURNS:
        return dt_batch_turn(t, b, i);
    case BY_WALK:
        return walk_on(t, w, b->q[dt_batch_index(b, i)], work);
    case ALONE:
        break;
    }
    return DT_NONE;
}

static enum dt_status add_batch(struct dt *t, const struct dt_point *q, size_t n,
                                struct dt_stop *work, struct guide w, struct dt_added *out)
{
    struct dt_batch b;
    struct dt_added done = {.first = t->points.next_id, .added = (uint32_t)n};
    enum dt_status status = dt_points_reserve(&t->points, n, work);
    if (status == DT_OK)
        status = index_places(t, work);
    if (status == DT_OK)
        status = dt_batch_begin(&b, t, q, (uint32_t)n, work);
    if (status != DT_OK)
        return status;
    t->scratch.work = work;
    uint32_t i = 0;
    for (; i < n; i++) {
        uint32_t near = near_turn(t, &b, i, &w, work), k = dt_batch_index(&b, i);
        status = dt_work(work, 4);
        if (status == DT_OK)
            status = add_one(t, done.first + k, q[k], near, &done);
        if (status != DT_OK)
            break;
    }
    if (status != DT_OK) {
        withdraw(t, &b, i);
        dt_points_take_back(&t->points, (uint32_t)n);
    } else {
        dt_points_arrived(&t->points, (uint32_t)n);
        *out = done;
    }
    commit(t);
    dt_batch_end(&b);
    return status;
}

enum dt_status dt_update_add(struct dt *t, const struct dt_point *q, size_t n, struct dt_stop *work,
                             struct dt_added *out)
{
    if (n == 1)
        dt_hint_fetch_cells(&t->hints, q[0]); /* they arrive while room is made */
    dt_tend(t, work);                         /* the batch needs a grid */
    return add_batch(t, q, n, work, (struct guide){.way = BY_TURNS}, out);
}

enum dt_status dt_update_add_walking(struct dt *t, const struct dt_point *q, size_t n,
                                     struct dt_stop *work, struct dt_added *out)
{
    enum { SHARE = 8 }; /* the grid costs as much as walks past some triangles for each vertex */
    struct guide w = {BY_WALK, t->mesh.hull, t->mesh.vertices / SHARE};
    if (!dt_is_live(t) || !dt_lacks_grid(t) || n > w.steps / SHARE)
        return dt_update_add(t, q, n, work, out);
    return add_batch(t, q, n, work, w, out);
}

/* ---- deleting ---- */

/* Prefetches the data of vertex v, and the triangles and vertices near it in memory. */
static void fetch_vertex(const struct dt *t, uint32_t v, int lines)
{
    dt_fetch(&t->mesh.leaving[v]);
    dt_fetch(&t->points.id[v]);
    dt_hint_fetch(&t->mesh, t->points.xy, v << 4, lines);
}

void dt_update_fetch(const struct dt *t, uint32_t v)
{
    fetch_vertex(t, v, 5);
}

/* Whether vertex v keeps its place when the n ascending ids are deleted, its representative among them.
 * With a tolerance, groups may become one meanwhile (dt_points_delete). So for several ids this is unknown in
 * advance, and the result is false. */
static bool keeps_place(const struct dt *t, uint32_t v, const uint32_t *ids, size_t n)
{
    const struct dt_points *p = &t->points;
    const struct dt_alias *heir = n == 1 || p->tol == 0 ? dt_points_heir(p, v, ids, n) : NULL;
    return heir != NULL && heir->xy.x == p->xy[v].x && heir->xy.y == p->xy[v].y;
}

/* Puts the vertices gone[n] back into the mesh, with the points as they were. */
static void put_back(struct dt *t, const uint32_t *gone, size_t n)
{
    commit(t);
    if (n > UNDO_MOST)
        lose_mesh(t);
    while (n-- > 0 && t->current)
        if (insert_vertex(t, gone[n]) != DT_OK)
            lose_mesh(t);
}

/* Lists the vertices of ids that do not keep their places, in the order of the plane: the stars that one removal reads
 * are then in the cache for the next. Returns how many. */
static size_t list_vertices(const struct dt *t, const uint32_t *ids, size_t n, struct dt_stop *stop,
                            uint32_t *v)
{
    const struct dt_points *p = &t->points;
    size_t k = 0;
    for (size_t i = 0; i < n && (i % DT_POLL_MISSES != 0 || !dt_stopped(stop)); i++) {
        if (i + DT_AHEAD < n)
            dt_idmap_fetch(&p->value, ids[i + DT_AHEAD]);
        if (dt_points_is_alias(p, ids[i]))
            continue;
        v[k] = dt_points_vertex(p, ids[i]);
        k += !keeps_place(t, v[k], ids, n);
    }
    dt_sort_ids(v, k, p->pages, stop);
    return k;
}

/* Removes those vertices of the ids from the mesh that do not keep their places, *k of them: gone[n]. */
static enum dt_status remove_vertices(struct dt *t, const uint32_t *ids, size_t n,
                                      struct dt_stop *work, uint32_t *gone, size_t *k)
{
    size_t all = list_vertices(t, ids, n, work, gone);
    enum dt_status status = dt_stop_status(work);
    for (*k = 0; *k < all && status == DT_OK; *k += status == DT_OK) {
        if (*k % DT_AHEAD == 0 && all > 1)
            dt_walk_stars(t, gone + *k, all - *k < DT_AHEAD ? all - *k : DT_AHEAD, DT_STAR_REMOVE);
        status = remove_vertex(t, gone[*k]);
        if (status == DT_OK)
            dt_tend(t, work);
    }
    return status;
}

enum dt_status dt_update_delete(struct dt *t, const uint32_t *ids, size_t n, struct dt_stop *work,
                                bool disposable)
{
    struct dt_points *p = &t->points;
    uint32_t one = DT_NONE, *gone = n == 1 || !t->current ? &one : dt_array_new(n, sizeof *gone);
    size_t k = 0;
    enum dt_status status = gone == NULL ? DT_NOMEM : dt_points_delete_ready(p, ids, n, work);
    t->scratch.work = work;
    if (status == DT_OK)
        status = t->current ? remove_vertices(t, ids, n, work, gone, &k) : dt_work(work, 2 * n);
    if (status == DT_OK) {
        commit(t);
        if (n == 1)
            dt_points_delete(p, *ids);
        else
            dt_points_delete_all(p, ids, n, disposable ? work : NULL);
        for (size_t i = 0; i < k; i++)
            if (p->id[gone[i]] != DT_NONE) /* a successor has taken it over */
                settle_vertex(t, gone[i]);
        status = dt_stop_status(work);
    } else {
        put_back(t, gone, k);
    }
    if (gone != &one)
        dt_array_free(gone);
    return status;
}

/* ---- moving ---- */

/* Whether the triangle of half edge h stays in the mesh, as it is, when v is removed. */
static bool outlives(const struct dt_mesh *m, uint32_t h, uint32_t v)
{
    const uint32_t *corner = &m->half[dt_base(h)];
    return corner[0] != v && corner[1] != v && corner[2] != v;
}

/* Vertex v, which has no aliases, moves to a place where there is no other. */
static enum dt_status move_vertex(struct dt *t, uint32_t v, struct dt_point to,
                                  const struct place *place)
{
    struct dt_points *p = &t->points;
    struct dt_point from = p->xy[v];
    bool found = t->mesh.vertices > 2 && outlives(&t->mesh, place->half, v);
    enum dt_status status = remove_vertex(t, v);
    if (status != DT_OK)
        return status;
    dt_points_shift(p, v, to);
    found = found && !dt_mesh_is_line(&t->mesh);
    status = found ? insert_at(t, v, place) : insert_vertex(t, v);
    if (status == DT_OK)
        return DT_OK;
    dt_points_shift(p, v, from);
    put_back(t, &v, 1);
    return status;
}

/* The same within the star of v, if that allows it. */
static enum dt_status move_by_flips(struct dt *t, uint32_t v, struct dt_point to, bool bound,
                                    struct dt_stop *work, bool *moved)
{
    struct dt_point from = t->points.xy[v];
    struct dt_flips f;
    enum dt_status status = dt_star_allows(&t->mesh, t->points.xy, v, to, bound, work, &f, moved);
    if (status != DT_OK || !*moved)
        return status;
    dt_points_shift(&t->points, v, to);
    status = dt_flip_all(&t->mesh, t->points.xy, &f, &t->scratch);
    *moved = status == DT_OK;
    if (*moved)
        dt_hint_put(&t->hints, to, t->mesh.leaving[v]);
    else
        dt_points_shift(&t->points, v, from);
    return status == DT_TOOBIG ? DT_OK : status;
}

/* Whether an insertion at the place is within the limit: counts the triangles that it would replace. */
static enum dt_status count_conflicts(struct dt *t, struct dt_point to, const struct place *place,
                                      const struct dt_stop *work)
{
    if (!t->current || !dt_work_is_limited(work) || dt_mesh_is_line(&t->mesh) ||
        place->at != DT_NONE)
        return DT_OK;
    return dt_find_cavity(&t->mesh, t->points.xy, dt_base(place->half), to, &t->scratch);
}

/* The same for four cases: aliases stay behind; `at` takes the point in; there is no mesh; id is an alias, and v is
 * DT_NONE. */
static enum dt_status move_among_aliases(struct dt *t, uint32_t id, struct dt_point to, uint32_t v,
                                         const struct place *place, uint32_t at,
                                         struct dt_stop *work)
{
    struct dt_points *p = &t->points;
    enum dt_status status = dt_points_move_ready(p, id, work);
    if (status == DT_OK)
        status = count_conflicts(t, to, place, work);
    bool goes = v != DT_NONE && !keeps_place(t, v, &id, 1);
    if (status == DT_OK && goes)
        status = remove_vertex(t, v);
    if (status != DT_OK)
        return status;
    commit(t);
    dt_points_delete(p, id);
    if (goes && p->id[v] != DT_NONE)
        settle_vertex(t, v);
    if (p->tol > 0)
        at = dt_points_find(p, to, DT_NONE);
    uint32_t fresh = dt_points_arrive(p, id, to, at);
    if (fresh != DT_NONE)
        settle_vertex(t, fresh);
    return DT_OK;
}

static enum dt_status move_anywhere(struct dt *t, uint32_t id, struct dt_point to, uint32_t v,
                                    struct dt_stop *work)
{
    struct place place = look_up(t, to);
    uint32_t at = coincident(t, to, &place, v);
    enum dt_status status;
    if (t->current && v != DT_NONE && at == DT_NONE &&
        dt_points_heir(&t->points, v, NULL, 0) == NULL)
        status = move_vertex(t, v, to, &place);
    else
        status = move_among_aliases(t, id, to, v, &place, at, work);
    if (status == DT_OK)
        dt_tend(t, work);
    return status;
}

/* Whether vertex v has no aliases and becomes none at the place. Within its star there is no other
 * vertex, but with a tolerance there may be one near by. */
static bool stays_alone(const struct dt_points *p, uint32_t v, struct dt_point to)
{
    return dt_points_heir(p, v, NULL, 0) == NULL &&
           (p->tol == 0 || dt_points_find(p, to, v) == DT_NONE);
}

enum dt_status dt_update_shift(struct dt *t, uint32_t v, struct dt_point to, struct dt_stop *work,
                               bool *moved)
{
    *moved = false;
    to = (struct dt_point){to.x + 0.0, to.y + 0.0};
    enum dt_status status = index_places(t, work);
    t->scratch.work = work;
    if (status == DT_OK && stays_alone(&t->points, v, to))
        status = move_by_flips(t, v, to, true, work, moved);
    commit(t);
    return status;
}

enum dt_status dt_update_move(struct dt *t, uint32_t id, struct dt_point to, struct dt_stop *work)
{
    struct dt_points *p = &t->points;
    uint32_t v = dt_points_is_alias(p, id) ? DT_NONE : dt_points_vertex(p, id);
    if (v != DT_NONE && t->current)
        fetch_vertex(t, v, 3); /* and what is near the place: */
    if (t->hints.grids > 0 && t->current)
        dt_hint_fetching(&t->hints, &t->mesh, p->xy, to);
    to = (struct dt_point){to.x + 0.0, to.y + 0.0};
    struct dt_point from = dt_points_xy(p, id);
    if (from.x == to.x && from.y == to.y)
        return DT_OK;
    enum dt_status status = index_places(t, work);
    bool moved = false;
    t->scratch.work = work;
    if (status == DT_OK && t->current && v != DT_NONE && stays_alone(p, v, to))
        status = move_by_flips(t, v, to, false, work, &moved);
    if (status == DT_OK && !moved)
        status = move_anywhere(t, id, to, v, work);
    commit(t);
    return status;
}
