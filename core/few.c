/* few.c - a few points: sorted along the longer side of their box, cut in the middle, two blocks, one
 * merge.
 *
 * A crowded cell holds a dozen points as often as not, wherever points lie along lines or in clusters.
 * To plan a grid for them costs more than all the rest. */
#include "core/few.h"

#include "core/order.h"

/* Whether p comes before q along an axis, as cuts of that axis want it. */
static bool before(unsigned axis, struct dt_point p, struct dt_point q)
{
    return axis == 0 ? dt_before_x(p, q) : dt_before_y(p, q);
}

static void insertion_sort(unsigned axis, struct dt_point *p, uint32_t *from, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        struct dt_point q = p[i];
        uint32_t f = from[i], j = i;
        for (; j > 0 && before(axis, q, p[j - 1]); j--) {
            p[j] = p[j - 1];
            from[j] = from[j - 1];
        }
        p[j] = q;
        from[j] = f;
    }
}

/* By counting for each how many precede it (no branch, as in block.c), and a second sort where two of
 * them share a coordinate. */
static void sort(unsigned axis, struct dt_point *p, uint32_t *from, uint32_t n)
{
    struct dt_point q[DT_FEW];
    double along[DT_FEW];
    uint32_t f[DT_FEW], rank[DT_FEW];
    bool shared = false;
    for (uint32_t i = 0; i < n; i++) {
        q[i] = p[i];
        f[i] = from[i];
        along[i] = axis == 0 ? p[i].x : p[i].y;
        rank[i] = i;
        for (uint32_t j = 0; j < i; j++) {
            uint32_t precedes = along[i] < along[j];
            rank[i] -= precedes;
            rank[j] += precedes;
            shared |= along[i] == along[j];
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        p[rank[i]] = q[i];
        from[rank[i]] = f[i];
    }
    if (shared)
        insertion_sort(axis, p, from, n);
}

struct dt_part dt_few(const struct dt_merging *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                      uint32_t n)
{
    if (n <= DT_BLOCK)
        return dt_block(w, p, from, lo, n);
    struct dt_box box = dt_box_of(p + lo, n);
    unsigned axis = box.x1 - box.x0 >= box.y1 - box.y0 ? 0 : 1;
    sort(axis, p + lo, from + lo, n);
    uint32_t half = n / 2;
    struct dt_part a = dt_block(w, p, from, lo, half);
    struct dt_part b = dt_block(w, p, from, lo + half, n - half);
    return dt_merge_parts(w, &a, &b, axis, lo + half);
}
