/* pointlist.c - rings of single points and the order of the point list. */
#include "core/pointlist.h"

#include "core/hull.h"
#include "core/reader.h"
#include "core/star.h"
#include "core/work.h"

#include <stdlib.h>
#include <string.h>

static void reverse(uint32_t *v, uint32_t n)
{
    for (uint32_t i = 0; i < n / 2; i++) {
        uint32_t swap = v[i];
        v[i] = v[n - 1 - i];
        v[n - 1 - i] = swap;
    }
}

void dt_ring_turn(uint32_t *ring, uint32_t n, bool on_hull, bool cw)
{
    if (cw)
        reverse(ring, n);
    if (on_hull)
        return;
    uint32_t least = 0;
    for (uint32_t i = 1; i < n; i++)
        if (ring[i] < ring[least])
            least = i;
    if (least == 0)
        return;
    reverse(ring, least);
    reverse(ring + least, n - least);
    reverse(ring, n);
}

uint32_t dt_ring_on_line(const struct dt *t, uint32_t g, uint32_t *ring)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t before = dt_hull_step(m, g, true);
    ring[0] = t->points.id[dt_hull_successor(m, g)];
    if (dt_hull_turns(m, before)) /* an end has one neighbour */
        return 1;
    ring[1] = t->points.id[dt_hull_vertex(m, before)];
    return 2;
}

static void append_on_line(const struct dt *t, uint32_t v, bool cw, struct dt_ids *ring)
{
    uint32_t g = dt_hull_first(&t->mesh, t->points.id, cw);
    if (g == DT_NONE)
        return;
    while (dt_hull_vertex(&t->mesh, g) != v)
        g = dt_hull_step(&t->mesh, g, false);
    ring->n += dt_ring_on_line(t, g, ring->v + ring->n);
}

uint32_t dt_degree_up_to(const struct dt *t, uint32_t id, uint32_t limit)
{
    uint32_t v;
    return dt_read_vertex(t, id, &v) == DT_OK ? dt_star_degree(&t->mesh, v, limit) : 0;
}

enum dt_status dt_ring(const struct dt *t, uint32_t id, bool cw, struct dt_ids *ring, uint32_t *rep,
                       bool *boundary)
{
    uint32_t v;
    enum dt_status s = dt_read_vertex(t, id, &v);
    if (s != DT_OK)
        return s;
    uint32_t degree = dt_star_degree(&t->mesh, v, DT_NONE);
    s = dt_ids_reserve(ring, degree);
    if (s != DT_OK)
        return s;
    *rep = t->points.id[v];
    *boundary = dt_on_hull(&t->mesh, v);
    if (dt_mesh_is_line(&t->mesh)) {
        append_on_line(t, v, cw, ring);
        return DT_OK;
    }
    if (degree > 0) {
        dt_star_ring(t, v, ring->v + ring->n);
        dt_ring_turn(ring->v + ring->n, degree, *boundary, cw);
        ring->n += degree;
    }
    return DT_OK;
}

static int compare_ids(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

/* Sorts ids and leaves each once; returns how many are left. */
static size_t sort_unique(uint32_t *ids, size_t n)
{
    size_t kept = 0;
    if (n > 1)
        qsort(ids, n, sizeof *ids, compare_ids);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || ids[kept - 1] != ids[i])
            ids[kept++] = ids[i];
    return kept;
}

/* Copies the n sorted ids of hull points to `to` in hull order. */
static enum dt_status hull_order(const struct dt *t, bool cw, uint32_t *to, const uint32_t *ids,
                                 size_t n, struct dt_work *work)
{
    const struct dt_mesh *m = &t->mesh;
    bool back = cw && !dt_mesh_is_line(m);
    enum dt_status s = dt_work(work, dt_mesh_hull(m)); /* what dt_hull_first looks at */
    uint32_t g = s == DT_OK ? dt_hull_first(m, t->points.id, cw) : DT_NONE;
    for (size_t found = 0; s == DT_OK && found < n; g = dt_hull_step(m, g, back)) {
        const uint32_t *id = &t->points.id[dt_hull_vertex(m, g)];
        if (bsearch(id, ids, n, sizeof *ids, compare_ids) != NULL)
            to[found++] = *id;
        s = dt_work(work, 1);
    }
    return s;
}

enum dt_status dt_lists_order(const struct dt *t, bool cw, uint32_t *ids, size_t n,
                              const struct dt_options *opt, size_t *kept, size_t *interior)
{
    struct dt_work work = dt_work_of(opt);
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
    size_t distinct = sort_unique(sorted, n), inside = 0, on_hull = 0;
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
        memcpy(ids, ordered, distinct * sizeof *ids);
        *kept = distinct;
        *interior = inside;
    }
    free(sorted);
    return s;
}
