/* bignum.c - schoolbook arithmetic [Knuth, TAOCP 2, sec. 4.3.1]; see bignum.h. One to four limbs are the usual case, so
 * nothing faster than schoolbook would pay off. */
#include "core/exact/bignum.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/exact/double2.h"

enum { N = DT_BIG_LIMBS };

/* sign * sum wide[i] 2^(64 (exponent + i)), i < n, truncated to the upper N limbs. */
static struct dt_big big_of(int sign, int32_t exponent, const uint64_t *wide, uint32_t n)
{
    struct dt_big r;
    uint32_t low = 0;
    while (n > 0 && wide[n - 1] == 0)
        n--;
    if (n > N)
        low = n - N;
    while (low < n && wide[low] == 0)
        low++;
    r.sign = n > 0 ? sign : 0;
    r.exponent = exponent + (int32_t)low;
    r.n = n - low;
    for (uint32_t i = 0; i < r.n; i++)
        r.limb[i] = wide[low + i];
    return r;
}

/* |v| = integer 2^(bit - 64 BIAS). */
struct dt_big dt_big_of(double v)
{
    enum { FRACTION = 52, LEAST = -1075, BIAS = 17 };
    uint64_t bits, one = (uint64_t)1 << FRACTION;
    memcpy(&bits, &v, sizeof bits);
    int power = (int)(bits >> FRACTION & 2047), bit = (power > 0 ? power : 1) + LEAST + 64 * BIAS;
    uint64_t integer = (bits & (one - 1)) | (power > 0 ? one : 0);
    int shift = bit % 64;
    uint64_t wide[2] = {integer << shift, shift > 0 ? integer >> (64 - shift) : 0};
    return big_of(v < 0 ? -1 : 1, bit / 64 - BIAS, wide, 2);
}

/* From three limbs, because the top one may have few bits. */
double dt_big_to_double(struct dt_big a)
{
    double v = 0;
    for (uint32_t i = a.n > 3 ? a.n - 3 : 0; i < a.n; i++)
        v += ldexp((double)a.limb[i], 64 * (a.exponent + (int32_t)i));
    return a.sign * v;
}

/* ---- sums ---- */

/* The place above the highest limb; the place of limb i is exponent + i. */
static int32_t top_of(const struct dt_big *a)
{
    return a->exponent + (int32_t)a->n;
}

static uint64_t limb_at(const struct dt_big *a, int32_t place)
{
    uint32_t i = (uint32_t)(place - a->exponent);
    return i < a->n ? a->limb[i] : 0;
}

/* Compares the absolute values. */
static int compare(const struct dt_big *a, const struct dt_big *b)
{
    if (a->sign == 0 || b->sign == 0)
        return (a->sign != 0) - (b->sign != 0);
    int32_t top = top_of(a), low = a->exponent < b->exponent ? a->exponent : b->exponent;
    if (top != top_of(b))
        return top < top_of(b) ? -1 : 1;
    while (top-- > low) {
        uint64_t x = limb_at(a, top), y = limb_at(b, top);
        if (x != y)
            return x < y ? -1 : 1;
    }
    return 0;
}

int dt_big_compare(struct dt_big a, struct dt_big b)
{
    if (a.sign != b.sign)
        return a.sign < b.sign ? -1 : 1;
    return a.sign * compare(&a, &b);
}

/* sign * (|a| + |b|), or sign * (|a| - |b|) for |a| >= |b|, which adds the complement of b. b is left out if all of it
 * is below the limbs that the result can have. */
static struct dt_big combine(int sign, const struct dt_big *a, bool minus, const struct dt_big *b)
{
    uint64_t wide[2 * N + 1], flip = minus ? UINT64_MAX : 0, carry = minus;
    int32_t top = top_of(a), low = a->exponent;
    uint32_t n = 0;
    if (b->exponent < low && top - top_of(b) <= N)
        low = b->exponent;
    for (int32_t at = low; at < top; at++) {
        unsigned __int128 sum = (unsigned __int128)limb_at(a, at) + (limb_at(b, at) ^ flip) + carry;
        wide[n++] = (uint64_t)sum;
        carry = (uint64_t)(sum >> 64);
    }
    wide[n++] = minus ? 0 : carry;
    return big_of(sign, low, wide, n);
}

/* a + b, with `sign` as the sign of b. */
static struct dt_big sum(const struct dt_big *a, int sign, const struct dt_big *b)
{
    bool minus = a->sign * sign < 0;
    return compare(a, b) >= 0 ? combine(a->sign, a, minus, b) : combine(sign, b, minus, a);
}

struct dt_big dt_big_add(struct dt_big a, struct dt_big b)
{
    return sum(&a, b.sign, &b);
}

struct dt_big dt_big_subtract(struct dt_big a, struct dt_big b)
{
    return sum(&a, -b.sign, &b);
}

/* Usually, where exponents are alike, the difference is a double. It is not if it overflows, which makes the error nan. */
struct dt_big dt_big_difference(double a, double b)
{
    struct dt_double2 d = dt_double2_difference(a, b);
    return d.lo == 0 ? dt_big_of(d.hi) : dt_big_subtract(dt_big_of(a), dt_big_of(b));
}

/* ---- products and quotients ---- */

struct dt_big dt_big_multiply(struct dt_big a, struct dt_big b)
{
    uint64_t wide[2 * N];
    for (uint32_t k = 0; k < b.n; k++)
        wide[k] = 0;
    for (uint32_t i = 0; i < a.n; i++) {
        uint64_t carry = 0;
        for (uint32_t k = 0; k < b.n && a.limb[i] != 0; k++) {
            unsigned __int128 sum = (unsigned __int128)a.limb[i] * b.limb[k] + wide[i + k] + carry;
            wide[i + k] = (uint64_t)sum;
            carry = (uint64_t)(sum >> 64);
        }
        wide[i + b.n] = carry;
    }
    return big_of(a.sign * b.sign, a.exponent + b.exponent, wide, a.n + b.n);
}

/* 1 / b by Newton's iteration x <- x + x (1 - b x), which doubles the bits that are right. */
static struct dt_big reciprocal(struct dt_big b)
{
    int32_t top = top_of(&b);
    b.exponent -= top; /* 2^-64 <= b < 1, so a double holds it */
    struct dt_big one = dt_big_of(1), x = dt_big_of(1 / dt_big_to_double(b));
    for (int bits = 50; bits < 64 * N; bits *= 2) {
        struct dt_big rest = dt_big_subtract(one, dt_big_multiply(b, x));
        x = dt_big_add(x, dt_big_multiply(x, rest));
    }
    x.exponent -= top;
    return x;
}

struct dt_big dt_big_divide(struct dt_big a, struct dt_big b)
{
    return dt_big_multiply(a, reciprocal(b));
}

/* ---- rounding ---- */

static bool is_odd(double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    return (bits & 1) != 0;
}

/* Whether a / b is nearer to the double above v than to v; halfway, to the even one. Above the largest double is 2^1024. The gap is not
 * halved, since the gap between the least doubles cannot be. */
static bool is_nearer_above(struct dt_big a, struct dt_big b, double v)
{
    double up = nextafter(v, HUGE_VAL), gap = isinf(up) ? v - nextafter(v, 0) : up - v;
    struct dt_big middle = dt_big_of(v), twice = dt_big_add(a, a);
    middle = dt_big_add(dt_big_add(middle, middle), dt_big_of(gap)); /* twice as well */
    int above = dt_big_compare(twice, dt_big_multiply(middle, b)) * b.sign;
    return above > 0 || (above == 0 && is_odd(v));
}

/* The double nearest to a / b, ties to even; v is a double near it. */
static double nearest(struct dt_big a, struct dt_big b, double v)
{
    struct dt_big minus = a;
    minus.sign = -minus.sign;
    v = isinf(v) ? copysign(DBL_MAX, v) : v;
    while (!isinf(v) && is_nearer_above(a, b, v))
        v = nextafter(v, HUGE_VAL);
    while (!isinf(v) && is_nearer_above(minus, b, -v))
        v = nextafter(v, -HUGE_VAL);
    return v;
}

double dt_big_nearest(struct dt_big a)
{
    return nearest(a, dt_big_of(1), dt_big_to_double(a));
}

double dt_big_quotient(struct dt_big a, struct dt_big b)
{
    return a.sign == 0 ? 0 : nearest(a, b, dt_big_to_double(dt_big_divide(a, b)));
}
