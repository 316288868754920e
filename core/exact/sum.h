/* sum.h - exact sums of cross products of coordinates, and of products of doubles of any size.
 *
 *     value = sum of digit[i] 2^(32 i - 448), 0 <= i < DT_SUM_DIGITS
 *
 * Digits have signs and are wider than 32 bits, so adding a number touches three of them and carries nothing [Kulisch,
 * Computer Arithmetic and Validity, 2013]. Coordinates that dt_coordinate_ok accepts are multiples of 2^-194 below 2^202,
 * so products are multiples of 2^-388 below 2^404. */
#pragma once

#include "core/delaunay.h"

#include <string.h>

enum { DT_SUM_DIGITS = 30 };

/* A normal double without its sign is 53 bits times 2^*exponent. */
static inline uint64_t dt_double_bits(double v, int *exponent)
{
    enum { FRACTION = 52, LEAST = -1075 };
    uint64_t bits, one = (uint64_t)1 << FRACTION;
    memcpy(&bits, &v, sizeof bits);
    *exponent = (int)(bits >> FRACTION & 2047) + LEAST;
    return (bits & (one - 1)) | one;
}

/* Start with {0}. */
struct dt_sum {
    int64_t digit[DT_SUM_DIGITS];
    uint32_t added; /* numbers since digits were made small last */
};

/* Adds a.x b.y - a.y b.x: twice the area, with its sign, of the triangle of the origin, a and b. */
void dt_sum_cross(struct dt_sum *s, struct dt_point a, struct dt_point b);

/* Half of the sum, rounded once to the nearest double. The sum may have less than 2^60 numbers. */
double dt_sum_half(struct dt_sum *s);

/* The same with digits from 2^-1600 on, for numbers from 2^-1500 to 2^1500. */
enum { DT_WIDE_DIGITS = 100 };

/* Start with {0}. Most numbers have a last bit from 2^base to 2^(base + 50); `near` is the sum of these. */
struct dt_wide_sum {
    int64_t digit[DT_WIDE_DIGITS];
    uint32_t added;
    unsigned __int128 near; /* times 2^base */
    uint32_t added_near;
    int base;
};

/* Empties `near`, so that it takes numbers around 2^53 times 2^exponent. */
void dt_wide_sum_move(struct dt_wide_sum *s, int exponent);

/* Adds `bits` 2^exponent, bits < 2^53. */
static inline void dt_wide_sum_add_bits(struct dt_wide_sum *s, uint64_t bits, int exponent)
{
    enum { WINDOW = 50, OFTEN = 1 << 24 }; /* 50 + 53 + 24 bits are 127 */
    if ((uint32_t)(exponent - s->base) > WINDOW || s->added_near == OFTEN)
        dt_wide_sum_move(s, exponent);
    s->near += (unsigned __int128)bits << (exponent - s->base);
    s->added_near++;
}

/* Adds a b 2^exponent, a, b >= 0. The relative error is at most 2^-53. It depends on a b alone. */
void dt_wide_sum_add_any(struct dt_wide_sum *s, double a, double b, int exponent);

/* a b alone; faster. */
static inline void dt_wide_sum_add(struct dt_wide_sum *s, double a, double b)
{
    double product = a * b;
    if (product > 0x1p-900 && product < 0x1p900) {
        int exponent;
        uint64_t bits = dt_double_bits(product, &exponent);
        dt_wide_sum_add_bits(s, bits, exponent);
    } else {
        dt_wide_sum_add_any(s, a, b, 0);
    }
}

/* The sum divided by a small integer, rounded once to the nearest double; infinite beyond the largest one. */
double dt_wide_sum_over(const struct dt_wide_sum *s, uint32_t divisor);
