/* bigfloat.c - see bigfloat.h. */
#include "core/exact/bigfloat.h"

#include <math.h>
#include <string.h>

enum { N = DT_BIGFLOAT_LIMBS };

/* The number sum wide[i] 2^(64 (exponent + i)) of n >= N limbs, truncated to the first N that are not 0. */
static struct dt_bigfloat normalized(int sign, int32_t exponent, const uint64_t *wide, int n)
{
    struct dt_bigfloat r = {0};
    while (n > 0 && wide[n - 1] == 0)
        n--;
    if (n == 0)
        return r;
    int from = n < N ? 0 : n - N, at = n < N ? N - n : 0;
    memcpy(r.limb + at, wide + from, (size_t)(n - from) * sizeof *wide);
    r.sign = sign;
    r.exponent = exponent + from - at;
    return r;
}

struct dt_bigfloat dt_bigfloat_of(double v)
{
    uint64_t wide[N] = {0};
    int e;
    double m = frexp(fabs(v), &e); /* |v| = m 2^e; m = 0 or 0.5 <= m < 1 */
    if (m == 0)
        return (struct dt_bigfloat){0};
    int32_t exponent = (e - 53) >> 6; /* rounds down */
    int shift = e - 53 - 64 * exponent;
    uint64_t bits = (uint64_t)ldexp(m, 53);
    wide[0] = bits << shift;
    wide[1] = shift > 11 ? bits >> (64 - shift) : 0;
    return normalized(v < 0 ? -1 : 1, exponent, wide, N);
}

double dt_bigfloat_to_double(const struct dt_bigfloat *a)
{
    double v = 0;
    for (int i = N - 3; i < N; i++) /* the last but two because the top one may have few bits */
        v += ldexp((double)a->limb[i], 64 * (a->exponent + i));
    return a->sign * v;
}

/* Of the absolute values. */
static int compare(const struct dt_bigfloat *a, const struct dt_bigfloat *b)
{
    if (a->sign == 0 || b->sign == 0)
        return (a->sign != 0) - (b->sign != 0);
    if (a->exponent != b->exponent)
        return a->exponent < b->exponent ? -1 : 1;
    for (int i = N - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

/* sign * (|a| + by * |b|) for |a| >= |b| and by = 1 or -1; exact but for the last truncation. */
static struct dt_bigfloat combine(int sign, const struct dt_bigfloat *a, int by,
                                  const struct dt_bigfloat *b)
{
    uint64_t wide[2 * N + 1] = {0};
    int32_t above = a->exponent - b->exponent; /* of b's limbs; the last N of wide hold a's */
    struct dt_bigfloat r = *a;
    r.sign = sign;
    if (b->sign == 0 || above > N)
        return r;
    memcpy(wide + N, a->limb, sizeof a->limb);
    unsigned __int128 carry = 0;
    for (int i = 0; i <= N + above || carry != 0; i++) {
        int at = N - above + i; /* of limb i of b in wide */
        if (at > 2 * N)
            break;
        uint64_t limb = i < N ? b->limb[i] : 0;
        if (by > 0) {
            carry += (unsigned __int128)wide[at] + limb;
            wide[at] = (uint64_t)carry;
            carry >>= 64;
        } else {
            carry = (unsigned __int128)wide[at] - limb - (uint64_t)carry;
            wide[at] = (uint64_t)carry;
            carry = carry >> 64 != 0;
        }
    }
    return normalized(sign, a->exponent - N, wide, 2 * N + 1);
}

struct dt_bigfloat dt_bigfloat_add(const struct dt_bigfloat *a, const struct dt_bigfloat *b)
{
    int order = compare(a, b), by = a->sign * b->sign < 0 ? -1 : 1;
    if (order == 0 && by < 0)
        return (struct dt_bigfloat){0};
    return order >= 0 ? combine(a->sign, a, by, b) : combine(b->sign, b, by, a);
}

struct dt_bigfloat dt_bigfloat_subtract(const struct dt_bigfloat *a, const struct dt_bigfloat *b)
{
    struct dt_bigfloat minus = *b;
    minus.sign = -b->sign;
    return dt_bigfloat_add(a, &minus);
}

struct dt_bigfloat dt_bigfloat_multiply(const struct dt_bigfloat *a, const struct dt_bigfloat *b)
{
    uint64_t wide[2 * N] = {0};
    for (int i = 0; i < N; i++) {
        unsigned __int128 carry = 0;
        if (a->limb[i] == 0)
            continue; /* most are: few numbers have all their bits */
        for (int k = 0; k < N; k++) {
            carry += (unsigned __int128)a->limb[i] * b->limb[k] + wide[i + k];
            wide[i + k] = (uint64_t)carry;
            carry >>= 64;
        }
        wide[i + N] = (uint64_t)carry;
    }
    return normalized(a->sign * b->sign, a->exponent + b->exponent, wide, 2 * N);
}

/* 1 / b by Newton's iteration x <- x + x (1 - b x), which doubles the bits that are right. */
static struct dt_bigfloat reciprocal(const struct dt_bigfloat *b)
{
    struct dt_bigfloat one = dt_bigfloat_of(1), scaled = *b;
    scaled.exponent = -N; /* 2^-64 <= scaled < 1, so a double holds it */
    struct dt_bigfloat x = dt_bigfloat_of(1 / dt_bigfloat_to_double(&scaled));
    for (int bits = 50; bits < 64 * N; bits *= 2) {
        struct dt_bigfloat product = dt_bigfloat_multiply(&scaled, &x);
        struct dt_bigfloat rest = dt_bigfloat_subtract(&one, &product);
        struct dt_bigfloat step = dt_bigfloat_multiply(&x, &rest);
        x = dt_bigfloat_add(&x, &step);
    }
    x.exponent += -N - b->exponent;
    return x;
}

struct dt_bigfloat dt_bigfloat_divide(const struct dt_bigfloat *a, const struct dt_bigfloat *b)
{
    struct dt_bigfloat r = reciprocal(b);
    return dt_bigfloat_multiply(a, &r);
}
