/* small_sort.h - the order of a few numbers or points: the points of a block (part.h), or of two blocks, which are then cut.
 *
 * They are sorted by counting for each how many precede it: comparisons are unpredictable, and a branch that is
 * mispredicted costs more than all the rest. */
#pragma once

#include "core/divide/part.h"

#define DT_FEW 12u /* points that are not worth a grid */

/* rank[i]: how many of n keys precede key i, equal ones in their order. Cost: O(n^2), no branch. */
static inline __attribute__((always_inline)) void dt_rank(const double *key, uint32_t n,
                                                          uint32_t *rank)
{
    for (uint32_t i = 0; i < n; i++) {
        rank[i] = i;
        for (uint32_t j = 0; j < i; j++) {
            uint32_t before = key[i] < key[j];
            rank[i] -= before;
            rank[j] += before;
        }
    }
}

/* Sorts 0 < n <= DT_BLOCK points, and their names in from[], by (x, y); equal points stay in their order. -0 becomes
 * 0. Returns whether all are at different places. Cost: O(n^2), without branches. */
bool dt_block_sort(struct dt_point *p, uint32_t *from, uint32_t n);

/* Sorts DT_BLOCK < n <= DT_FEW points, and their names, for a cut along an axis, which it returns. Equal points become
 * neighbours. Cost: O(n^2), without branches. */
unsigned dt_few_sort(struct dt_point *p, uint32_t *from, uint32_t n);
