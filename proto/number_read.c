/* number_read.c - decimal text to double, correctly rounded.
 *
 * Two stages:
 *   1. up to 19 digits: one or two 64-bit multiplications by a power of ten of 128 bits [Lemire,
 *      "Number Parsing at a Gigabyte per Second", 2021, algorithm 1; Mushtak & Lemire 2023 show that
 *      it needs no fallback]. For longer numbers the first 19 digits, and these plus one: if both
 *      give the same double, so do all numbers between them;
 *   2. otherwise strtod, which rounds correctly for any number of digits. It gets the digits without a point, whose
 *      character depends on the locale. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/number.h"
#include "proto/powers.h"
#include "proto/text.h"

#define DIGITS 19 /* any 19 digits fit a 64-bit word */
#define DIGITS_MOST                                                                                \
    770 /* of a midpoint between doubles: 767; of digits beyond it only matters whether all are zero */
#define INFINITY_BITS ((uint64_t)2047 << 52)

/* The number in the text: (digits in text .. text_end, a '.' ignored) * 10^exponent. */
struct scan {
    const char *text, *text_end;
    uint64_t word; /* the digits as a number, modulo 2^64 */
    size_t count;  /* how many digits there are, leading zeros included */
    int64_t exponent;
    bool negative;
};

static const char *scan_digits(const char *p, const char *end, uint64_t *word)
{
    for (; p < end && text_is_digit(*p); p++)
        *word = 10 * *word + (uint64_t)(*p - '0');
    return p;
}

/* The 8 bytes at p, the first one lowest. */
static uint64_t load_eight(const char *p)
{
    uint64_t x;
    memcpy(&x, p, sizeof x);
    return x;
}

/* The number whose digits are the 8 bytes of x, the first one lowest: joined to pairs, fours and one number by three
 * multiplications [Lemire 2021, sec. 3]. */
static uint64_t join_eight(uint64_t x)
{
    const uint64_t pair = 0x000000ff000000ff;
    x = 10 * x + (x >> 8);
    x = (x & pair) * (100 + (1000000ull << 32)) + ((x >> 16) & pair) * (1 + (10000ull << 32));
    return x >> 32;
}

/* As scan_digits, for many digits: eight at a time, and the last ones without a branch that depends on their number, which
 * is unpredictable: they are shifted behind zeros. */
static const char *scan_fraction(const char *p, const char *end, uint64_t *word)
{
    static const uint64_t power[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000};
    for (; end - p >= 8; p += 8) {
        uint64_t x = load_eight(p) ^ 0x3030303030303030;
        /* Not zero: in bytes that are no digits. The sum carries only from such bytes. */
        uint64_t other = (x | (x + 0x0606060606060606)) & 0xf0f0f0f0f0f0f0f0;
        if (other != 0) {
            unsigned n = (unsigned)__builtin_ctzll(other) / 8;
            *word = *word * power[n] + join_eight(x << 8 * (7 - n) << 8);
            return p + n;
        }
        *word = *word * 100000000 + join_eight(x);
    }
    return scan_digits(p, end, word);
}

/* Reads the exponent at p, if there is one, and returns where it ends: at p if there is none. Huge
 * exponents saturate. */
static const char *scan_exponent(const char *p, const char *end, int64_t *exponent)
{
    const char *at = p + 1;
    int64_t e = 0;
    if (p == end || (*p != 'e' && *p != 'E'))
        return p;
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    if (at == end || !text_is_digit(*at))
        return p;
    for (; at < end && text_is_digit(*at); at++)
        if (e < (int64_t)1 << 56)
            e = 10 * e + (*at - '0');
    *exponent += negative ? -e : e;
    return at;
}

/* Reads the number at s and returns where it ends; NULL if there is none. */
static const char *scan(const char *s, const char *end, struct scan *n)
{
    const char *p = s;
    n->word = 0;
    n->exponent = 0;
    n->negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    n->text = p;
    p = scan_digits(p, end, &n->word);
    n->count = (size_t)(p - n->text);
    if (p < end && *p == '.') {
        const char *fraction = p + 1;
        p = scan_fraction(fraction, end, &n->word);
        n->count += (size_t)(p - fraction);
        n->exponent = fraction - p;
    }
    n->text_end = p;
    return n->count == 0 ? NULL : scan_exponent(p, end, &n->exponent);
}

/* Rounds the mantissa m (54 bits and more, the last one half a unit) of a subnormal number. */
static uint64_t round_subnormal(uint64_t m, int biased)
{
    if (1 - biased >= 64)
        return 0;
    m >>= 1 - biased;
    return (m + (m & 1)) >> 1; /* may carry into the exponent: then it is the least normal number */
}

/* word * 10^q to the nearest double, as bits; word > 0. No tie is missed: see the sources named
 * above. */
static uint64_t round_word(uint64_t word, int64_t q)
{
    if (q < PROTO_POWER_MIN)
        return 0;
    if (q > 308)
        return INFINITY_BITS;
    int zeros = __builtin_clzll(word), e = (int)q;
    const struct proto_u128 *power = &proto_powers[e - PROTO_POWER_MIN];
    word <<= zeros;
    struct proto_u128 z = proto_multiply(word, power->hi);
    /* The lower half of the power may carry into the bits that count. */
    if ((z.hi & 0x1ff) == 0x1ff) {
        uint64_t more = proto_multiply(word, power->lo).hi;
        z.lo += more;
        z.hi += z.lo < more;
    }
    int upper = (int)(z.hi >> 63), shift = upper + 9;
    int biased = proto_log2_power(e) + 63 + upper - zeros + 1023;
    uint64_t m = z.hi >> shift;
    if (biased <= 0)
        return round_subnormal(m, biased);
    /* A tie is possible only where 5^|q| divides 64 bits: round to even by clearing the half. */
    if (z.lo <= 1 && e >= -4 && e <= 23 && (m & 3) == 1 && m << shift == z.hi)
        m &= ~(uint64_t)1;
    m = (m + (m & 1)) >> 1; /* 2^52 <= m <= 2^53 */
    uint64_t bits =
        ((uint64_t)biased << 52) + (m - ((uint64_t)1 << 52)); /* a carry moves the exponent on */
    return bits < INFINITY_BITS ? bits : INFINITY_BITS;
}

/* The number to the nearest double, as bits, however many digits it has. */
static uint64_t round_exactly(const struct scan *n)
{
    char text[DIGITS_MOST + 32];
    size_t len = 0;
    int64_t exponent = n->exponent;
    int error = errno;
    bool rest = false; /* a digit that is left out is not 0 */
    uint64_t bits;
    for (const char *p = n->text; p < n->text_end; p++) {
        if (*p == '.')
            continue;
        if (len < DIGITS_MOST) {
            text[len++] = *p;
            continue;
        }
        rest = rest || *p != '0';
        exponent++;
    }
    if (rest) {
        text[len++] = '1';
        exponent--;
    }
    snprintf(text + len, sizeof text - len, "e%" PRId64, exponent);
    double v = strtod(text, NULL);
    errno = error;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

/* More than 19 digits, possibly with leading zeros. */
static uint64_t round_long(struct scan *n)
{
    while (n->text < n->text_end && (*n->text == '0' || *n->text == '.')) {
        n->count -= *n->text == '0';
        n->text++;
    }
    if (n->count == 0)
        return 0;
    if (n->count <= DIGITS)
        return round_word(n->word, n->exponent);
    uint64_t word = 0;
    const char *p = n->text;
    for (int digits = 0; digits < DIGITS; p++)
        if (*p != '.') {
            word = 10 * word + (uint64_t)(*p - '0');
            digits++;
        }
    int64_t q = n->exponent + (int64_t)(n->count - DIGITS);
    uint64_t low = round_word(word, q), high = round_word(word + 1, q);
    if (low == high)
        return low;
    return round_exactly(n);
}

static bool has_nonzero_digit(const struct scan *n)
{
    for (const char *p = n->text; p < n->text_end; p++)
        if (*p != '0' && *p != '.')
            return true;
    return false;
}

static double from_bits(uint64_t bits, bool negative)
{
    double v;
    bits |= (uint64_t)negative << 63;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* The number's value. */
static double value(struct scan *n)
{
    uint64_t bits = n->count > DIGITS ? round_long(n)
                    : n->word == 0    ? 0
                                      : round_word(n->word, n->exponent);
    if (bits == 0 && has_nonzero_digit(n))
        bits = 1;
    return from_bits(bits, n->negative);
}

size_t proto_read_leading_double(const char *s, size_t len, double *v)
{
    struct scan n;
    const char *end = scan(s, s + len, &n);
    if (end == NULL)
        return 0;
    *v = value(&n);
    return (size_t)(end - s);
}

bool proto_read_double(const char *s, size_t len, double *v)
{
    double number;
    if (len == 0 || proto_read_leading_double(s, len, &number) != len)
        return false;
    *v = number;
    return true;
}

bool proto_is_number(const char *s, size_t len)
{
    struct scan n;
    return len > 0 && scan(s, s + len, &n) == s + len;
}

/* The value of a digit, of base 16 at most; 16: it is none. */
static unsigned digit_of(char c)
{
    return text_is_digit(c)       ? (unsigned)(c - '0')
           : c >= 'a' && c <= 'f' ? (unsigned)(c - 'a') + 10
                                  : 16;
}

/* Reads the digits that are all of s[0 .. len), of a number that is at most `most`. */
static inline bool read_digits(const char *s, size_t len, unsigned base, uint64_t most, uint64_t *v)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < len; i++) {
        unsigned digit = digit_of(s[i]);
        if (digit >= base || __builtin_mul_overflow(sum, base, &sum) ||
            __builtin_add_overflow(sum, digit, &sum) || sum > most)
            return false;
    }
    if (len > 0)
        *v = sum;
    return len > 0;
}

bool proto_read_u64(const char *s, size_t len, uint64_t *v)
{
    return read_digits(s, len, 10, UINT64_MAX, v);
}

bool proto_read_hex(const char *s, size_t len, uint64_t *v)
{
    return read_digits(s, len, 16, UINT64_MAX, v);
}

bool proto_read_u32(const char *s, size_t len, uint32_t *v)
{
    uint64_t word;
    if (!read_digits(s, len, 10, UINT32_MAX, &word))
        return false;
    *v = (uint32_t)word;
    return true;
}
