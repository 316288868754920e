/* degrees.c - see degrees.h.
 *
 * The angle with the tangent y / x, 0 <= y <= x, is a multiple of 1/16 and a rest [Muller, Elementary Functions, 2016, chapter 4]:
 *
 *     c = k / 16, the nearest to y / x             atan(y / x) = atan(c) + atan(r)
 *     r = (y - c x) / (x + c y), |r| <= 1 / 32     atan(r) = r - r^3 / 3 + r^5 / 5 - ... - r^15 / 15
 *
 * In double words the table, r and r^3 / 3 err by less than 2^-98 of themselves; the other terms are doubles, and err by less
 * than 2^-72 of r; the terms that are left out are less than 2^-83 of r. If k is 0, r is the tangent itself. So an angle errs by less
 * than 2^-70 of itself before it is rounded. */
#include "core/exact/degrees.h"

#include "core/exact/double2.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { STEPS = 16 };

/* atan(k / 16) in degrees. */
static const struct dt_double2 table[STEPS + 1] = {
    {0x0.0p+0, 0x0.0p+0},                           /* 0 */
    {0x1.c9c55326164cfp+1, -0x1.88708ff33aabap-55}, /* 1 */
    {0x1.c80044927fe83p+2, -0x1.2a9346eb4b87bp-53}, /* 2 */
    {0x1.53d4374d3c2a3p+3, 0x1.c5b7fa992d71fp-52},  /* 3 */
    {0x1.c128e80fae02ep+3, -0x1.0fc10e257c651p-53}, /* 4 */
    {0x1.15aa15bcab87ep+4, 0x1.2f23fe5f78d35p-52},  /* 5 */
    {0x1.48e58fac13547p+4, 0x1.bdef92fae944fp-51},  /* 6 */
    {0x1.7a11ee6220071p+4, -0x1.63c539bb8dcc2p-55}, /* 7 */
    {0x1.a90a731a61dc4p+4, -0x1.80b27b26e182bp-51}, /* 8 */
    {0x1.d5b95bc765110p+4, 0x1.6f006acd20fc1p-52},  /* 9 */
    {0x1.000b0659f5545p+5, 0x1.0e62435c62f2fp-49},  /* 10 */
    {0x1.141174800a666p+5, 0x1.e004defca5108p-50},  /* 11 */
    {0x1.26f58ce59e23cp+5, 0x1.80b27b26e182bp-50},  /* 12 */
    {0x1.38c03916765b8p+5, 0x1.50a2d34ee7050p-49},  /* 13 */
    {0x1.497cc65551cf8p+5, -0x1.2dd089737cc28p-49}, /* 14 */
    {0x1.5938181bde651p+5, 0x1.ea28ab192aaf3p-51},  /* 15 */
    {0x1.6800000000000p+5, 0x0.0p+0},               /* 16 */
};

static const struct dt_double2 degrees = {0x1.ca5dc1a63c1f8p+5,
                                          -0x1.1e7ab456405f9p-49}; /* 180 / pi */
static const struct dt_double2 third = {0x1.5555555555555p-2, 0x1.5555555555555p-56};
static const struct dt_double2 right = {90, 0};

/* In degrees, |r| <= 1 / 32. */
static struct dt_double2 small_angle(struct dt_double2 r)
{
    struct dt_double2 square = dt_double2_multiply(r, r);
    double z = square.hi;
    double rest =
        1. / 5 - z * (1. / 7 - z * (1. / 9 - z * (1. / 11 - z * (1. / 13 - z * (1. / 15)))));
    struct dt_double2 cube = dt_double2_multiply(dt_double2_multiply(r, square), third);
    struct dt_double2 tail = {r.hi * (z * z) * rest, 0};
    return dt_double2_multiply(dt_double2_add(dt_double2_subtract(r, cube), tail), degrees);
}

/* The angle with the tangent y / x, which is the angle but for the unit; y is at most 2^-298. */
static double tiny_angle(struct dt_double2 y, struct dt_double2 x)
{
    struct dt_double2 larger = {y.hi * 0x1p500, y.lo * 0x1p500};
    return dt_double2_multiply(dt_double2_divide(larger, x), degrees).hi * 0x1p-500;
}

/* The angle with the tangent y / x, 0 <= y and 0 < x, of numbers up to 4 of which one is at least 1/2. */
static struct dt_double2 angle_of(struct dt_double2 y, struct dt_double2 x)
{
    if (y.hi > x.hi)
        return dt_double2_subtract(right, angle_of(x, y));
    if (y.hi < x.hi * 0x1p-300)
        return (struct dt_double2){tiny_angle(y, x), 0};
    int k = (int)(y.hi / x.hi * STEPS + 0.5);
    struct dt_double2 c = {(double)k / STEPS, 0};
    struct dt_double2 r = dt_double2_divide(dt_double2_subtract(y, dt_double2_multiply(c, x)),
                                            dt_double2_add(x, dt_double2_multiply(c, y)));
    return dt_double2_add(table[k], small_angle(r));
}

/* 2^exponent, normal. */
static double power(int exponent)
{
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* v 2^exponent. Exact, unless that is less than the normal doubles; then rounded once if the exponent is negative. */
static double scale(double v, int exponent)
{
    int half = exponent / 2;
    return v * power(half) * power(exponent - half);
}

/* Scales two magnitudes, one greater than 0, so that the larger one is from 1/2 to 1. Returns the exponent that was taken away. */
static int normalize(double *a, double *b)
{
    int exponent;
    double most = *a > *b ? *a : *b;
    if (isinf(most)) {
        *a = isinf(*a) ? 0.5 : scale(*a, -1025);
        *b = isinf(*b) ? 0.5 : scale(*b, -1025);
        return 1025;
    }
    (void)frexp(most, &exponent);
    *a = scale(*a, -exponent);
    *b = scale(*b, -exponent);
    return exponent;
}

/* The square root of a^2 + b^2, from 1/2 to 2. */
static struct dt_double2 length_of(double a, double b)
{
    struct dt_double2 x = {a, 0}, y = {b, 0};
    struct dt_double2 square = dt_double2_add(dt_double2_multiply(x, x), dt_double2_multiply(y, y));
    return dt_double2_root(square, sqrt(square.hi));
}

double dt_degrees_steep(double dx, double dy)
{
    enum { FAR = 300 };
    double a = fabs(dx), b = fabs(dy);
    if (isnan(a + b))
        return (double)NAN;
    if (a == 0 && b == 0)
        return 0;
    int exponent = normalize(&a, &b);
    struct dt_double2 length = length_of(a, b);
    if (exponent > FAR)
        return 90;
    if (exponent < -FAR)
        return scale(dt_double2_multiply(length, degrees).hi * power(-FAR), exponent + FAR);
    if (exponent > 0) /* so that both numbers are in the range of angle_of */
        return dt_double2_subtract(right,
                                   angle_of((struct dt_double2){power(-exponent), 0}, length))
            .hi;
    struct dt_double2 tangent = {length.hi * power(exponent), length.lo * power(exponent)};
    return angle_of(tangent, (struct dt_double2){1, 0}).hi;
}

double dt_degrees_downhill(double dx, double dy)
{
    double east = fabs(dx), north = fabs(dy);
    bool eastward = dx < 0, northward = dy < 0 || dy == 0;
    if (isnan(east + north) || (east == 0 && north == 0))
        return (double)NAN;
    normalize(&east, &north);
    struct dt_double2 from_north =
        angle_of((struct dt_double2){east, 0}, (struct dt_double2){north, 0});
    struct dt_double2 half = {180, 0}, whole = {360, 0};
    if (east == 0 || dx == 0)
        return northward ? 0 : 180;
    if (eastward)
        return northward ? from_north.hi : dt_double2_subtract(half, from_north).hi;
    double angle =
        northward ? dt_double2_subtract(whole, from_north).hi : dt_double2_add(half, from_north).hi;
    return angle < 360 ? angle : 0;
}
