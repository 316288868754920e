/* pointlist.c - the paper's point list, each point with the ordered ring of its neighbours: rings of single points, and
 * the order of the list. */
#include "core/control/stop.h"
#include "core/memory/sort.h"
#include "core/mesh/hull.h"
#include "core/query/hull_walk.h"
#include "core/set/set.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>
#include <string.h>

/* The ring of a point on a line depends on where the line begins. */
static void ring_on_line(const struct dt *t, const struct dt_view *v, uint32_t id, bool cw,
                         uint32_t *ring)
{
    struct dt_hull_walk w = dt_hull_walk_at(t, v, cw, dt_hull_start(t, v, cw), DT_NONE);
    while (w.id != id)
        dt_hull_walk_step(&w);
    dt_hull_walk_ring(&w, ring);
}

uint32_t dt_degree_up_to(const struct dt *t, uint32_t id, uint32_t limit)
{
    uint32_t v;
    return dt_read_vertex(t, id, &v) == DT_OK ? dt_star_degree(&t->mesh, v, limit) : 0;
}

enum dt_status dt_ring(const struct dt *t, uint32_t id, bool cw, struct dt_ids *ring, uint32_t *rep,
                       bool *boundary)
{
    return dt_view_ring(t, NULL, id, cw, ring, rep, boundary);
}

enum dt_status dt_view_ring(const struct dt *t, const struct dt_view *v, uint32_t id, bool cw,
                            struct dt_ids *ring, uint32_t *rep, bool *boundary)
{
    enum dt_status s = dt_view_readable(t, v, true);
    if (s != DT_OK)
        return s;
    uint32_t centre = dt_view_representative(t, v, id);
    if (centre == DT_NONE)
        return DT_NOPOINT;
    struct dt_star star = dt_star_of(t, v, centre);
    uint32_t degree = dt_star_count(t, &star);
    s = dt_ids_reserve(ring, degree < 2 ? 2 : degree);
    if (s != DT_OK)
        return s;
    *rep = centre;
    *boundary = star.on_hull;
    uint32_t *to = ring->v + ring->n;
    ring->n += degree;
    if (v == NULL ? dt_mesh_is_line(&t->mesh) : v->line) {
        ring_on_line(t, v, centre, cw, to);
        return DT_OK;
    }
    dt_star_copy(t, &star, to, degree);
    dt_ring_turn(to, degree, star.on_hull, cw);
    return DT_OK;
}

/* Copies the n sorted ids of hull points to `to` in hull order. */
static enum dt_status hull_order(const struct dt *t, bool cw, uint32_t *to, const uint32_t *ids,
                                 size_t n, struct dt_stop *work)
{
    enum dt_status s = dt_work(work, dt_mesh_hull(&t->mesh)); /* what dt_hull_start looks at */
    if (s != DT_OK)
        return s;
    struct dt_hull_walk w = dt_hull_walk_at(t, NULL, cw, dt_hull_start(t, NULL, cw), DT_NONE);
    for (size_t found = 0; s == DT_OK && found < n; dt_hull_walk_step(&w)) {
        if (dt_sorted_have(ids, n, w.id))
            to[found++] = w.id;
        s = dt_work(work, 1);
    }
    return s;
}

enum dt_status dt_lists_order(const struct dt *t, bool cw, uint32_t *ids, size_t n,
                              const struct dt_options *opt, size_t *kept, size_t *interior)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status s = dt_readable(t);
    uint32_t v;
    for (size_t i = 0; s == DT_OK && i < n; i++) {
        s = dt_read_vertex(t, ids[i], &v);
        if (s == DT_OK)
            s = dt_work(&work, 2);
    }
    if (s != DT_OK)
        return s;
    uint32_t *sorted = malloc((2 * n + 1) * sizeof *sorted);
    if (sorted == NULL)
        return DT_NOMEM;
    uint32_t *ordered = sorted + n;
    for (size_t i = 0; i < n; i++)
        sorted[i] = t->points.id[dt_points_vertex(&t->points, ids[i])];
    size_t distinct = dt_sort_unique(sorted, n, NULL, NULL), inside = 0, on_hull = 0;
    for (size_t i = 0; i < distinct; i++) {
        if (dt_on_hull(&t->mesh, dt_points_vertex(&t->points, sorted[i])))
            sorted[on_hull++] = sorted[i];
        else
            ordered[inside++] = sorted[i];
    }
    if (on_hull > 1)
        s = hull_order(t, cw, ordered + inside, sorted, on_hull, &work);
    else
        memcpy(ordered + inside, sorted, on_hull * sizeof *ordered);
    if (s == DT_OK) {
        if (distinct > 0) /* without ids there may be no array */
            memcpy(ids, ordered, distinct * sizeof *ids);
        *kept = distinct;
        *interior = inside;
    }
    free(sorted);
    return s;
}
