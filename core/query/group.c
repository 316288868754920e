/* group.c - builds groups: as a sorted list, or, for a star of many, as a heap with the greatest on
 * top. */
#include "core/query/group.h"

#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>

static inline void set_row(const struct dt_group *g, size_t i, const uint32_t *from)
{
    uint32_t *to = g->rows + i * g->width;
    to[0] = from[0];
    to[1] = from[1];
    if (g->width == 3)
        to[2] = from[2];
}

/* Puts `r` into the heap of n rows, at i or below it. */
static void sift_down(const struct dt_group *g, size_t n, size_t i, const uint32_t *r)
{
    for (size_t child; (child = 2 * i + 1) < n; i = child) {
        const uint32_t *at = g->rows + child * g->width;
        if (child + 1 < n && at[g->width + 1] > at[1])
            at = g->rows + ++child * g->width;
        if (at[1] <= r[1])
            break;
        set_row(g, i, at);
    }
    set_row(g, i, r);
}

static void add_to_heap(struct dt_group *g, const uint32_t *r)
{
    if (g->n == g->room) {
        g->more = true;
        if (r[1] < g->rows[1])
            sift_down(g, g->n, 0, r);
        return;
    }
    size_t i = g->n++;
    for (; i > 0 && g->rows[(i - 1) / 2 * g->width + 1] < r[1]; i = (i - 1) / 2)
        set_row(g, i, g->rows + (i - 1) / 2 * g->width);
    set_row(g, i, r);
}

static void add_sorted(struct dt_group *g, const uint32_t *r)
{
    size_t i = g->n;
    if (g->n == g->room) {
        g->more = true;
        if (r[1] > g->rows[--i * g->width + 1])
            return;
    } else {
        g->n++;
    }
    for (; i > 0 && g->rows[(i - 1) * g->width + 1] > r[1]; i--)
        set_row(g, i, g->rows + (i - 1) * g->width);
    set_row(g, i, r);
}

static void heap_sort(const struct dt_group *g)
{
    for (size_t n = g->n; n > 1; n--) {
        const uint32_t *end = g->rows + (n - 1) * g->width;
        uint32_t last[3] = {end[0], end[1], g->width == 3 ? end[2] : 0};
        set_row(g, n - 1, g->rows);
        sift_down(g, n - 1, 0, last);
    }
}

static inline void add(struct dt_group *g, bool heap, uint32_t b, uint32_t c)
{
    const uint32_t r[3] = {g->id, b, c};
    if (b < g->from)
        return;
    if (heap)
        add_to_heap(g, r);
    else
        add_sorted(g, r);
}

/* The triangle id b c, counterclockwise. */
static inline void add_triangle(struct dt_group *g, bool heap, uint32_t b, uint32_t c)
{
    if (b > g->id && c > g->id)
        add(g, heap, g->cw ? c : b, g->cw ? b : c);
}

static inline void add_ring(struct dt_group *g, bool heap, const uint32_t *ring, uint32_t n,
                            bool on_hull)
{
    if (g->width == 2) {
        for (uint32_t i = 0; i < n; i++)
            if (ring[i] > g->id)
                add(g, heap, ring[i], 0);
        return;
    }
    for (uint32_t i = 0; i + 1 < n; i++)
        add_triangle(g, heap, ring[i], ring[i + 1]);
    if (!on_hull)
        add_triangle(g, heap, ring[n - 1], ring[0]);
}

void dt_group_of_ring(struct dt_group *g, const uint32_t *ring, uint32_t n, bool on_hull)
{
    add_ring(g, false, ring, n, on_hull);
}

/* Looks for neighbours of g->id among all points from g->from on, until there is no room: they have it in their
 * stars. */
static enum dt_status look_for_neighbours(struct dt_group *g, const struct dt *t,
                                          const struct dt_view *v, struct dt_neighbours *around)
{
    uint32_t id = g->from > g->id ? g->from : g->id + 1, c;
    struct dt_view_ids ids = dt_view_ids_begin(t, v, id);
    for (; g->n < g->room; id++) {
        id = dt_view_ids_next(&ids, id);
        if (id == DT_NONE)
            return DT_OK;
        if (dt_view_representative(t, v, id) != id)
            continue;
        enum dt_status s = dt_neighbours_read(t, v, id, around);
        if (s != DT_OK)
            return s;
        if (dt_neighbours_have(around, g->id, g->cw, &c) &&
            (g->width == 2 || (c > g->id && c != DT_NONE)))
            add_sorted(g, (uint32_t[3]){g->id, id, c});
    }
    g->more = true;
    return DT_OK;
}

/* A table is read in pieces, and each piece walks round the whole star again. For a star with a large share of
 * all points, a scan of the points is faster: a piece continues where the last one stopped. */
enum dt_status dt_group_of_many(struct dt_group *g, const struct dt *t, const struct dt_view *v)
{
    struct dt_neighbours around = {0};
    struct dt_star star = dt_star_of(t, v, g->id);
    uint32_t many = (v == NULL ? t->mesh.vertices : v->sum.points) / 16 + 1;
    uint32_t degree =
        star.saved != NULL ? star.saved_degree : dt_star_degree(&t->mesh, star.vertex, many);
    enum dt_status s = degree >= many ? look_for_neighbours(g, t, v, &around)
                                      : dt_neighbours_read(t, v, g->id, &around);
    if (s == DT_OK && degree < many) {
        add_ring(g, true, around.ring.v, (uint32_t)around.ring.n, around.on_hull);
        heap_sort(g);
    }
    free(around.ring.v);
    return s;
}
