/* powers.h - powers of ten to 128 bits, and the product of two 64-bit words, for reading and writing decimal
 * numbers. */
#pragma once

#include <stdint.h>

#define PROTO_POWER_MIN                                                                            \
    (-342) /* 10^-343 times any 64-bit integer is less than half the smallest double */
#define PROTO_POWER_MAX 324 /* to write the smallest double */

struct proto_u128 {
    uint64_t hi, lo;
};

/* Entry q - PROTO_POWER_MIN is 10^q without its power of two: the 128-bit integer g, highest bit
 * set, for which 10^q = g * 2^(proto_log2_power(q) - 127), about. Exact for 0 <= q <= 55, rounded
 * up for -27 <= q < 0, rounded down elsewhere: so reading wants it [Lemire 2021, sec. 5.2]. The low
 * word is never all ones, so writing, which wants g rounded up, may add 1. */
extern struct proto_u128 proto_powers[PROTO_POWER_MAX - PROTO_POWER_MIN + 1];

/* floor(log2(10^q)) for |q| <= 1233. */
static inline int proto_log2_power(int q)
{
    return (q * 1741647) >> 19;
}

static inline struct proto_u128 proto_multiply(uint64_t a, uint64_t b)
{
#ifdef __SIZEOF_INT128__
    unsigned __int128 p = (unsigned __int128)a * b;
    return (struct proto_u128){(uint64_t)(p >> 64), (uint64_t)p};
#else
    uint64_t al = (uint32_t)a, ah = a >> 32, bl = (uint32_t)b, bh = b >> 32;
    uint64_t low = al * bl, mid = ah * bl + (low >> 32), mid2 = al * bh + (uint32_t)mid;
    return (struct proto_u128){ah * bh + (mid >> 32) + (mid2 >> 32), mid2 << 32 | (uint32_t)low};
#endif
}
