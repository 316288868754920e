/* hull_walk.c - see hull_walk.h. What has changed since the moment of a view is walked by the rings of hull
 * points, which run from the successor to the predecessor. */
#include "core/query/hull_walk.h"

#include "core/mesh/hull.h"
#include "core/set/view_rows.h"

/* ---- by rings ---- */

/* The first or the last of the ring of a hull point. */
static uint32_t beside(const struct dt *t, const struct dt_star *s, bool last)
{
    if (s->saved != NULL)
        return s->saved[last ? s->saved_degree - 1 : 0];
    const struct dt_mesh *m = &t->mesh;
    uint32_t g = dt_hull_ghost(m, s->vertex);
    return t->points
        .id[last ? dt_hull_vertex(m, dt_hull_step(m, g, true)) : dt_hull_successor(m, g)];
}

/* The neighbour on a line that is not `before`; the only one at an end; the point itself if it is alone. */
static uint32_t onwards(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t before)
{
    struct dt_star s = dt_star_of(t, v, id);
    uint32_t ring[2] = {id, id};
    uint32_t n = dt_star_copy(t, &s, ring, 2);
    return n == 2 && ring[0] == before ? ring[1] : ring[0];
}

static bool is_end(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    struct dt_star s = dt_star_of(t, v, id);
    return dt_star_count(t, &s) < 2;
}

static uint32_t end_of_line(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    uint32_t before = DT_NONE;
    do {
        uint32_t next = onwards(t, v, id, before);
        before = id;
        id = next;
    } while (!is_end(t, v, id));
    return id;
}

static uint32_t start_then(const struct dt *t, const struct dt_view *v, bool cw)
{
    uint32_t id = v->on_hull;
    if (v->line) {
        uint32_t one = end_of_line(t, v, id), other = end_of_line(t, v, one);
        return (one < other) != cw ? one : other;
    }
    uint32_t least = id;
    do {
        struct dt_star s = dt_star_of(t, v, id);
        id = beside(t, &s, false);
        least = id < least ? id : least;
    } while (id != v->on_hull);
    return least;
}

static void step_then(struct dt_hull_walk *w)
{
    uint32_t id = w->id;
    if (w->line) {
        w->id = onwards(w->t, w->v, id, w->before);
    } else {
        struct dt_star s = dt_star_of(w->t, w->v, id);
        w->id = beside(w->t, &s, w->back);
    }
    w->before = id;
}

/* ---- either way ---- */

uint32_t dt_hull_start(const struct dt *t, const struct dt_view *v, bool cw)
{
    v = dt_view_if_changed(t, v);
    if (v != NULL)
        return v->on_hull == DT_NONE ? DT_NONE : start_then(t, v, cw);
    if (t->mesh.vertices == 0)
        return DT_NONE;
    uint32_t g = dt_hull_first(&t->mesh, t->points.id, cw);
    return t->points.id[g == DT_NONE ? t->mesh.alone : dt_hull_vertex(&t->mesh, g)];
}

/* The ghost of the point at which a walk is; on a line, where the point may have two, the one that leads
 * away from `before`. */
static uint32_t ghost_at(const struct dt *t, bool line, uint32_t id, uint32_t before)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t v = dt_points_vertex(&t->points, id);
    if (m->leaving[v] == DT_NONE)
        return DT_NONE;
    uint32_t g = dt_hull_ghost(m, v), last = dt_hull_step(m, g, true);
    if (line && before != DT_NONE && t->points.id[dt_hull_vertex(m, last)] != before)
        g = dt_base(dt_twin(m, last));
    return g;
}

struct dt_hull_walk dt_hull_walk_at(const struct dt *t, const struct dt_view *v, bool cw,
                                    uint32_t id, uint32_t before)
{
    struct dt_hull_walk w = {
        .t = t, .v = dt_view_if_changed(t, v), .ghost = DT_NONE, .id = id, .before = before};
    w.line = w.v != NULL ? v->line : dt_mesh_is_line(&t->mesh);
    w.back = cw && !w.line;
    if (w.v == NULL)
        w.ghost = ghost_at(t, w.line, id, before);
    return w;
}

void dt_hull_walk_step(struct dt_hull_walk *w)
{
    if (w->v != NULL) {
        step_then(w);
    } else if (w->ghost != DT_NONE) {
        const struct dt_mesh *m = &w->t->mesh;
        w->before = w->id;
        w->ghost = dt_hull_step(m, w->ghost, w->back);
        w->id = w->t->points.id[dt_hull_vertex(m, w->ghost)];
        dt_fetch(&m->half[dt_hull_step(m, w->ghost, w->back)]); /* for the next step */
    }
}

struct dt_star dt_hull_walk_star(const struct dt_hull_walk *w)
{
    if (w->ghost == DT_NONE)
        return dt_star_of(w->t, w->v, w->id);
    return (struct dt_star){dt_hull_vertex(&w->t->mesh, w->ghost), NULL, 0, true};
}

static uint32_t ring_by_ghosts(const struct dt_hull_walk *w, uint32_t *ring)
{
    const struct dt_mesh *m = &w->t->mesh;
    uint32_t before = dt_hull_step(m, w->ghost, true);
    ring[0] = w->t->points.id[dt_hull_successor(m, w->ghost)];
    ring[1] = w->t->points.id[dt_hull_vertex(m, before)];
    return dt_hull_turns(m, before) ? 1 : 2; /* an end has one neighbour */
}

uint32_t dt_hull_walk_ring(const struct dt_hull_walk *w, uint32_t *ring)
{
    if (w->ghost != DT_NONE)
        return ring_by_ghosts(w, ring);
    struct dt_star s = dt_star_of(w->t, w->v, w->id);
    uint32_t n = dt_star_copy(w->t, &s, ring, 2);
    if (n == 2 && ring[0] == w->before) {
        ring[0] = ring[1];
        ring[1] = w->before;
    }
    return n;
}
