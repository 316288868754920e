/* ahead.c - fetching ahead for several questions at once.
 *
 * A question about a random place of a large set waits for memory about ten times, each time for an
 * address that the last wait has brought: cell, triangle, corners, next triangle. Other questions'
 * waits do not depend on them. So all are walked through the same stages side by side, and the
 * processor has a dozen lines under way where one question alone has one or two. What is computed on
 * the way is thrown away: the questions are answered afterwards, as if nothing had been, and find
 * what they read in the caches. */
#include "core/hints.h"
#include "core/memory.h"
#include "core/reader.h"

enum { STEPS = 2, DEGREE = 8 }; /* of walks and of rings; few are longer */

/* ---- places ---- */

/* > 0: q is left of a -> b, as far as rounding tells. */
static double side(struct dt_point a, struct dt_point b, struct dt_point q)
{
    return (a.x - q.x) * (b.y - q.y) - (a.y - q.y) * (b.x - q.x);
}

/* The next triangle on the way to q, t itself at the end of the way. */
static uint32_t step(const struct dt *t, uint32_t at, struct dt_point q)
{
    const struct dt_mesh *m = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    if (dt_is_dead(m, at) || dt_is_ghost(m, at))
        return at;
    for (uint32_t h = at; h < at + 3; h++)
        if (side(xy[dt_origin(m, h)], xy[dt_dest(m, h)], q) < 0)
            return dt_base(dt_twin(m, h));
    return at;
}

static void fetch_neighbours(const struct dt *t, uint32_t at)
{
    if (dt_is_dead(&t->mesh, at))
        return;
    for (uint32_t h = at; h < at + 3; h++)
        dt_fetch(&t->mesh.half[dt_base(dt_twin(&t->mesh, h))]);
}

static void fetch_corners(const struct dt *t, uint32_t at)
{
    for (uint32_t h = at; h < at + 3 && !dt_is_dead(&t->mesh, at); h++)
        if (dt_origin(&t->mesh, h) != DT_NONE)
            dt_fetch(&t->points.xy[dt_origin(&t->mesh, h)]);
}

/* What the answer will say of the corners, and the points beyond the edges. */
static void fetch_answer(const struct dt *t, uint32_t at)
{
    const struct dt_mesh *m = &t->mesh;
    if (dt_is_dead(m, at) || dt_is_ghost(m, at))
        return;
    for (uint32_t h = at; h < at + 3; h++) {
        uint32_t beyond = dt_apex_of(m, dt_twin(m, h));
        dt_idmap_fetch(&t->points.value, t->points.id[dt_origin(m, h)]);
        if (beyond != DT_NONE)
            dt_fetch(&t->points.xy[beyond]);
    }
}

void dt_fetch_places(const struct dt *t, const struct dt_point *p, size_t n)
{
    uint32_t at[DT_AHEAD];
    if (dt_readable(t) != DT_OK || t->mesh.vertices < 2 || n > DT_AHEAD)
        return;
    for (size_t i = 0; i < n; i++)
        dt_fetch(&t->hints.cell[dt_hint_cell(t->hints.grid, p[i])]);
    for (size_t i = 0; i < n; i++) {
        at[i] = dt_hint(&t->hints, p[i]);
        dt_hint_fetch(&t->mesh, t->points.xy, t->points.id, at[i]);
    }
    for (size_t i = 0; i < n; i++)
        fetch_corners(t, at[i]);
    for (int round = 0; round < STEPS; round++) {
        for (size_t i = 0; i < n; i++)
            fetch_neighbours(t, at[i]);
        for (size_t i = 0; i < n; i++)
            fetch_corners(t, at[i] = step(t, at[i], p[i]));
    }
    for (size_t i = 0; i < n; i++)
        fetch_neighbours(t, at[i]);
    for (size_t i = 0; i < n; i++)
        fetch_answer(t, at[i]);
}

/* ---- ids ---- */

void dt_fetch_ids(const struct dt *t, const uint32_t *id, size_t n)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t at[DT_AHEAD];
    if (dt_readable(t) != DT_OK || n > DT_AHEAD)
        return;
    for (size_t i = 0; i < n; i++)
        dt_idmap_fetch(&t->points.value, id[i]);
    for (size_t i = 0; i < n; i++) {
        at[i] = dt_points_vertex(&t->points, id[i]);
        if (at[i] == DT_NONE)
            continue;
        dt_fetch(&m->leaving[at[i]]);
        dt_fetch(&t->points.id[at[i]]);
        dt_fetch(&t->points.xy[at[i]]);
    }
    for (size_t i = 0; i < n; i++) {
        at[i] = at[i] == DT_NONE ? DT_NONE : m->leaving[at[i]];
        if (at[i] != DT_NONE)
            dt_fetch(&m->half[at[i]]);
    }
    for (int round = 0; round < DEGREE; round++) {
        for (size_t i = 0; i < n; i++) {
            if (at[i] == DT_NONE)
                continue;
            if (dt_dest(m, at[i]) != DT_NONE)
                dt_fetch(&t->points.id[dt_dest(m, at[i])]);
            at[i] = dt_turn_ccw(m, at[i]);
            dt_fetch(&m->half[at[i]]);
        }
    }
}
