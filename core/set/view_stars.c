/* view_stars.c - reads stars.
 *
 * Ids are in order of arrival, vertices in spatial order, so the next id's star is anywhere in memory. Reading it takes
 * about seven cache misses, each waiting for the one before (leaving[] -> triangle -> next triangle ...). So
 * dt_stars_read walks around DT_STARS vertices in step, one triangle of each at a time, and fetches
 * ahead what each needs in its next turn. */
#include "core/set/view_stars.h"

#include "core/mesh/hull.h"
#include "core/set/view_rows.h"

#include <string.h>

/* ---- one ---- */

struct dt_star dt_star_of(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    uint32_t words;
    const uint32_t *image =
        v == NULL ? NULL : dt_view_image(&t->views, v, DT_IMAGE_RING, id, &words);
    if (image != NULL)
        return (struct dt_star){DT_NONE, image + 1, words - 1, image[0] != 0};
    uint32_t vertex = dt_points_vertex(&t->points, id);
    return (struct dt_star){vertex, NULL, 0, dt_on_hull(&t->mesh, vertex)};
}

uint32_t dt_star_copy(const struct dt *t, const struct dt_star *s, uint32_t *ring, size_t room)
{
    if (s->saved == NULL)
        return dt_star_ring(&t->mesh, t->points.id, s->vertex, ring, room);
    if (s->saved_degree > room)
        return DT_NONE;
    memcpy(ring, s->saved, s->saved_degree * sizeof *ring);
    return s->saved_degree;
}

enum dt_status dt_neighbours_read(const struct dt *t, const struct dt_view *v, uint32_t id,
                                  struct dt_neighbours *n)
{
    if (n->ring.n > 0 && n->id == id)
        return DT_OK;
    struct dt_star star = dt_star_of(t, v, id);
    uint32_t degree = n->ring.cap == 0 ? DT_NONE : dt_star_copy(t, &star, n->ring.v, n->ring.cap);
    n->ring.n = 0;
    if (degree == DT_NONE) {
        degree = dt_star_count(t, &star);
        if (dt_ids_reserve(&n->ring, degree + 1) != DT_OK)
            return DT_NOMEM;
        dt_star_copy(t, &star, n->ring.v, n->ring.cap);
    }
    n->id = id;
    n->ring.n = degree;
    n->on_hull = star.on_hull;
    return DT_OK;
}

bool dt_neighbours_have(const struct dt_neighbours *n, uint32_t id, bool ccw, uint32_t *beside)
{
    const uint32_t *ring = n->ring.v;
    size_t i = 0, last = n->ring.n - 1;
    while (i < n->ring.n && ring[i] != id)
        i++;
    *beside = DT_NONE;
    if (i == n->ring.n)
        return false;
    if (!n->on_hull || i != (ccw ? last : 0))
        *beside = ring[ccw ? (i < last ? i + 1 : 0) : (i > 0 ? i : n->ring.n) - 1];
    return true;
}

/* ---- many at once ---- */

/* The next representatives from id on, below end. */
static void read_vertices(const struct dt *t, uint32_t id, uint32_t end, uint32_t max,
                          struct dt_stars *s)
{
    const struct dt_points *p = &t->points;
    s->n = 0;
    while (s->n < max && (id = dt_points_next_live(p, id)) < end) {
        if (p->aliases.count == 0 || !dt_points_is_alias(p, id)) {
            uint32_t v = dt_points_vertex(p, id);
            __builtin_prefetch(&t->mesh.leaving[v]);
            s->id[s->n] = id;
            s->vertex[s->n] = v;
            s->n++;
        }
        id++;
    }
}

/* The star i, of an id that was a representative: filled in, if it was saved. */
static void read_representative(const struct dt *t, const struct dt_view *v, uint32_t id,
                                struct dt_stars *s, uint32_t i)
{
    uint32_t words;
    const uint32_t *image = dt_view_image(&t->views, v, DT_IMAGE_RING, id, &words);
    s->id[i] = id;
    if (image == NULL) {
        s->vertex[i] = dt_points_vertex(&t->points, id);
        __builtin_prefetch(&t->mesh.leaving[s->vertex[i]]);
        return;
    }
    s->vertex[i] = DT_NONE;
    s->on_hull[i] = image[0] != 0;
    s->degree[i] = words - 1 <= DT_STAR_MAX ? words - 1 : DT_NONE;
    if (s->degree[i] != DT_NONE)
        memcpy(s->ring[i], image + 1, s->degree[i] * sizeof *image);
}

/* The same at the moment of a view since which something has changed. */
static void read_vertices_then(const struct dt *t, const struct dt_view *v, uint32_t id,
                               uint32_t end, uint32_t max, struct dt_stars *s)
{
    struct dt_view_ids ids = dt_view_ids_begin(t, v, id);
    s->n = 0;
    for (; s->n < max && (id = dt_view_ids_next(&ids, id)) < end; id++)
        if (dt_view_representative(t, v, id) == id)
            read_representative(t, v, id, s, s->n++);
}

/* Goes one triangle further round star i, which stands at the half edge *at. False: the ring is closed, or is longer
 * than its room. Fetches the data of the neighbours that are read next, their ids or places. */
static inline bool turn(const struct dt *t, struct dt_stars *s, uint32_t i, uint32_t first,
                        uint32_t *at, bool places)
{
    uint32_t d = dt_dest(&t->mesh, *at);
    *at = dt_turn_ccw(&t->mesh, *at);
    __builtin_prefetch(&t->mesh.half[*at]);
    if (d == DT_NONE) {
        s->on_hull[i] = true;
        return *at != first;
    }
    if (s->degree[i] == DT_STAR_MAX) {
        s->degree[i] = DT_NONE;
        return false;
    }
    if (places)
        __builtin_prefetch(&t->points.xy[d]);
    else
        __builtin_prefetch(&t->points.id[d]);
    s->ring[i][s->degree[i]++] = d;
    return *at != first;
}

static inline void walk(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t end,
                        uint32_t max, bool places, struct dt_stars *s)
{
    uint32_t first[DT_STARS], at[DT_STARS], turning[DT_STARS], active = 0;
    max = max < DT_STARS ? max : DT_STARS;
    if (v == NULL)
        read_vertices(t, id, end, max, s);
    else
        read_vertices_then(t, v, id, end, max, s);
    for (uint32_t i = 0; i < s->n; i++) {
        if (s->vertex[i] == DT_NONE)
            continue;
        first[i] = at[i] = t->mesh.leaving[s->vertex[i]];
        s->degree[i] = 0;
        s->on_hull[i] = first[i] == DT_NONE; /* others: when infinity is met */
        if (first[i] != DT_NONE) {
            __builtin_prefetch(&t->mesh.half[first[i]]);
            turning[active++] = i;
        }
    }
    while (active > 0) { /* each round takes every star a triangle further */
        uint32_t left = 0;
        for (uint32_t k = 0; k < active; k++) {
            uint32_t i = turning[k];
            turning[left] = i;
            left += turn(t, s, i, first[i], &at[i], places);
        }
        active = left;
    }
}

void dt_stars_walk(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t end,
                   uint32_t max, struct dt_stars *s)
{
    walk(t, v, id, end, max, true, s);
}

void dt_stars_read(const struct dt *t, const struct dt_view *v, uint32_t id, uint32_t end,
                   uint32_t max, struct dt_stars *s)
{
    walk(t, v, id, end, max, false, s);
    for (uint32_t i = 0; i < s->n; i++)
        if (s->vertex[i] != DT_NONE && s->degree[i] != DT_NONE)
            for (uint32_t k = 0; k < s->degree[i]; k++)
                s->ring[i][k] = t->points.id[s->ring[i][k]];
}
