/* big_values.h - arithmetic of long numbers by value, for formulas that are evaluated in doubles or double words, too. Exact and rounded
 * as the functions of bignum.h that they call. */
#pragma once

#include "core/exact/bignum.h"

/* a - b, for any finite doubles. */
static inline struct dt_big dt_big_difference_of(double a, double b)
{
    struct dt_big x, y;
    dt_big_of(a, &x);
    dt_big_of(b, &y);
    dt_big_subtract(&x, &y, &x);
    return x;
}

static inline struct dt_big dt_big_plus(struct dt_big a, struct dt_big b)
{
    dt_big_add(&a, &b, &a);
    return a;
}

static inline struct dt_big dt_big_minus(struct dt_big a, struct dt_big b)
{
    dt_big_subtract(&a, &b, &a);
    return a;
}

static inline struct dt_big dt_big_times(struct dt_big a, struct dt_big b)
{
    dt_big_multiply(&a, &b, &a);
    return a;
}

static inline struct dt_big dt_big_over(struct dt_big a, struct dt_big b)
{
    dt_big_divide(&a, &b, &a);
    return a;
}
