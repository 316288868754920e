/* sum.h - exact sums of cross products of coordinates.
 *
 *     value = sum of digit[i] 2^(32 i - 448), 0 <= i < DT_SUM_DIGITS
 *
 * Digits have signs and are wider than 32 bits, so adding a number touches three of them and carries nothing [Kulisch,
 * Computer Arithmetic and Validity, 2013]. Coordinates that dt_coordinate_ok accepts are multiples of 2^-194 below 2^202,
 * so products are multiples of 2^-388 below 2^404. */
#ifndef DT_SUM_H
#define DT_SUM_H

#include "core/delaunay.h"

enum { DT_SUM_DIGITS = 30 };

/* Start with {0}. */
struct dt_sum {
    int64_t digit[DT_SUM_DIGITS];
    uint32_t added; /* numbers since digits were made small last */
};

/* Adds a.x b.y - a.y b.x: twice the area, with its sign, of the triangle of the origin, a and b. */
void dt_sum_cross(struct dt_sum *s, struct dt_point a, struct dt_point b);

/* Half of it, rounded once to the nearest double. Of less than 2^60 numbers. */
double dt_sum_half(struct dt_sum *s);

#endif
