/* number_exact.c - compares a decimal number with the midpoints between doubles, in big integers.
 *
 * The doubles >= 0 are ordered as their bits are, infinity (2047 << 52) standing for 2^1024, so
 * "the next double" is bits + 1. The midpoint between the double of bits b and the next one is (2m
 * + 1) * 2^(e - 1) if b stands for m * 2^e. Both sides of the comparison are made integers by
 * moving powers of 2 and 5 to the other side, where they are positive. A midpoint has at most 767
 * significant digits, so of the digits beyond 770 it only matters whether all of them are zero. */
#include "proto/number_exact.h"

#include <string.h>

#include "proto/powers.h"

#define LIMBS                                                                                      \
    64 /* 4096 bits; 771 digits take 2562, and both sides of a comparison are of about one size */
#define DIGITS_MAX 770

struct big {
    uint32_t n; /* limbs in use; the highest is not zero */
    uint64_t limb[LIMBS];
};

/* b = b * m + a. */
static void big_multiply_add(struct big *b, uint64_t m, uint64_t a)
{
    for (uint32_t i = 0; i < b->n; i++) {
        struct proto_u128 p = proto_multiply(b->limb[i], m);
        b->limb[i] = p.lo + a;
        a = p.hi + (b->limb[i] < a);
    }
    if (a != 0)
        b->limb[b->n++] = a;
}

static void big_multiply_power5(struct big *b, uint64_t e)
{
    const uint64_t five27 = 7450580596923828125u;
    for (; e >= 27; e -= 27)
        big_multiply_add(b, five27, 0);
    for (; e > 0; e--)
        big_multiply_add(b, 5, 0);
}

static void big_shift_left(struct big *b, uint64_t bits)
{
    uint32_t limbs = (uint32_t)(bits / 64);
    big_multiply_add(b, (uint64_t)1 << (bits % 64), 0);
    memmove(b->limb + limbs, b->limb, b->n * sizeof b->limb[0]);
    memset(b->limb, 0, limbs * sizeof b->limb[0]);
    b->n += limbs;
}

static int big_compare(const struct big *a, const struct big *b)
{
    if (a->n != b->n)
        return a->n < b->n ? -1 : 1;
    for (uint32_t i = a->n; i-- > 0;)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

/* The digits of d as an integer; *exponent is what belongs to it. */
static void big_from_decimal(struct big *b, const struct proto_decimal *d, int64_t *exponent)
{
    uint32_t digits = 0;
    const char *p = d->text;
    b->n = 0;
    *exponent = d->exponent;
    for (; p < d->end && digits < DIGITS_MAX; p++)
        if (*p != '.') {
            big_multiply_add(b, 10, (uint64_t)(*p - '0'));
            digits++;
        }
    uint64_t rest = 0;
    for (; p < d->end; p++)
        if (*p != '.') {
            rest |= (uint64_t)(*p - '0');
            (*exponent)++;
        }
    if (rest != 0) {
        big_multiply_add(b, 10, 1);
        (*exponent)--;
    }
}

/* Compares integer * 10^e10 with the midpoint above the double of these bits. */
static int compare_with_midpoint(const struct big *integer, int64_t e10, uint64_t bits)
{
    struct big left = *integer, right = {0};
    uint64_t fraction = bits & (((uint64_t)1 << 52) - 1), biased = bits >> 52;
    uint64_t m = biased == 0 ? fraction : fraction | (uint64_t)1 << 52;
    int64_t e2 = (biased == 0 ? 1 : (int64_t)biased) - 1075 - 1;

    big_multiply_add(&right, 0, 2 * m + 1);
    if (e10 >= 0)
        big_multiply_power5(&left, (uint64_t)e10);
    else
        big_multiply_power5(&right, (uint64_t)-e10);
    if (e10 >= e2)
        big_shift_left(&left, (uint64_t)(e10 - e2));
    else
        big_shift_left(&right, (uint64_t)(e2 - e10));
    return big_compare(&left, &right);
}

/* Whether the number is nearer to the double above the one of these bits than to it. */
static int rounds_beyond(const struct big *integer, int64_t e10, uint64_t bits)
{
    int side = compare_with_midpoint(integer, e10, bits);
    return side > 0 || (side == 0 && (bits & 1) != 0);
}

uint64_t proto_round_exactly(const struct proto_decimal *d, uint64_t guess)
{
    const uint64_t infinity = (uint64_t)2047 << 52;
    struct big integer;
    int64_t e10;
    big_from_decimal(&integer, d, &e10);
    while (guess < infinity && rounds_beyond(&integer, e10, guess))
        guess++;
    while (guess > 0 && !rounds_beyond(&integer, e10, guess - 1))
        guess--;
    return guess;
}
