/* prefetch.c - prefetching for several queries at once.
 *
 * A query at a random place of a large set waits for memory about ten times, each time for an address that the
 * previous wait has delivered: cell, triangle, corners, next triangle. Different queries wait independently. So
 * all go through the same stages side by side, and the processor loads a dozen cache lines at a time where a
 * single query loads one or two. Cache lines determine the time, so only those that are certain or likely to be
 * read are fetched. Values here are rounded and serve only as hints: the queries run afterwards as usual, and find
 * their data in the caches. */
#include "core/query/prefetch.h"

#include "core/exact/predicates.h"
#include "core/hints/hints.h"
#include "core/memory/memory.h"
#include "core/query/locate.h"

enum {
    STEPS = 6, /* of walks; one in a hundred is longer */
    DEGREE = 8 /* of rings; few are longer */
};

/* ---- places ---- */

/* Fetches the data of the step from h: the third corner, and the triangles that may be next. False: there is none. */
static bool fetch_step(const struct dt *t, uint32_t h)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t apex = dt_apex_of(m, h);
    if (apex == DT_NONE)
        return false;
    dt_fetch(&t->points.xy[apex]);
    dt_fetch(&m->half[dt_twin(m, dt_next(h))]);
    dt_fetch(&m->half[dt_twin(m, dt_prev(h))]);
    return true;
}

/* Begins at the first edge of the triangle h, and on the side on which q is. False: there is no triangle. */
static bool set_out(const struct dt *t, uint32_t h, struct dt_point q, struct dt_way *w)
{
    double any = 0; /* a hint needs no bound */
    struct dt_point a = dt_way_see(t->points.xy[dt_origin(&t->mesh, h)], q);
    struct dt_point b = dt_way_see(t->points.xy[dt_origin(&t->mesh, h + 1)], q);
    *w = dt_way_side(a, b, &any) < 0 ? (struct dt_way){b, a, dt_twin(&t->mesh, h)}
                                     : (struct dt_way){a, b, h};
    return fetch_step(t, w->h);
}

/* To the next triangle. False: q is in this one. */
static bool step(const struct dt *t, struct dt_point q, struct dt_way *w)
{
    const struct dt_mesh *m = &t->mesh;
    double any = 0;
    struct dt_point c = dt_way_see(t->points.xy[dt_apex_of(m, w->h)], q);
    double next = dt_way_side(w->b, c, &any), prev = dt_way_side(c, w->a, &any);
    if (next >= 0 && prev >= 0)
        return false;
    dt_way_cross(m, w, c, next < prev);
    return true;
}

/* The place is in the triangle at h: fetches the data of the answer. These are the points beyond the
 * edges, the next triangles around the nearest corner, and the ids of the corners. */
static void arrive(const struct dt *t, uint32_t h, struct dt_place *p)
{
    const struct dt_mesh *m = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    p->near = h;
    for (uint32_t k = h; k < h + 3; k++) {
        uint32_t beyond = dt_apex_of(m, dt_twin(m, k));
        if (beyond != DT_NONE)
            dt_fetch(&xy[beyond]);
        dt_fetch(&t->points.id[dt_origin(m, k)]);
        if (dt_square_distance(xy[dt_origin(m, k)], p->at) <
            dt_square_distance(xy[dt_origin(m, p->near)], p->at))
            p->near = k;
    }
    dt_fetch(&m->half[dt_base(dt_twin(m, dt_turn_cw(m, p->near)))]);
    dt_fetch(&m->half[dt_base(dt_turn_ccw(m, dt_turn_ccw(m, p->near)))]);
}

/* One step of each of the walks `on`, way[i] to p[i]. Returns how many of them continue. */
static size_t go_on(const struct dt *t, struct dt_place *p, struct dt_way *way, uint32_t *on,
                    size_t n, enum dt_place_use use)
{
    size_t left = 0;
    for (size_t k = 0; k < n; k++) {
        uint32_t i = on[k];
        if (!step(t, p[i].at, &way[i])) {
            p[i].near = dt_base(way[i].h);
            if (use == DT_PLACE_READ)
                arrive(t, p[i].near, &p[i]);
        } else if (fetch_step(t, way[i].h)) {
            on[left++] = i;
        }
    }
    return left;
}

void dt_walk_to_places(const struct dt *t, struct dt_place *p, size_t n, enum dt_place_use use)
{
    const struct dt_mesh *m = &t->mesh;
    struct dt_way way[DT_AHEAD];
    uint32_t on[DT_AHEAD], left = 0, begun = 0;
    for (size_t i = 0; i < n; i++)
        p[i].near = DT_NONE;
    if (dt_readable(t) != DT_OK || t->hints.grids == 0)
        return;
    for (size_t i = 0; i < n; i++)
        dt_fetch(&t->hints.cell[dt_hint_cell(t->hints.grid, p[i].at)]);
    for (size_t i = 0; i < n; i++)
        dt_fetch(&m->half[way[i].h = dt_hint(&t->hints, p[i].at)]);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t h = way[i].h;
        if (dt_is_dead(m, h) || dt_is_ghost(m, h))
            continue;
        dt_fetch(&t->points.xy[dt_origin(m, h)]);
        dt_fetch(&t->points.xy[dt_origin(m, h + 1)]);
        dt_fetch(&m->half[dt_twin(m, h)]);
        on[begun++] = i;
    }
    for (uint32_t k = 0; k < begun; k++)
        if (set_out(t, way[on[k]].h, p[on[k]].at, &way[on[k]]))
            on[left++] = on[k];
    for (int round = 0; round < STEPS && left > 0; round++)
        left = (uint32_t)go_on(t, p, way, on, left, use);
}

void dt_fetch_places(const struct dt *t, struct dt_place *p, size_t n)
{
    if (n > DT_AHEAD)
        return;
    dt_walk_to_places(t, p, n, DT_PLACE_READ);
    for (size_t i = 0; i < n; i++)
        if (p[i].near != DT_NONE)
            dt_idmap_fetch(&t->points.value, t->points.id[dt_origin(&t->mesh, p[i].near)]);
}

void dt_fetch_around(const struct dt *t, uint32_t h)
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

/* ---- stars ---- */

/* Fetches the data of the neighbour at the end of the spoke h. */
static void fetch_neighbour(const struct dt *t, uint32_t h, enum dt_star_use use)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t u = dt_dest(m, h);
    if (u != DT_NONE && use == DT_STAR_READ)
        dt_fetch(&t->points.id[u]);
    if (u == DT_NONE || use == DT_STAR_READ)
        return;
    dt_fetch(&t->points.xy[u]);
    dt_fetch(&m->leaving[u]);
    dt_fetch(&m->half[dt_twin(m, dt_next(h))]);
}

void dt_walk_stars(const struct dt *t, const uint32_t *v, size_t n, enum dt_star_use use)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t at[DT_AHEAD];
    for (size_t i = 0; i < n; i++) {
        if (v[i] == DT_NONE)
            continue;
        dt_fetch(&m->leaving[v[i]]);
        dt_fetch(&t->points.id[v[i]]);
        dt_fetch(&t->points.xy[v[i]]);
    }
    for (size_t i = 0; i < n; i++) {
        at[i] = v[i] == DT_NONE ? DT_NONE : m->leaving[v[i]];
        if (at[i] != DT_NONE)
            dt_fetch(&m->half[at[i]]);
    }
    for (int round = 0; round < DEGREE; round++) {
        for (size_t i = 0; i < n; i++) {
            if (at[i] == DT_NONE)
                continue;
            fetch_neighbour(t, at[i], use);
            at[i] = dt_turn_ccw(m, at[i]);
            dt_fetch(&m->half[at[i]]);
        }
    }
}

/* ---- ids ---- */

void dt_fetch_points(const struct dt *t, const uint32_t *id, size_t n)
{
    if (n > DT_AHEAD)
        return;
    for (size_t i = 0; i < n; i++)
        dt_idmap_fetch(&t->points.value, id[i]);
    for (size_t i = 0; i < n; i++)
        if (dt_idmap_get(&t->points.value, id[i]) != DT_NONE)
            dt_points_fetch(&t->points, id[i]);
}

static void fetch_stars(const struct dt *t, const uint32_t *id, size_t n, enum dt_star_use use)
{
    uint32_t v[DT_AHEAD];
    if (dt_readable(t) != DT_OK || n > DT_AHEAD)
        return;
    for (size_t i = 0; i < n; i++)
        dt_idmap_fetch(&t->points.value, id[i]);
    for (size_t i = 0; i < n; i++)
        v[i] = dt_points_vertex(&t->points, id[i]);
    dt_walk_stars(t, v, n, use);
}

void dt_fetch_ids(const struct dt *t, const uint32_t *id, size_t n)
{
    fetch_stars(t, id, n, DT_STAR_READ);
}

void dt_fetch_edits(const struct dt *t, const uint32_t *id, size_t n)
{
    fetch_stars(t, id, n, DT_STAR_REMOVE);
}
