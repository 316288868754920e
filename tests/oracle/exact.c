/* exact.c - big integers by schoolbook methods, and the predicates as their textbook determinants. */
#include "tests/oracle/exact.h"

#include "tests/test.h"

#include <math.h>
#include <string.h>

/* ---- integers ---- */

static int compare_magnitude(const struct exact *a, const struct exact *b)
{
    for (int i = EXACT_LIMBS - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

static void add_magnitude(const struct exact *a, const struct exact *b, struct exact *sum)
{
    uint64_t carry = 0;
    for (int i = 0; i < EXACT_LIMBS; i++) {
        carry += (uint64_t)a->limb[i] + b->limb[i];
        sum->limb[i] = (uint32_t)carry;
        carry >>= 32;
    }
    CHECK(carry == 0);
}

/* |a| >= |b| */
static void subtract_magnitude(const struct exact *a, const struct exact *b,
                               struct exact *difference)
{
    int64_t borrow = 0;
    for (int i = 0; i < EXACT_LIMBS; i++) {
        int64_t digit = (int64_t)a->limb[i] - (int64_t)b->limb[i] - borrow;
        borrow = digit < 0;
        difference->limb[i] = (uint32_t)(digit + (borrow << 32));
    }
    CHECK(borrow == 0);
}

struct exact exact_add(const struct exact *a, const struct exact *b)
{
    struct exact sum = {0, {0}};
    if (a->sign == 0 || b->sign == 0)
        return a->sign == 0 ? *b : *a;
    if (a->sign == b->sign) {
        sum.sign = a->sign;
        add_magnitude(a, b, &sum);
        return sum;
    }
    int order = compare_magnitude(a, b);
    if (order == 0)
        return sum;
    sum.sign = order > 0 ? a->sign : b->sign;
    subtract_magnitude(order > 0 ? a : b, order > 0 ? b : a, &sum);
    return sum;
}

struct exact exact_subtract(const struct exact *a, const struct exact *b)
{
    struct exact minus = *b;
    minus.sign = -minus.sign;
    return exact_add(a, &minus);
}

struct exact exact_multiply(const struct exact *a, const struct exact *b)
{
    struct exact product = {a->sign * b->sign, {0}};
    for (int i = 0; i < EXACT_LIMBS; i++) {
        uint64_t carry = 0;
        if (a->limb[i] == 0)
            continue;
        for (int j = 0; i + j < EXACT_LIMBS; j++) {
            carry += (uint64_t)a->limb[i] * b->limb[j] + product.limb[i + j];
            product.limb[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        CHECK(carry == 0);
    }
    return product;
}

struct exact exact_from_double(double v)
{
    return exact_scaled(v, 194);
}

struct exact exact_scaled(double v, int power)
{
    struct exact r = {(v > 0) - (v < 0), {0}};
    int exponent;
    uint64_t mantissa = (uint64_t)ldexp(frexp(fabs(v), &exponent), 53);
    int shift = exponent - 53 + power;
    if (v == 0)
        return r;
    for (; shift < 0; shift++) {
        CHECK(mantissa % 2 == 0);
        mantissa /= 2;
    }
    for (int bit = 0; bit < 53; bit++) {
        int at = bit + shift;
        if (mantissa >> bit & 1) {
            CHECK(at < 32 * EXACT_LIMBS);
            r.limb[at / 32] |= (uint32_t)1 << at % 32;
        }
    }
    return r;
}

/* The three highest limbs that are not all zero, as a fraction of 2^(32 * *limbs). */
static double leading(const struct exact *a, int *limbs)
{
    int top = EXACT_LIMBS;
    double v = 0;
    while (top > 0 && a->limb[top - 1] == 0)
        top--;
    for (int i = top - 3 > 0 ? top - 3 : 0; i < top; i++)
        v = (v + a->limb[i]) * 0x1p-32;
    *limbs = top;
    return v;
}

double exact_ratio(const struct exact *a, const struct exact *b)
{
    int limbs_a, limbs_b;
    double high_a = leading(a, &limbs_a), high_b = leading(b, &limbs_b);
    return ldexp(high_a / high_b, 32 * (limbs_a - limbs_b));
}

/* ---- predicates ---- */

struct exact_point {
    struct exact x, y, z; /* z: the height on the paraboloid */
};

/* p - origin, lifted: x, y, x^2 + y^2. */
static struct exact_point lifted(struct dt_point p, struct dt_point origin)
{
    struct exact px = exact_from_double(p.x), ox = exact_from_double(origin.x);
    struct exact py = exact_from_double(p.y), oy = exact_from_double(origin.y);
    struct exact_point r = {exact_subtract(&px, &ox), exact_subtract(&py, &oy), {0, {0}}};
    struct exact xx = exact_multiply(&r.x, &r.x), yy = exact_multiply(&r.y, &r.y);
    r.z = exact_add(&xx, &yy);
    return r;
}

static struct exact minor(const struct exact_point *a, const struct exact_point *b)
{
    struct exact left = exact_multiply(&a->x, &b->y), right = exact_multiply(&b->x, &a->y);
    return exact_subtract(&left, &right);
}

int exact_orient2d(struct dt_point a, struct dt_point b, struct dt_point c)
{
    struct exact_point u = lifted(b, a), v = lifted(c, a);
    return minor(&u, &v).sign;
}

int exact_incircle(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    struct exact_point p[3] = {lifted(a, d), lifted(b, d), lifted(c, d)};
    struct exact det = {0, {0}};
    for (int i = 0; i < 3; i++) {
        struct exact m = minor(&p[(i + 1) % 3], &p[(i + 2) % 3]);
        struct exact term = exact_multiply(&p[i].z, &m);
        det = exact_add(&det, &term);
    }
    return det.sign;
}

/* The determinant of the rows (x, y, height, 1) is linear in the heights: the height of row i counts with
 * its cofactor, (-1)^i times the orientation of the other three rows. The sign of the greatest
 * point's coefficient decides, or if it is zero, the next one's. */
int exact_incircle_perturbed(struct dt_point a, struct dt_point b, struct dt_point c,
                             struct dt_point d)
{
    struct dt_point p[4] = {a, b, c, d};
    bool done[4] = {false, false, false, false};
    int sign = exact_incircle(a, b, c, d);
    for (int round = 0; round < 4 && sign == 0; round++) {
        int top = -1;
        for (int i = 0; i < 4; i++)
            if (!done[i] &&
                (top < 0 || p[i].x > p[top].x || (p[i].x == p[top].x && p[i].y > p[top].y)))
                top = i;
        done[top] = true;
        struct dt_point rest[3];
        for (int i = 0, k = 0; i < 4; i++)
            if (i != top)
                rest[k++] = p[i];
        sign = (top % 2 == 0 ? 1 : -1) * exact_orient2d(rest[0], rest[1], rest[2]);
    }
    return sign;
}

int exact_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b)
{
    struct exact_point u = lifted(a, q), v = lifted(b, q);
    return exact_subtract(&u.z, &v.z).sign;
}

int exact_compare_radius(struct dt_point a, struct dt_point b, double r)
{
    struct exact_point u = lifted(a, b);
    struct exact radius = exact_from_double(r), square = exact_multiply(&radius, &radius);
    return exact_subtract(&u.z, &square).sign;
}
