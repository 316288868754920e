/* update.c - insert, delete, move, one point after the other, on points, mesh and grid.
 *
 * The points are the truth and the mesh follows. If the mesh cannot follow for want of memory, it
 * is given up (lose_mesh): the next dt_refresh builds it anew from the points, and the result is
 * the same, since the triangulation is canonical. */
#include "core/update.h"

#include "core/hints_live.h"
#include "core/insert.h"
#include "core/local_move.h"
#include "core/memory.h"
#include "core/order.h"
#include "core/query.h"
#include "core/remove.h"

#define BULK_SHARE 8    /* a batch of more than 1 / BULK_SHARE of the set is left to a rebuild */
#define SORTED_BATCH 16 /* batches of at least so many points are inserted in grid order */
#define USUAL_STEPS 4   /* triangles on the way of a walk from a good hint */

bool dt_update_is_bulk(const struct dt *t, size_t n)
{
    return n > 64 && n > dt_points_vertices(&t->points) / BULK_SHARE;
}

static void lose_mesh(struct dt *t)
{
    t->current = false;
}

/* ---- the grid ---- */

/* Builds the grid anew when the set has outgrown it, or when walks have cost as much as that
 * would. */
static void tend_hints(struct dt *t)
{
    uint32_t n = t->mesh.vertices;
    bool outgrown = t->hints.grids == 0 ? n >= 2 : n >= 2 * t->hinted || n < t->hinted / 4;
    if (!outgrown && t->steps < (uint64_t)n + 1000)
        return;
    t->hinted = n;
    t->steps = 0;
    struct dt_hints fresh = {0};
    if (dt_hints_build(&fresh, &t->mesh, t->points.xy, NULL) == DT_OK) {
        dt_hints_clear(&t->hints);
        t->hints = fresh;
    } else if (t->hints.grids == 0) {
        lose_mesh(t);
    } /* else the old one still serves */
}

static enum dt_where find(struct dt *t, struct dt_point q, uint32_t *half)
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
        p.where = find(t, q, &p.half);
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
    if (t->hints.grids > 0 && t->mesh.vertices >= 2)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[v]);
    tend_hints(t);
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
    if (t->mesh.vertices >= 2 && t->hints.grids > 0)
        dt_hint_put(&t->hints, t->points.xy[v], t->mesh.leaving[near]);
    tend_hints(t);
}

/* ---- adding ---- */

/* A batch and the order in which it is inserted. */
struct batch {
    const struct dt_point *q;
    uint32_t *order; /* owned; NULL: as it comes */
    uint32_t n;
};

/* Sorts a batch by the cells of a grid. Points at the same place stay in their order, so that the
 * smallest id represents them; within a tolerance the order of arrival matters, so nothing is
 * sorted. */
static enum dt_status sort_batch(struct batch *b, double tol)
{
    b->order = NULL;
    if (b->n < SORTED_BATCH || tol > 0)
        return DT_OK;
    struct dt_arena arena = {0};
    struct dt_order grid;
    enum dt_status status = dt_order_plan(&grid, &arena, dt_box_of(b->q, b->n), b->n);
    uint32_t *key = dt_arena_take(&arena, b->n, sizeof *key), cells = 1u << grid.bits;
    uint32_t *next = status == DT_OK ? dt_arena_take(&arena, cells, sizeof *next) : NULL;
    b->order = dt_array_new(b->n, sizeof *b->order);
    if (key != NULL && next != NULL && b->order != NULL) {
        for (uint32_t c = 0; c < cells; c++)
            next[c] = 0;
        dt_order_count(&grid, b->q, b->n, key, next);
        for (uint32_t c = 0, place = 0; c < cells; c++) {
            uint32_t n = next[c];
            next[c] = place;
            place += n;
        }
        for (uint32_t i = 0; i < b->n; i++)
            b->order[next[key[i]]++] = i;
    } else {
        dt_array_free(b->order);
        status = DT_NOMEM;
    }
    dt_arena_clear(&arena);
    return status;
}

/* -0 becomes 0. */
static struct dt_point normal(struct dt_point q)
{
    return (struct dt_point){q.x + 0.0, q.y + 0.0};
}

static struct dt_point batch_item(const struct batch *b, uint32_t i)
{
    return normal(b->q[b->order == NULL ? i : b->order[i]]);
}

/* Point i of the batch arrives at the place p. */
static enum dt_status add_one(struct dt *t, const struct batch *b, uint32_t i, struct place p,
                              struct dt_added *done)
{
    struct dt_point q = normal(b->q[i]);
    uint32_t id = done->first + i, at = coincident(t, q, &p, DT_NONE);
    if (at != DT_NONE) {
        done->coincident++;
        return dt_points_join(&t->points, id, q, at);
    }
    insert_vertex(t, dt_points_enter(&t->points, id, q), &p, &t->scratch);
    return DT_OK;
}

/* ---- the pipeline of a batch ----
 *
 * An insertion waits for memory most of its time: for a cell of the grid, the triangle that is in
 * it, the corners, and so on. So every point of a batch goes through stages, some points before its
 * insertion each, which do what they can with what the stage before has fetched:
 *
 *     step + 3: the point itself is fetched
 *     step - 0: the cell of the grid
 *     step - 3: the triangle that the cell names, and the vertices around it
 *     step - 6: the point is located, and the neighbours of its triangle are fetched
 *     step - 8: what lies around those
 *     step - 10: the point is inserted; it is a few triangles at most from where it was found
 *
 * Insertions let no record die, so a triangle that was found earlier is still one. */
enum { STAGE_HINT = 3, STAGE_FIND = 6, STAGE_AROUND = 8, STAGE_INSERT = 10, RING = 16 };

/* A place in the two lists of what earlier deletions have left free, ahead of the insertions, which
 * take one vertex and two records each: the lists are chains of cache misses, if they are met in
 * the middle of an insertion. */
struct free_ahead {
    uint32_t vertex, record; /* DT_NONE: the list ends here */
};

static void fetch_free(const struct dt *t, struct free_ahead *f)
{
    const struct dt_points *p = &t->points;
    if (f->vertex != DT_NONE)
        f->vertex = dt_points_free_after(p, f->vertex);
    if (f->vertex != DT_NONE) {
        dt_fetch(&p->xy[f->vertex]);
        dt_fetch(&p->id[f->vertex]);
        if (f->vertex < t->mesh.vert_cap)
            dt_fetch(&t->mesh.leaving[f->vertex]);
    }
    for (int k = 0; k < 2 && f->record != DT_NONE; k++) {
        f->record = t->mesh.half[f->record];
        if (f->record != DT_NONE)
            dt_fetch(&t->mesh.half[f->record]);
    }
}

/* Whether the mesh and its grid are such that stages may go ahead. */
static bool may_go_ahead(const struct dt *t)
{
    return t->hints.grids > 0 && !dt_mesh_is_line(&t->mesh);
}

static void fetch_around(const struct dt *t, uint32_t h)
{
    const struct dt_mesh *m = &t->mesh;
    for (uint32_t k = dt_base(h); k < dt_base(h) + 3; k++) {
        uint32_t twin = dt_twin(m, k), apex = dt_apex_of(m, twin);
        dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(twin)))]);
        dt_fetch(&m->half[dt_base(dt_twin(m, dt_prev(twin)))]);
        if (dt_origin(m, k) != DT_NONE)
            dt_fetch(&m->leaving[dt_origin(m, k)]);
        if (apex != DT_NONE) {
            dt_fetch(&t->points.xy[apex]);
            dt_fetch(&m->leaving[apex]);
        }
    }
}

/* The stages before the insertion, of those points whose turn it is; near[] gets the triangles. */
static void go_ahead(struct dt *t, const struct batch *b, uint32_t step, uint32_t near[RING])
{
    const struct dt_hints *hints = &t->hints;
    if (b->order != NULL && step + STAGE_HINT < b->n)
        dt_fetch(&b->q[b->order[step + STAGE_HINT]]);
    if (step < b->n)
        dt_fetch(&hints->cell[dt_hint_cell(hints->grid, batch_item(b, step))]);
    if (step >= STAGE_HINT && step - STAGE_HINT < b->n) {
        uint32_t h = dt_hint(hints, batch_item(b, step - STAGE_HINT));
        dt_fetch(&t->mesh.half[h]);
        dt_hint_fetch(h, t->points.xy, NULL);
    }
    if (step >= STAGE_FIND && step - STAGE_FIND < b->n)
        find(t, batch_item(b, step - STAGE_FIND), &near[(step - STAGE_FIND) % RING]);
    if (step >= STAGE_AROUND && step - STAGE_AROUND < b->n &&
        near[(step - STAGE_AROUND) % RING] != DT_NONE)
        fetch_around(t, near[(step - STAGE_AROUND) % RING]);
}

/* Inserts the batch; *done counts. False: memory has run out on the way. */
static bool add_in_order(struct dt *t, const struct batch *b, struct dt_added *done)
{
    uint32_t near[RING];
    for (uint32_t k = 0; k < RING; k++)
        near[k] = DT_NONE;
    struct free_ahead ahead = {t->points.free_list, t->mesh.free_list};
    for (uint32_t step = b->n > 1 ? 0 : STAGE_INSERT; step < b->n + STAGE_INSERT; step++) {
        if (b->n > 1)
            fetch_free(t, &ahead); /* at every step, so that they stay ahead */
        if (b->n > 1 && may_go_ahead(t))
            go_ahead(t, b, step, near);
        if (step < STAGE_INSERT)
            continue;
        uint32_t i = step - STAGE_INSERT, h = near[i % RING];
        struct place p = look_up_from(t, batch_item(b, i), h);
        near[i % RING] = DT_NONE;
        if (add_one(t, b, b->order == NULL ? i : b->order[i], p, done) != DT_OK || !t->current)
            return false;
    }
    return true;
}

enum dt_status dt_update_add(struct dt *t, const struct dt_point *q, size_t n, struct dt_added *out)
{
    struct batch b = {.q = q, .n = (uint32_t)n};
    struct dt_added done = {.first = t->points.next_id, .added = (uint32_t)n};
    enum dt_status status = dt_points_reserve(&t->points, n);
    if (status == DT_OK && t->points.tol > 0)
        status = dt_points_index(&t->points);
    if (status == DT_OK)
        status = sort_batch(&b, t->points.tol);
    if (status != DT_OK)
        return status;
    bool all = add_in_order(t, &b, &done);
    dt_array_free(b.order);
    if (all) {
        dt_points_arrived(&t->points, (uint32_t)n);
        *out = done;
        return DT_OK;
    }
    /* Out of memory. Without the mesh, the points are added, or not, in the way of a set that is
     * not live. */
    dt_points_take_back(&t->points, (uint32_t)n);
    lose_mesh(t);
    return dt_points_add(&t->points, q, n, out);
}

/* ---- deleting ---- */

/* The point leaves its vertex, if it has one: to its heir, or it is removed. */
static void leave(struct dt *t, uint32_t id)
{
    struct dt_points *p = &t->points;
    uint32_t v = dt_points_is_alias(p, id) ? DT_NONE : dt_points_vertex(p, id);
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
