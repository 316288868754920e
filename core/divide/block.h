/* block.h - the triangulation of a handful of points, with which divide and conquer begins. */
#ifndef DT_BLOCK_H
#define DT_BLOCK_H

#include "core/divide/part.h"

#define DT_BLOCK 6u /* points of the largest block */

/* Triangulates the vertices lo .. lo + n - 1, 0 < n <= DT_BLOCK, which are in order of (x, y). */
struct dt_part dt_block(const struct dt_merging *w, uint32_t lo, uint32_t n);

#endif
