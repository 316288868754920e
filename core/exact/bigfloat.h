/* bigfloat.h - floating point of about 1,850 bits, for results that doubles and double words cannot carry: the
 * last resort of what computes numbers (signs are decided by bignum.h).
 *
 *     value = sign * sum limb[i] 2^(64 (exponent + i))        limb[DT_BIGFLOAT_LIMBS - 1] is not 0
 *
 * The exponent counts limbs, so nothing is shifted by bits. Every operation but division is exact up to the
 * truncation of its result: a relative error below DT_BIGFLOAT_ERROR = 2^-1856, since the top limb may have a
 * single bit. Division: below 2^4 times that. Zero: sign = 0. Exponents never overflow for what is computed
 * from doubles in a few operations. */
#ifndef DT_BIGFLOAT_H
#define DT_BIGFLOAT_H

#include <stdint.h>

enum { DT_BIGFLOAT_LIMBS = 30 };

struct dt_bigfloat {
    int sign; /* -1, 0, 1 */
    int32_t exponent;
    uint64_t limb[DT_BIGFLOAT_LIMBS]; /* the least first */
};

/* A finite double; exact. */
struct dt_bigfloat dt_bigfloat_of(double v);

/* Within an ulp; 0 or infinite where a double cannot hold it. */
double dt_bigfloat_to_double(const struct dt_bigfloat *a);

struct dt_bigfloat dt_bigfloat_add(const struct dt_bigfloat *a, const struct dt_bigfloat *b);
struct dt_bigfloat dt_bigfloat_subtract(const struct dt_bigfloat *a, const struct dt_bigfloat *b);
struct dt_bigfloat dt_bigfloat_multiply(const struct dt_bigfloat *a, const struct dt_bigfloat *b);

/* b is not 0. */
struct dt_bigfloat dt_bigfloat_divide(const struct dt_bigfloat *a, const struct dt_bigfloat *b);

#endif
