/* bignum.h - numbers of up to 2,560 bits: exact for the polynomials of coordinates whose signs predicates need, rounded
 * for quotients and for values computed from them.
 *
 *     value = sign * sum limb[i] 2^(64 (exponent + i)), 0 <= i < n       zero: sign = 0, n = 0
 *
 * The exponent counts limbs, so no number is shifted by bits. A number stores only the limbs from its first to its last
 * limb other than 0. Multiplication skips zeros: the cost is proportional to the bits that are present.
 *
 * Every result except a quotient is exact, or truncated to DT_BIG_LIMBS limbs: a relative error below 2^-2496,
 * since the top limb may have a single bit. Division: below 2^4 times that. Exponents never overflow in a few operations
 * on doubles.
 *
 * Room: a coordinate that dt_coordinate_ok accepts is 0 or a multiple of 2^-194 below 2^202. So a polynomial of degree
 * six of differences of coordinates, the highest of all predicates (dt_compare_circumradius), is a multiple of 2^-1164
 * below 2^1227: it takes at most 39 limbs and is exact. */
#pragma once

#include <stdint.h>

enum { DT_BIG_LIMBS = 40 };

struct dt_big {
    int sign; /* -1, 0, 1 */
    int32_t exponent;
    uint32_t n;
    uint64_t limb[DT_BIG_LIMBS]; /* the least first; the first and the last one are not 0 */
};

/* v, which is finite. */
struct dt_big dt_big_of(double v);

/* Within an ulp; 0 or infinite where a double cannot hold it. */
double dt_big_to_double(struct dt_big a);

/* The nearest double, ties to even; infinite from halfway between the largest double and 2^1024 on. */
double dt_big_nearest(struct dt_big a);

struct dt_big dt_big_add(struct dt_big a, struct dt_big b);
struct dt_big dt_big_subtract(struct dt_big a, struct dt_big b);
struct dt_big dt_big_multiply(struct dt_big a, struct dt_big b);

/* a / b; b is not 0. */
struct dt_big dt_big_divide(struct dt_big a, struct dt_big b);

/* a - b, for any finite doubles. */
struct dt_big dt_big_difference(double a, double b);

/* The double nearest to a / b, ties to even, as dt_big_nearest has it; b is not 0. Exact unless a product of b and a double of 54 bits
 * needs more than DT_BIG_LIMBS limbs. */
double dt_big_quotient(struct dt_big a, struct dt_big b);

/* The sign of a - b. */
int dt_big_compare(struct dt_big a, struct dt_big b);
