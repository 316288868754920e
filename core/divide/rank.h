/* rank.h - a few numbers in order: by counting for each how many precede it. Comparisons are unpredictable,
 * and a branch that is mispredicted costs more than all the rest. */
#ifndef DT_RANK_H
#define DT_RANK_H

#include <stdint.h>

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

#endif
