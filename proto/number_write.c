/* number_write.c - doubles and integers to decimal text.
 *
 * The digits of a double come from Schubfach [Giulietti, "The Schubfach way to render doubles",
 * 2021]. The numbers that read back to v fill an interval around it, from midpoint to midpoint.
 * Choose k so that 10^k <= width < 10^(k+1). The multiples of 10^k have a point in the interval, the
 * multiples of 10^(k+1) at most one. So the shortest is that one if it exists, else the
 * multiple of 10^k nearest to v. Both neighbours and both bounds are known exactly enough from
 * three products with a power of ten of 126 bits and more, rounded to odd.
 *
 * The layout is that of Number.prototype.toString in ECMAScript. */
#include <assert.h>
#include <string.h>

#include "proto/number.h"
#include "proto/powers.h"

struct decimal {
    uint64_t digits;
    int exponent; /* the value is digits * 10^exponent */
};

/* The upper part of g * c; its last bit is set if any lower bit is set (which keeps comparisons
 * exact). */
static uint64_t round_to_odd(struct proto_u128 g, uint64_t c)
{
    uint64_t carry = proto_multiply(g.lo, c).hi;
    struct proto_u128 y = proto_multiply(g.hi, c);
    y.lo += carry;
    y.hi += y.lo < carry;
    return y.hi | (y.lo > 1);
}

/* 10^e to 128 bits, rounded up. */
static struct proto_u128 power_rounded_up(int e)
{
    struct proto_u128 g = proto_powers[e - PROTO_POWER_MIN];
    g.lo += e < -27 || e > 55;
    return g;
}

/* Of the multiples s and s + 1 of 10^k around v = vb / 4 (all in units of 10^k, bounds in
 * quarters), the one to take. */
static struct decimal choose(uint64_t vb, uint64_t lower, uint64_t upper, int k)
{
    uint64_t s = vb / 4;
    if (s >= 10) {
        uint64_t tens = s / 10;
        bool below = lower <= 40 * tens, above = 40 * tens + 40 <= upper;
        if (below != above)
            return (struct decimal){tens + above, k + 1};
    }
    bool below = lower <= 4 * s, above = 4 * s + 4 <= upper;
    if (below != above)
        return (struct decimal){s + above, k};
    uint64_t mid = 4 * s + 2;
    return (struct decimal){s + (vb > mid || (vb == mid && (s & 1) != 0)), k};
}

/* v = c * 2^q; narrow: v is a power of two, so the double below is at half the distance of the one
 * above. */
static struct decimal shortest(uint64_t c, int q, bool narrow)
{
    int k = (q * 1262611 - (narrow ? 524031 : 0)) >> 22; /* floor(log10(2^q)), or of 3/4 of that */
    int h = q + proto_log2_power(-k) + 1;
    struct proto_u128 g = power_rounded_up(-k);
    uint64_t vb = round_to_odd(g, (4 * c) << h);
    uint64_t lower = round_to_odd(g, (4 * c - 2 + narrow) << h),
             upper = round_to_odd(g, (4 * c + 2) << h);
    uint64_t open = c & 1; /* a midpoint reads back to the even one of its neighbours */
    return choose(vb, lower + open, upper - open, k);
}

/* The shortest digits of the double > 0 with these bits. */
static struct decimal decimal_of(uint64_t bits)
{
    uint64_t fraction = bits & (((uint64_t)1 << 52) - 1);
    int biased = (int)(bits >> 52);
    if (biased == 0)
        return shortest(fraction, -1074, false);
    uint64_t c = fraction | (uint64_t)1 << 52;
    int q = biased - 1075;
    if (q <= 0 && q > -53 && (c & (((uint64_t)1 << -q) - 1)) == 0)
        return (struct decimal){c >> -q, 0}; /* an integer below 2^53: all its digits count */
    return shortest(c, q, fraction == 0 && biased > 1);
}

#define TEN(a) a "0\0" a "1\0" a "2\0" a "3\0" a "4\0" a "5\0" a "6\0" a "7\0" a "8\0" a "9\0"
#define HUNDRED(a)                                                                                 \
    TEN(a "0")                                                                                     \
    TEN(a "1")                                                                                     \
    TEN(a "2") TEN(a "3") TEN(a "4") TEN(a "5") TEN(a "6") TEN(a "7") TEN(a "8") TEN(a "9")

/* The three digits of every number below 1000, each followed by a NUL so that one load reads them. */
static const char threes[] = HUNDRED("0") HUNDRED("1") HUNDRED("2") HUNDRED("3") HUNDRED("4")
    HUNDRED("5") HUNDRED("6") HUNDRED("7") HUNDRED("8") HUNDRED("9");

static size_t count_digits(uint64_t v)
{
    static const uint64_t power[] = {0,
                                     10,
                                     100,
                                     1000,
                                     10000,
                                     100000,
                                     1000000,
                                     10000000,
                                     100000000,
                                     1000000000,
                                     10000000000,
                                     100000000000,
                                     1000000000000,
                                     10000000000000,
                                     100000000000000,
                                     1000000000000000,
                                     10000000000000000,
                                     100000000000000000,
                                     1000000000000000000,
                                     10000000000000000000u};
    size_t guess =
        (size_t)((64 - __builtin_clzll(v | 1)) * 1233) >> 12; /* log10(2) is about 1233 / 4096 */
    return guess + (v >= power[guess]);
}

static void write_pair(char *dst, uint32_t v)
{
    memcpy(dst, threes + 4 * v + 1, 2);
}

static void write_four(char *dst, uint32_t v)
{
    write_pair(dst, v / 100);
    write_pair(dst + 2, v % 100);
}

/* Writes the n digits of v, which has at most n. Eights keep the divisions independent of one
 * another. */
static void write_digits(char *dst, uint64_t v, size_t n)
{
    while (n >= 8) {
        n -= 8;
        uint32_t eight = (uint32_t)(v % 100000000);
        write_four(dst + n, eight / 10000);
        write_four(dst + n + 4, eight % 10000);
        v /= 100000000;
    }
    while (n >= 2) {
        n -= 2;
        write_pair(dst + n, (uint32_t)(v % 100));
        v /= 100;
    }
    if (n == 1)
        dst[0] = (char)('0' + v);
}

static void drop_trailing_zeros(struct decimal *d)
{
    while (d->digits % 100000000 == 0) {
        d->digits /= 100000000;
        d->exponent += 8;
    }
    while (d->digits % 10 == 0) {
        d->digits /= 10;
        d->exponent++;
    }
}

/* d.ddde+xx; point is where the decimal point stands after the first digit. */
static size_t write_scientific(char *dst, uint64_t digits, size_t n, int point)
{
    char *p = dst;
    write_digits(p + 1, digits, n);
    p[0] = p[1];
    p[1] = '.';
    p += n == 1 ? 1 : n + 1;
    int e = point - 1;
    *p++ = 'e';
    *p++ = e < 0 ? '-' : '+';
    return (size_t)(p - dst) + proto_write_u32(p, (uint32_t)(e < 0 ? -e : e));
}

static size_t write_decimal(char *dst, struct decimal d)
{
    size_t n = count_digits(d.digits);
    int point = (int)n + d.exponent; /* number of digits before the decimal point */
    if (point > 21 || point <= -6)
        return write_scientific(dst, d.digits, n, point);
    if (point <= 0) { /* 0.000ddd */
        size_t zeros = (size_t)-point;
        memcpy(dst, "0.00000", 7);
        write_digits(dst + 2 + zeros, d.digits, n);
        return 2 + zeros + n;
    }
    size_t before = (size_t)point;
    if (before >= n) { /* ddd000 */
        write_digits(dst, d.digits, n);
        memset(dst + n, '0', before - n);
        return before;
    }
    write_digits(dst + 1, d.digits, n); /* dd.ddd */
    memmove(dst, dst + 1, before);
    dst[before] = '.';
    return n + 1;
}

size_t proto_write_double(char *dst, double v)
{
    uint64_t bits;
    size_t sign = 0;
    memcpy(&bits, &v, sizeof bits);
    if (bits >> 63 != 0) {
        bits &= UINT64_MAX >> 1;
        dst[sign++] = '-';
    }
    assert(bits >> 52 < 2047);
    if (bits == 0) {
        dst[sign] = '0';
        return sign + 1;
    }
    struct decimal d = decimal_of(bits);
    if (d.exponent != 0)
        drop_trailing_zeros(&d);
    return sign + write_decimal(dst + sign, d);
}

/* Writes v < 1000, and returns its digits; the bytes after them, up to the fourth, are overwritten, too. */
static size_t write_first(char *dst, uint32_t v)
{
    size_t n = 1u + (v >= 10) + (v >= 100);
    memcpy(dst, threes + 4 * v + 3 - n, 4);
    return n;
}

/* The same with leading zeros: three digits and a NUL. */
static void write_three(char *dst, uint32_t v)
{
    memcpy(dst, threes + 4 * v, 4);
}

size_t proto_write_u32(char *dst, uint32_t v)
{
    size_t n;
    if (v < 1000)
        return write_first(dst, v);
    if (v < 1000000) {
        n = write_first(dst, v / 1000);
        write_three(dst + n, v % 1000);
        return n + 3;
    }
    if (v < 1000000000) {
        n = write_first(dst, v / 1000000);
    } else {
        dst[0] = (char)('0' + v / 1000000000);
        write_three(dst + 1, v / 1000000 % 1000);
        n = 4;
    }
    write_three(dst + n, v / 1000 % 1000);
    write_three(dst + n + 3, v % 1000);
    return n + 6;
}

size_t proto_write_u64(char *dst, uint64_t v)
{
    enum { DIGITS = 9 };
    const uint64_t part = 1000000000; /* 10^DIGITS */
    if (v <= UINT32_MAX)              /* most are */
        return proto_write_u32(dst, (uint32_t)v);
    size_t n = proto_write_u64(dst, v / part);
    write_digits(dst + n, v % part, DIGITS);
    return n + DIGITS;
}
