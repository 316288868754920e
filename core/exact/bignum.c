/* bignum.c - schoolbook arithmetic [Knuth, TAOCP 2, sec. 4.3.1]; see bignum.h.
 *
 * Two to four limbs are the usual case, so nothing faster than schoolbook would pay off. A double word is not
 * stored as limbs: its two parts are far apart where exponents are wide, and one of them is mostly zero where
 * they are not. So the products of parts, 106 bits each, are added where they belong. */
#include "core/exact/bignum.h"

#include <stdbool.h>
#include <string.h>

enum { FRACTION = 52, SMALLEST = -1075, BIAS = 256 };

/* A double other than 0: magnitude = integer * 2^(bit - 256). */
struct parts {
    uint64_t integer;
    int bit;
    bool negative;
};

static struct parts parts_of(double v)
{
    uint64_t bits, fraction = ((uint64_t)1 << FRACTION) - 1;
    memcpy(&bits, &v, sizeof bits);
    return (struct parts){(bits & fraction) | (fraction + 1),
                          (int)(bits >> FRACTION & 2047) + SMALLEST + BIAS, v < 0};
}

/* ---- sums ---- */

/* The sum of the terms of either sign; its limbs below lo and from hi on are zero. */
struct sum {
    int lo, hi;
    uint64_t limb[2][DT_BIG_LIMBS]; /* of positive terms, of negative ones */
};

/* The empty statement keeps gcc from making this a string instruction, which takes longer than all the
 * stores. */
static void begin(struct sum *s)
{
    s->lo = DT_BIG_LIMBS;
    s->hi = 0;
    for (int i = 0; i < DT_BIG_LIMBS; i++) {
        s->limb[0][i] = s->limb[1][i] = 0;
        __asm__ volatile("");
    }
}

static void add_at(uint64_t *limb, unsigned __int128 term, unsigned shift)
{
    uint64_t low = (uint64_t)term, high = (uint64_t)(term >> 64);
    uint64_t part[3] = {low << shift, high << shift, 0};
    if (shift > 0) {
        part[1] |= low >> (64 - shift);
        part[2] = high >> (64 - shift);
    }
    uint64_t carry = 0;
    for (int i = 0; i < 3; i++) {
        unsigned __int128 total = (unsigned __int128)limb[i] + part[i] + carry;
        limb[i] = (uint64_t)total;
        carry = (uint64_t)(total >> 64);
    }
    for (int i = 3; carry > 0; i++)
        carry = ++limb[i] == 0;
}

/* *s += a b or -= a b, unless one of them is 0. */
static void add_product(struct sum *s, double a, double b, bool negative)
{
    if (a == 0 || b == 0)
        return;
    struct parts x = parts_of(a), y = parts_of(b);
    int bit = x.bit + y.bit, at = bit / 64;
    add_at(&s->limb[x.negative ^ y.negative ^ negative][at],
           (unsigned __int128)x.integer * y.integer, (unsigned)bit % 64);
    s->lo = at < s->lo ? at : s->lo;
    s->hi = at + 4 > s->hi ? at + 4 : s->hi; /* a carry included */
}

static void add_product_2(struct sum *s, struct dt_double2 a, struct dt_double2 b, bool negative)
{
    add_product(s, a.hi, b.hi, negative);
    add_product(s, a.hi, b.lo, negative);
    add_product(s, a.lo, b.hi, negative);
    add_product(s, a.lo, b.lo, negative);
}

static void trim(struct dt_big *r)
{
    while (r->lo < r->hi && r->limb[r->hi - 1] == 0)
        r->hi--;
    while (r->lo < r->hi && r->limb[r->lo] == 0)
        r->lo++;
    if (r->lo == r->hi)
        r->sign = 0;
}

/* *r = the limbs plus[] - minus[]. */
static void subtract(const struct sum *s, const uint64_t *plus, const uint64_t *minus,
                     struct dt_big *r)
{
    uint64_t borrow = 0;
    for (int i = s->lo; i < s->hi; i++) {
        unsigned __int128 rest = (unsigned __int128)plus[i] - minus[i] - borrow;
        r->limb[i] = (uint64_t)rest;
        borrow = (uint64_t)(rest >> 64) & 1;
    }
}

void dt_big_products(struct dt_double2 a, struct dt_double2 b, int sign, struct dt_double2 c,
                     struct dt_double2 d, struct dt_big *r)
{
    struct sum s;
    begin(&s);
    add_product_2(&s, a, b, false);
    add_product_2(&s, c, d, sign < 0);
    int top = s.hi - 1;
    while (top > s.lo && s.limb[0][top] == s.limb[1][top])
        top--;
    bool negative = s.hi > 0 && s.limb[0][top] < s.limb[1][top];
    r->sign = negative ? -1 : 1;
    r->lo = s.hi > 0 ? s.lo : 0;
    r->hi = s.hi > 0 ? top + 1 : 0;
    subtract(&s, s.limb[negative], s.limb[!negative], r);
    trim(r);
}

/* ---- products ---- */

/* The limbs lo .. hi - 1 of a product of two or three. */
struct product {
    int lo, hi;
    uint64_t limb[3 * DT_BIG_LIMBS];
};

/* acc[0 .. n] += limb * a[0 .. n - 1], where acc[n] is still unset. */
static void add_row(uint64_t *acc, const uint64_t *a, int n, uint64_t limb)
{
    uint64_t carry = 0;
    for (int i = 0; i < n; i++) {
        unsigned __int128 total = (unsigned __int128)a[i] * limb + acc[i] + carry;
        acc[i] = (uint64_t)total;
        carry = (uint64_t)(total >> 64);
    }
    acc[n] = carry;
}

/* *r = the product of limbs, those of `a` from lo to hi, by b; neither is 0. */
static void multiply(const uint64_t *a, int lo, int hi, const struct dt_big *b, struct product *r)
{
    int n = hi - lo;
    r->lo = lo + b->lo;
    r->hi = hi + b->hi;
    for (int i = 0; i < n; i++)
        r->limb[r->lo + i] = 0;
    for (int i = b->lo; i < b->hi; i++)
        add_row(r->limb + lo + i, a + lo, n, b->limb[i]);
    r->hi -= r->limb[r->hi - 1] == 0;
}

/* Of numbers with the highest limb not 0. */
static int compare_limbs(const uint64_t *a, int a_lo, int a_hi, const uint64_t *b, int b_lo,
                         int b_hi)
{
    if (a_hi != b_hi)
        return a_hi < b_hi ? -1 : 1;
    for (int i = a_hi; i-- > (a_lo < b_lo ? a_lo : b_lo);) {
        uint64_t x = i >= a_lo ? a[i] : 0, y = i >= b_lo ? b[i] : 0;
        if (x != y)
            return x < y ? -1 : 1;
    }
    return 0;
}

int dt_big_compare(const struct dt_big *a, const struct dt_big *b)
{
    if (a->sign != b->sign || a->sign == 0)
        return (a->sign > b->sign) - (a->sign < b->sign);
    return a->sign * compare_limbs(a->limb, a->lo, a->hi, b->limb, b->lo, b->hi);
}

int dt_big_compare_products(const struct dt_big *a, const struct dt_big *b, const struct dt_big *c,
                            const struct dt_big *d)
{
    int left = a->sign * b->sign, right = c->sign * d->sign;
    if (left != right || left == 0)
        return (left > right) - (left < right);
    struct product x, y;
    multiply(a->limb, a->lo, a->hi, b, &x);
    multiply(c->limb, c->lo, c->hi, d, &y);
    return left * compare_limbs(x.limb, x.lo, x.hi, y.limb, y.lo, y.hi);
}

int dt_big_compare_triples(const struct dt_big a[3], const struct dt_big b[3])
{
    int left = a[0].sign * a[1].sign * a[2].sign, right = b[0].sign * b[1].sign * b[2].sign;
    if (left != right || left == 0)
        return (left > right) - (left < right);
    struct product two, x, y;
    multiply(a[0].limb, a[0].lo, a[0].hi, &a[1], &two);
    multiply(two.limb, two.lo, two.hi, &a[2], &x);
    multiply(b[0].limb, b[0].lo, b[0].hi, &b[1], &two);
    multiply(two.limb, two.lo, two.hi, &b[2], &y);
    return left * compare_limbs(x.limb, x.lo, x.hi, y.limb, y.lo, y.hi);
}
