/* sum.c - see sum.h. */
#include "core/exact/sum.h"

#include <float.h>
#include <math.h>

#include "core/exact/bignum.h"
#include "core/exact/double2.h"

enum { LOWEST = -448, LOWEST_WIDE = -1600, OFTEN = 1 << 29 };

/* Makes all digits but the last one numbers from 0 to 2^32 - 1. */
static void carry(int64_t *digit, int n)
{
    for (int i = 0; i + 1 < n; i++) {
        int64_t low = digit[i] & UINT32_MAX;
        digit[i + 1] += (digit[i] - low) / ((int64_t)1 << 32);
        digit[i] = low;
    }
}

/* Adds 53 bits, `at` bits above the lowest digit's first one. A digit changes by less than 2^32, so 2^29 of them do not
 * overflow it. */
static inline void add_bits(int64_t *digit, uint64_t bits, int at, bool minus)
{
    unsigned __int128 wide = (unsigned __int128)bits << at % 32;
    for (int i = at / 32; wide != 0; wide >>= 32, i++) {
        int64_t part = (int64_t)(wide & UINT32_MAX);
        digit[i] += minus ? -part : part;
    }
}

/* v is 0 or a multiple of 2^-388. */
static void add(struct dt_sum *s, double v)
{
    int exponent;
    if (v == 0)
        return;
    uint64_t bits = dt_double_bits(v, &exponent);
    add_bits(s->digit, bits, exponent - LOWEST, v < 0);
    if (++s->added == OFTEN) {
        carry(s->digit, DT_SUM_DIGITS);
        s->added = 0;
    }
}

void dt_sum_cross(struct dt_sum *s, struct dt_point a, struct dt_point b)
{
    double product, error;
    dt_two_product(a.x, b.y, &product, &error);
    add(s, product);
    add(s, error);
    dt_two_product(-a.y, b.x, &product, &error);
    add(s, product);
    add(s, error);
}

/* The sum as one number; of more than DT_BIG_LIMBS limbs only the highest ones. Changes the digits. */
static struct dt_big big_of(int64_t *digit, int n, int lowest)
{
    carry(digit, n);
    bool negative = digit[n - 1] < 0;
    for (int i = 0; negative && i < n; i++)
        digit[i] = -digit[i];
    carry(digit, n);
    int end = n;
    while (end > 0 && (digit[end - 2] | digit[end - 1]) == 0)
        end -= 2;
    int from = end > 2 * DT_BIG_LIMBS ? end - 2 * DT_BIG_LIMBS : 0;
    struct dt_big big = {.sign = negative ? -1 : 1, .exponent = (lowest + 32 * from) / 64};
    for (int i = from; i < end; i += 2) {
        uint64_t limb = (uint64_t)digit[i] | (uint64_t)digit[i + 1] << 32;
        if (limb == 0 && big.n == 0)
            big.exponent++;
        else
            big.limb[big.n++] = limb;
    }
    big.sign = big.n == 0 ? 0 : big.sign;
    return big;
}

double dt_sum_half(struct dt_sum *s)
{
    struct dt_sum size = *s;
    struct dt_big big = big_of(size.digit, DT_SUM_DIGITS, LOWEST);
    return big.sign == 0 ? 0 : dt_big_nearest(big) / 2;
}

/* ---- of any size ---- */

void dt_wide_sum_move(struct dt_wide_sum *s, int exponent)
{
    enum { BELOW = 30 }; /* so many powers of two */
    for (int k = 0; k < 128; k += 32)
        add_bits(s->digit, (uint64_t)(s->near >> k) & UINT32_MAX, s->base + k - LOWEST_WIDE, false);
    s->added += 4;
    if (s->added >= OFTEN) {
        carry(s->digit, DT_WIDE_DIGITS);
        s->added = 0;
    }
    s->near = 0;
    s->added_near = 0;
    s->base = exponent - BELOW;
}

/* 53 bits of v > 0, which is v times 2^-*exponent. */
static uint64_t bits_of(double v, int *exponent)
{
    enum { MORE = 100 }; /* makes every double normal */
    if (v >= DBL_MIN)
        return dt_double_bits(v, exponent);
    uint64_t bits = dt_double_bits(ldexp(v, MORE), exponent);
    *exponent -= MORE;
    return bits;
}

/* The product of the bits neither overflows nor underflows. */
void dt_wide_sum_add_any(struct dt_wide_sum *s, double a, double b, int exponent)
{
    int exponent_a, exponent_b, more;
    if (a == 0 || b == 0)
        return;
    uint64_t bits_a = bits_of(a, &exponent_a), bits_b = bits_of(b, &exponent_b);
    uint64_t bits = dt_double_bits((double)(int64_t)bits_a * (double)(int64_t)bits_b, &more);
    dt_wide_sum_add_bits(s, bits, exponent + exponent_a + exponent_b + more);
}

double dt_wide_sum_over(const struct dt_wide_sum *s, uint32_t divisor)
{
    struct dt_wide_sum sum = *s;
    dt_wide_sum_move(&sum, 0);
    struct dt_big big = big_of(sum.digit, DT_WIDE_DIGITS, LOWEST_WIDE);
    return big.sign == 0 ? 0 : dt_big_nearest(dt_big_divide(big, dt_big_of(divisor)));
}
