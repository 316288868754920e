/* double2.h - the rounding error of a sum or product of two doubles, and double words.
 *
 * The error of one operation is a double itself, and can be computed [Dekker 1971; Knuth; Shewchuk,
 * "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete &
 * Computational Geometry 18, 1997, sections 2.3 to 2.5].
 *
 * A dt_double2 is a pair hi + lo with hi = the double nearest to hi + lo: about 106 bits, rounded.
 * Its operations and their error bounds are those of Joldes, Muller & Popescu, "Tight and rigorous
 * error bounds for basic building blocks of double-word arithmetic", ACM TOMS 44(2), 2017; u =
 * 2^-53.
 *
 * All this needs IEEE doubles, rounding to nearest even, and no contraction of a*b + c into a fused operation. The
 * compiler gets -ffp-contract=off, and a test (two_product_is_exact...) fails if it contracts. Nothing
 * overflows or underflows for what the predicates compute from coordinates that
 * are 0 or of magnitude 2^-142 to 2^201. */
#pragma once

#include <float.h>

#ifdef __FAST_MATH__
#error "exact arithmetic needs IEEE semantics: build without -ffast-math"
#endif
#if FLT_EVAL_METHOD != 0
#error                                                                                             \
    "exact arithmetic needs doubles rounded to 53 bits: on 32-bit x86 build with -msse2 -mfpmath=sse"
#endif

/* *x + *y = a + b exactly, *x rounded to nearest [Knuth; Shewchuk 1997, fig. 5]. */
static inline void dt_two_sum(double a, double b, double *x, double *y)
{
    double sum = a + b;
    double b_part = sum - a;
    double a_part = sum - b_part;
    *y = (a - a_part) + (b - b_part);
    *x = sum;
}

/* The same if a = 0 or |a| >= |b|. */
static inline void dt_fast_two_sum(double a, double b, double *x, double *y)
{
    double sum = a + b;
    *y = b - (sum - a);
    *x = sum;
}

/* a = *hi + *lo, each of at most 26 bits [Dekker 1971; Shewchuk 1997, fig. 6]. */
static inline void dt_split(double a, double *hi, double *lo)
{
    double c = 134217729.0 * a; /* 2^27 + 1 */
    double big = c - a;
    *hi = c - big;
    *lo = a - *hi;
}

/* *x + *y = a * b exactly, *x rounded to nearest [Dekker 1971; Shewchuk 1997, fig. 7]. */
static inline void dt_two_product(double a, double b, double *x, double *y)
{
    double a_hi, a_lo, b_hi, b_lo;
    double product = a * b;
    dt_split(a, &a_hi, &a_lo);
    dt_split(b, &b_hi, &b_lo);
    *y = a_lo * b_lo - (((product - a_hi * b_hi) - a_lo * b_hi) - a_hi * b_lo);
    *x = product;
}

/* ---- double words ---- */

struct dt_double2 {
    double hi, lo;
};

/* a - b, exact. */
static inline struct dt_double2 dt_double2_difference(double a, double b)
{
    struct dt_double2 r;
    dt_two_sum(a, -b, &r.hi, &r.lo);
    return r;
}

/* a + b with a relative error below 3.1 u^2 [Joldes et al., algorithm 6]. */
static inline struct dt_double2 dt_double2_add(struct dt_double2 a, struct dt_double2 b)
{
    struct dt_double2 r;
    double s, s_rest, t, t_rest;
    dt_two_sum(a.hi, b.hi, &s, &s_rest);
    dt_two_sum(a.lo, b.lo, &t, &t_rest);
    dt_fast_two_sum(s, s_rest + t, &r.hi, &r.lo);
    dt_fast_two_sum(r.hi, t_rest + r.lo, &r.hi, &r.lo);
    return r;
}

/* a * b with a relative error below 7 u^2 [Joldes et al., algorithm 10]. */
static inline struct dt_double2 dt_double2_multiply(struct dt_double2 a, struct dt_double2 b)
{
    struct dt_double2 r;
    double p, p_rest;
    dt_two_product(a.hi, b.hi, &p, &p_rest);
    double cross = a.hi * b.lo + a.lo * b.hi;
    dt_fast_two_sum(p, p_rest + cross, &r.hi, &r.lo);
    return r;
}

/* a / b with a relative error below 15.1 u^2 [Joldes et al., algorithm 17]. */
static inline struct dt_double2 dt_double2_divide(struct dt_double2 a, struct dt_double2 b)
{
    struct dt_double2 r, product;
    double q = a.hi / b.hi, p, p_rest;
    dt_two_product(b.hi, q, &p, &p_rest);
    dt_fast_two_sum(p, p_rest + b.lo * q, &product.hi, &product.lo);
    double rest = (a.hi - product.hi) + (a.lo - product.lo);
    dt_fast_two_sum(q, rest / b.hi, &r.hi, &r.lo);
    return r;
}

static inline struct dt_double2 dt_double2_negate(struct dt_double2 a)
{
    return (struct dt_double2){-a.hi, -a.lo};
}

static inline struct dt_double2 dt_double2_subtract(struct dt_double2 a, struct dt_double2 b)
{
    return dt_double2_add(a, dt_double2_negate(b));
}

/* The square root of a > 0, with one step of Newton's method from `near`, the root in doubles. */
static inline struct dt_double2 dt_double2_root(struct dt_double2 a, double near)
{
    struct dt_double2 root = {near, 0};
    struct dt_double2 rest = dt_double2_subtract(a, dt_double2_multiply(root, root));
    return dt_double2_add(root, (struct dt_double2){rest.hi / (2 * near), 0});
}
