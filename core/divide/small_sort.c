/* small_sort.c - see small_sort.h.
 *
 * A crowded cell holds a dozen points as often as not, wherever points lie along lines or in clusters. A grid
 * for them would cost more than all the rest, so they are sorted along the longer side of their box and cut in
 * the middle. For a block, whose number of points is unpredictable too, the sort is compiled for every number. */
#include "core/divide/small_sort.h"

#include "core/exact/box.h"

static bool precedes(unsigned axis, struct dt_point a, struct dt_point b)
{
    return axis == 0 ? dt_before_x(a, b) : dt_before_y(a, b);
}

/* Sorts points that are nearly in order. */
static void insertion_sort(unsigned axis, struct dt_point *p, uint32_t *from, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        struct dt_point q = p[i];
        uint32_t f = from[i], j = i;
        for (; j > 0 && precedes(axis, q, p[j - 1]); j--) {
            p[j] = p[j - 1];
            from[j] = from[j - 1];
        }
        p[j] = q;
        from[j] = f;
    }
}

/* Points that share a coordinate, as in lattices, need a second sort. Returns whether there are none. -0
 * becomes 0. */
INLINE bool sort(const unsigned axis, struct dt_point *p, uint32_t *from, const uint32_t n)
{
    struct dt_point q[DT_FEW];
    double along[DT_FEW];
    uint32_t f[DT_FEW], rank[DT_FEW];
    for (uint32_t i = 0; i < n; i++) {
        q[i] = (struct dt_point){p[i].x + 0.0, p[i].y + 0.0};
        f[i] = from[i];
        along[i] = axis == 0 ? q[i].x : q[i].y;
    }
    dt_rank(along, n, rank);
    for (uint32_t i = 0; i < n; i++) {
        p[rank[i]] = q[i];
        from[rank[i]] = f[i];
    }
    bool ascending = true;
    for (uint32_t i = 1; i < n; i++)
        ascending &= axis == 0 ? p[i - 1].x < p[i].x : p[i - 1].y < p[i].y;
    if (__builtin_expect(!ascending, 0))
        insertion_sort(axis, p, from, n);
    return ascending;
}

/* Whether points in order of (x, y) are all at different places. */
INLINE bool distinct(const struct dt_point *p, const uint32_t n)
{
    bool differ = true;
    for (uint32_t i = 1; i < n; i++)
        differ &= (p[i - 1].x != p[i].x) | (p[i - 1].y != p[i].y);
    return differ;
}

INLINE bool sort_block(struct dt_point *p, uint32_t *from, const uint32_t n)
{
    return sort(0, p, from, n) || distinct(p, n);
}

bool dt_block_sort(struct dt_point *p, uint32_t *from, uint32_t n)
{
    switch (n) {
    case 1:
        return sort_block(p, from, 1);
    case 2:
        return sort_block(p, from, 2);
    case 3:
        return sort_block(p, from, 3);
    case 4:
        return sort_block(p, from, 4);
    case 5:
        return sort_block(p, from, 5);
    default:
        return sort_block(p, from, DT_BLOCK);
    }
}

unsigned dt_few_sort(struct dt_point *p, uint32_t *from, uint32_t n)
{
    struct dt_box box = dt_box_of(p, n);
    unsigned axis = dt_box_axis(&box);
    sort(axis, p, from, n);
    return axis;
}
