/* bignum.h - exact sums of products of double words, and comparisons of products of such sums: what the
 * predicates reduce to.
 *
 *     place    15  ...   hi - 1   ...    lo    ...   1    0       value = sign * sum limb[i] 2^(64 i - 512),
 *                  |    | not 0 |     | not 0 |    |              in limbs of 64 bits at fixed places
 *
 * A number of wide exponents is mostly zeros: those at either end are left out, and multiplication skips
 * the others. So the cost is proportional to the bits that are present.
 *
 * Room: a coordinate that dt_coordinate_ok accepts is 0 or a multiple of 2^-194 below 2^202, so a double
 * word that is a difference of two has parts of which each is an integer of 53 bits times at least
 * 2^-246, and is below 2^203. A sum of two products is a multiple of 2^-492, below 2^408, and times
 * 2^512 an integer of less than 922 bits. */
#ifndef DT_BIGNUM_H
#define DT_BIGNUM_H

#include <stdint.h>

#include "core/exact/double2.h"

enum { DT_BIG_LIMBS = 16 };

struct dt_big {
    int sign, lo, hi; /* zero: sign = 0, lo = hi */
    uint64_t limb[DT_BIG_LIMBS];
};

/* *r = a b + sign c d, for differences of coordinates; sign is 1 or -1. */
void dt_big_products(struct dt_double2 a, struct dt_double2 b, int sign, struct dt_double2 c,
                     struct dt_double2 d, struct dt_big *r);

/* The sign of a - b. */
int dt_big_compare(const struct dt_big *a, const struct dt_big *b);

/* The sign of a b - c d. */
int dt_big_compare_products(const struct dt_big *a, const struct dt_big *b, const struct dt_big *c,
                            const struct dt_big *d);

/* The sign of a[0] a[1] a[2] - b[0] b[1] b[2]. */
int dt_big_compare_triples(const struct dt_big a[3], const struct dt_big b[3]);

#endif
