/* few.c - a few points: sorted along the longer side of their box, cut in the middle, two blocks, one
 * merge.
 *
 * A crowded cell holds a dozen points as often as not, wherever points lie along lines or in clusters.
 * To plan a grid for them costs more than all the rest. */
#include "core/few.h"

#include "core/box.h"
#include "core/merge.h"
#include "core/rank.h"

/* Those that share a coordinate are put right by a second sort. */
static void sort(unsigned axis, struct dt_point *p, uint32_t *from, uint32_t n)
{
    struct dt_point q[DT_FEW];
    double along[DT_FEW];
    uint32_t f[DT_FEW], rank[DT_FEW];
    bool ascending = true;
    for (uint32_t i = 0; i < n; i++) {
        q[i] = p[i];
        f[i] = from[i];
        along[i] = axis == 0 ? p[i].x : p[i].y;
    }
    dt_rank(along, n, rank);
    for (uint32_t i = 0; i < n; i++) {
        p[rank[i]] = q[i];
        from[rank[i]] = f[i];
    }
    for (uint32_t i = 1; i < n; i++)
        ascending &= axis == 0 ? p[i - 1].x < p[i].x : p[i - 1].y < p[i].y;
    if (!ascending)
        dt_insertion_sort(axis, p, from, n);
}

unsigned dt_few_sort(struct dt_point *p, uint32_t *from, uint32_t n)
{
    struct dt_box box = dt_box_of(p, n);
    unsigned axis = dt_box_axis(&box);
    sort(axis, p, from, n);
    return axis;
}

struct dt_part dt_few(const struct dt_merging *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                      uint32_t n)
{
    if (n <= DT_BLOCK)
        return dt_block(w, p, from, lo, n);
    unsigned axis = dt_few_sort(p + lo, from + lo, n);
    uint32_t half = n / 2;
    struct dt_part a = dt_block(w, p, from, lo, half);
    struct dt_part b = dt_block(w, p, from, lo + half, n - half);
    return dt_merge_parts(w, &a, &b, axis, lo + half);
}
