/* median.h - parts points at their median, in linear time for every order. */
#pragma once

#include "core/control/stop.h"

/* Rearranges n > 0 points, and from[] with them: the first n / 2 precede the others by (x, y) if axis is 0, by (y, -x)
 * if it is 1. If several arrangements are possible, the result depends only on the arrays.
 * Returns the range of the points that coincide with point n / 2, itself included: all points before the range precede
 * them, all points after it follow. Cost: O(n), at most 12 rounds over the points. If it is stopped, the points are in
 * some order. */
struct dt_piece dt_median_part(struct dt_point *p, uint32_t *from, uint32_t n, unsigned axis,
                               struct dt_stop *stop);
