/* bands_sort.c - polygons of bands: which loop of a connected part is the outer ring, and their canonical order.
 *
 * Of the loops of a connected part exactly one has a positive area, and it is greater than those of the others. Areas of the
 * rounded places differ by little, so the loop with the greatest is taken: that is wrong only where both areas are
 * within the rounding of their places. */
#include "core/contours/bands.h"

#include "core/exact/predicates.h"
#include "core/memory/sort.h"

#include <stdlib.h>
#include <string.h>

/* Lets a loop begin with its least place. If that is there several times, because rounding made it so, it begins where the
 * places that follow are least. */
static void turn_loop(struct dt_band_loop *loop, struct dt_point *spare)
{
    struct dt_point *p = loop->p;
    size_t n = loop->n, first = 0;
    for (size_t i = 1; i < n; i++) {
        int order = dt_compare_xy(p[i], p[first]);
        for (size_t k = 1; order == 0 && k < n; k++)
            order = dt_compare_xy(p[(i + k) % n], p[(first + k) % n]);
        first = order < 0 ? i : first;
    }
    memcpy(spare, p, first * sizeof *p);
    memmove(p, p + first, (n - first) * sizeof *p);
    memcpy(p + n - first, spare, first * sizeof *p);
}

static enum dt_status turn_all(struct dt_bands *b, struct dt_stop *stop)
{
    struct dt_point *spare = malloc(b->places * sizeof *spare + 1);
    struct dt_piece p = dt_pieces(0, (uint32_t)b->loops);
    if (spare == NULL)
        return DT_NOMEM;
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (uint32_t i = p.a; i < p.b; i++)
            turn_loop(&b->loop[i], spare);
    free(spare);
    return dt_stop_status(stop);
}

/* ---- polygons ---- */

static int compare_places(const struct dt_band_loop *a, const struct dt_band_loop *b)
{
    size_t n = a->n < b->n ? a->n : b->n;
    for (size_t i = 0; i < n; i++) {
        int order = dt_compare_xy(a->p[i], b->p[i]);
        if (order != 0)
            return order;
    }
    return (a->n > b->n) - (a->n < b->n);
}

/* Loops of a polygon are neighbours: the outer one first, if `hole` is known, and the holes by their places. */
static int compare_loops(const void *p, const void *q)
{
    const struct dt_band_loop *a = p, *b = q;
    if (a->class != b->class)
        return a->class < b->class ? -1 : 1;
    if (a->piece != b->piece)
        return a->piece < b->piece ? -1 : 1;
    return a->hole != b->hole ? a->hole - b->hole : compare_places(a, b);
}

static bool are_together(const struct dt_band_loop *a, const struct dt_band_loop *b)
{
    return a->class == b->class && a->piece == b->piece;
}

/* Polygons are sorted by the level, then by their rings. */
struct polygon {
    const struct dt_band_loop *loop, *end; /* the outer one, and the end of all loops */
};

static int compare_polygons(const void *p, const void *q)
{
    const struct polygon *a = p, *b = q;
    const struct dt_band_loop *i = a->loop, *k = b->loop;
    if (i->class != k->class)
        return i->class < k->class ? -1 : 1;
    int order = compare_places(i, k);
    while (order == 0 && i->piece != k->piece) { /* outer rings are equal by rounding */
        bool ends = ++i == a->end || !are_together(i, a->loop),
             other = ++k == b->end || !are_together(k, b->loop);
        if (ends || other)
            return other - ends;
        order = compare_places(i, k);
    }
    return order;
}

/* Finds the outer loop of n that belong together, and lets it be the first. */
static void find_outer(struct dt_band_loop *loop, size_t n, struct dt_stop *stop)
{
    struct dt_band_loop *outer = loop;
    struct dt_piece p = dt_pieces(0, (uint32_t)n);
    while (dt_next_piece_of(stop, DT_POLL_MISSES, &p))
        for (struct dt_band_loop *k = loop + p.a; k < loop + p.b; k++) {
            k->area = dt_polygon_area(k->p, k->n);
            k->hole = true;
            outer = k->area > outer->area ? k : outer;
        }
    outer->hole = false;
    dt_sort_items(loop, n, sizeof *loop, compare_loops, stop);
}

static size_t count_together(const struct dt_band_loop *loop, const struct dt_band_loop *end)
{
    size_t n = 1;
    while (loop + n < end && are_together(loop, loop + n))
        n++;
    return n;
}

/* Finds the polygons, each by its outer loop: into *out, of b->loops. Those whose outer loop rounding left without a
 * third place are left out. */
static size_t find_polygons(struct dt_bands *b, struct polygon *out, struct dt_stop *stop)
{
    struct dt_band_loop *end = b->loop + b->loops;
    size_t polygons = 0, n;
    dt_sort_items(b->loop, b->loops, sizeof *b->loop, compare_loops, stop);
    for (struct dt_band_loop *k = b->loop; k < end && !dt_stopped(stop); k += n) {
        n = count_together(k, end);
        if (n > 1)
            find_outer(k, n, stop);
        if (k->n >= 3)
            out[polygons++] = (struct polygon){k, end};
    }
    dt_sort_items(out, polygons, sizeof *out, compare_polygons, stop);
    return polygons;
}

static void put_ring(struct dt_bands *b, const struct dt_band_loop *k, uint32_t number)
{
    if (k->n >= 3)
        b->ring[b->rings++] = (struct dt_band_ring){.low = b->read.level[k->class - 1],
                                                    .high = b->read.level[k->class],
                                                    .number = number,
                                                    .hole = k->hole,
                                                    .p = k->p,
                                                    .n = k->n};
}

enum dt_status dt_bands_sort(struct dt_bands *b, struct dt_stop *stop)
{
    struct polygon *polygon = malloc(b->loops * sizeof *polygon + 1);
    b->ring = malloc(b->loops * sizeof *b->ring + 1);
    enum dt_status s = polygon == NULL || b->ring == NULL ? DT_NOMEM : turn_all(b, stop);
    size_t n = s == DT_OK ? find_polygons(b, polygon, stop) : 0;
    for (size_t i = 0; i < n && dt_stop_status(stop) == DT_OK; i++) {
        size_t loops = count_together(polygon[i].loop, polygon[i].end);
        for (size_t k = 0; k < loops; k++)
            put_ring(b, polygon[i].loop + k, (uint32_t)i);
    }
    free(polygon);
    return s == DT_OK ? dt_stop_status(stop) : s;
}
