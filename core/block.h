/* block.h - the triangulation of a handful of points, with which divide and conquer begins. */
#ifndef DT_BLOCK_H
#define DT_BLOCK_H

#include "core/part.h"

#define DT_BLOCK 6u /* points of the largest block */

/* Triangulates the vertices lo .. lo + n - 1, 0 < n <= DT_BLOCK; w->p and `from` are the same
 * points and where they come from, and are put in order of (x, y); NULL: they are in that order. */
struct dt_part dt_block(const struct dt_merging *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                        uint32_t n);

/* Sorts 0 < n <= DT_BLOCK points, and their names in from[], by (x, y); equal points stay in their order. -0 becomes
 * 0. Returns whether all are at different places. */
bool dt_block_sort(struct dt_point *p, uint32_t *from, uint32_t n);

/* Sorts n points, and where they come from, as cuts of the axis want them (part.h). Cost: O(n) where
 * they are nearly in order, else O(n^2). */
void dt_insertion_sort(unsigned axis, struct dt_point *p, uint32_t *from, uint32_t n);

#endif
