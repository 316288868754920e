/* hull_walk.c - see hull_walk.h. A walk goes from ghost to ghost. At points whose star has an image since the moment of
 * the view, it goes by the ring, which runs from the successor to the predecessor. It also does so on a line that has
 * changed since that moment. */
#include "core/query/hull_walk.h"

#include "core/mesh/hull.h"
#include "core/set/view_rows.h"

/* The ghost of the point at which a walk is. On a line the point may have two ghosts: then the ghost that
 * leads away from the point before. */
static uint32_t ghost_of(const struct dt_hull_walk *w)
{
    const struct dt_mesh *m = &w->t->mesh;
    if (w->star.saved != NULL || (w->line && w->v != NULL) || m->leaving[w->star.vertex] == DT_NONE)
        return DT_NONE;
    uint32_t g = dt_hull_ghost(m, w->star.vertex);
    if (w->line && w->before != DT_NONE) {
        uint32_t last = dt_hull_step(m, g, true);
        if (w->t->points.id[dt_hull_vertex(m, last)] != w->before)
            g = dt_base(dt_twin(m, last));
    }
    return g;
}

static void arrive(struct dt_hull_walk *w, uint32_t before, uint32_t id)
{
    w->before = before;
    w->id = id;
    w->star = dt_star_of(w->t, w->v, id);
    w->ghost = ghost_of(w);
}

struct dt_hull_walk dt_hull_walk_at(const struct dt *t, const struct dt_view *v, bool cw,
                                    uint32_t id, uint32_t before)
{
    struct dt_hull_walk w = {.t = t, .v = dt_view_if_changed(t, v)};
    w.line = w.v != NULL ? v->line : dt_mesh_is_line(&t->mesh);
    w.back = cw && !w.line;
    arrive(&w, before, id);
    return w;
}

/* The neighbour on a line that is not the point before; the only one at an end; the point itself if it is alone. */
static uint32_t next_on_line(const struct dt_hull_walk *w)
{
    uint32_t ring[2] = {w->id, w->id};
    uint32_t n = dt_star_copy(w->t, &w->star, ring, 2);
    return n == 2 && ring[0] == w->before ? ring[1] : ring[0];
}

void dt_hull_walk_step(struct dt_hull_walk *w)
{
    const struct dt_mesh *m = &w->t->mesh;
    if (w->ghost == DT_NONE) {
        uint32_t last = w->star.saved_degree - 1;
        arrive(w, w->id, w->line ? next_on_line(w) : w->star.saved[w->back ? last : 0]);
        return;
    }
    uint32_t g = dt_hull_step(m, w->ghost, w->back), u = dt_hull_vertex(m, g);
    uint32_t id = w->t->points.id[u];
    dt_fetch(&m->half[dt_hull_step(m, g, w->back)]); /* for the next step */
    if (w->v != NULL && dt_view_has(&w->t->views, w->v, DT_IMAGE_RING, id)) {
        arrive(w, w->id, id);
        return;
    }
    w->before = w->id;
    w->id = id;
    w->star.vertex = u;
    w->ghost = g;
}

static uint32_t walk_to_end_of_line(struct dt_hull_walk *w)
{
    do
        dt_hull_walk_step(w);
    while (dt_star_count(w->t, &w->star) > 1);
    return w->id;
}

uint32_t dt_hull_start(const struct dt *t, const struct dt_view *v, bool cw)
{
    v = dt_view_if_changed(t, v);
    if (v == NULL && t->mesh.vertices < 2)
        return t->mesh.vertices == 0 ? DT_NONE : t->points.id[t->mesh.alone];
    if (v == NULL)
        return t->points.id[dt_hull_vertex(&t->mesh, dt_hull_first(&t->mesh, t->points.id, cw))];
    if (v->on_hull == DT_NONE)
        return DT_NONE;
    struct dt_hull_walk w = dt_hull_walk_at(t, v, false, v->on_hull, DT_NONE);
    if (w.line) {
        uint32_t one = walk_to_end_of_line(&w), other = walk_to_end_of_line(&w);
        return (one < other) != cw ? one : other;
    }
    uint32_t least = w.id;
    for (dt_hull_walk_step(&w); w.id != v->on_hull; dt_hull_walk_step(&w))
        least = w.id < least ? w.id : least;
    return least;
}

uint32_t dt_hull_walk_ring(struct dt_hull_walk *w, uint32_t *ring)
{
    uint32_t id = w->id, before = w->before, n = 0;
    dt_hull_walk_step(w);
    if (w->id != id && w->id != before) /* at an end the walk turns back */
        ring[n++] = w->id;
    if (before != DT_NONE)
        ring[n++] = before;
    return n;
}
