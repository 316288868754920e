/* exact.h - a second version of the predicates, in schoolbook big integers: slow and obviously right.
 *
 * Shares nothing with core/ but the point type. Every coordinate is a multiple of 2^-194 of
 * magnitude below 2^202, so as an integer it has at most 396 bits, and a polynomial of degree four
 * fits in 2048. */
#pragma once

#include "core/delaunay.h"

enum { EXACT_LIMBS = 64 };

/* sign * sum of limb[i] 2^(32 i); sign is 0 for zero. */
struct exact {
    int sign;
    uint32_t limb[EXACT_LIMBS];
};

/* v * 2^194, which must be an integer. */
struct exact exact_from_double(double v);

/* v * 2^power, the same. */
struct exact exact_scaled(double v, int power);

/* |a| / |b| for b != 0, to 1 part in 2^50. */
double exact_ratio(const struct exact *a, const struct exact *b);
struct exact exact_add(const struct exact *a, const struct exact *b);
struct exact exact_subtract(const struct exact *a, const struct exact *b);
struct exact exact_multiply(const struct exact *a, const struct exact *b);

/* The signs that core/exact/predicates.h describes. */
int exact_orient2d(struct dt_point a, struct dt_point b, struct dt_point c);
int exact_incircle(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d);
int exact_incircle_perturbed(struct dt_point a, struct dt_point b, struct dt_point c,
                             struct dt_point d);
int exact_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b);
int exact_compare_radius(struct dt_point a, struct dt_point b, double r);
