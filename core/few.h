/* few.h - the triangulation of a range of points that is too small for a grid and too large for a
 * block. */
#ifndef DT_FEW_H
#define DT_FEW_H

#include "core/block.h"

#define DT_FEW 12u /* points that are not worth a grid */

/* As dt_block, for 0 < n <= DT_FEW. Cost: O(n^2), without branches. */
struct dt_part dt_few(const struct dt_merging *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                      uint32_t n);

/* Sorts DT_BLOCK < n <= DT_FEW points, and where they come from, for a cut along an axis, which it returns. Equal points
 * become neighbours. */
unsigned dt_few_sort(struct dt_point *p, uint32_t *from, uint32_t n);

#endif
