/* double2_test.c - rounding errors of operations, and double words, against schoolbook big
 * integers. */
#include "core/exact/double2.h"

#include "tests/oracle/exact.h"
#include "tests/test.h"

#include <math.h>

/* A double of `bits` random bits, below 2^exponent. */
static double random_double(int bits, int exponent)
{
    int64_t mantissa = (int64_t)(test_random() >> (64 - bits));
    return ldexp((double)(test_below(2) ? mantissa : -mantissa), exponent - bits);
}

static struct exact total(int n, const double *e)
{
    struct exact sum = {0, {0}};
    for (int i = 0; i < n; i++) {
        struct exact v = exact_from_double(e[i]);
        sum = exact_add(&sum, &v);
    }
    return sum;
}

static bool equal(const struct exact *a, const struct exact *b)
{
    return exact_subtract(a, b).sign == 0;
}

/* The canary: a compiler that fuses c - a with the product c = splitter * a breaks dt_split, and
 * most of these products with it. */
TEST(two_product_is_exact_so_contraction_is_off)
{
    for (int i = 0; i < 20000; i++) {
        double e[2];
        volatile double va = random_double(53, 3), vb = random_double(53, -2);
        double a = va, b = vb;
        dt_two_product(a, b, &e[1], &e[0]);
        struct exact xa = exact_from_double(ldexp(a, 97)), xb = exact_from_double(ldexp(b, 97));
        struct exact product = exact_multiply(&xa, &xb); /* scaled by 2^(2 * (97 + 194)) */
        e[0] = ldexp(e[0], 97), e[1] = ldexp(e[1], 97);
        struct exact hi = exact_from_double(e[1]), lo = exact_from_double(e[0]),
                     one = exact_from_double(0x1p97);
        struct exact sum = exact_add(&hi, &lo), want = exact_multiply(&sum, &one);
        CHECK(equal(&product, &want));
    }
}

TEST(products_are_rounded_before_they_are_subtracted)
{
    volatile double a = 1 + 0x1p-30, b = 1 + 0x1p-30, c = 1 + 0x1p-29;
    double x = a, y = b, z = c;
    CHECK(x * y - z == 0); /* a fused multiply-add would see the 2^-60 that rounding drops */
}

TEST(two_sum_is_exact)
{
    for (int i = 0; i < 20000; i++) {
        double a = random_double(53, (int)test_below(100)),
               b = random_double(53, (int)test_below(100)), e[2];
        dt_two_sum(a, b, &e[1], &e[0]);
        struct exact got = total(2, e), want = total(2, (double[]){a, b});
        CHECK(equal(&got, &want));
        CHECK(e[1] == a + b);
    }
}

/* |got - want| <= bound * |want|, all exact. */
static bool close_to(const struct exact *got, const struct exact *want, int log2_inverse_bound)
{
    struct exact error = exact_subtract(got, want), scaled = error, limit = *want;
    struct exact two = {1, {2}};
    for (int i = 0; i < log2_inverse_bound; i++)
        scaled = exact_multiply(&scaled, &two);
    scaled.sign = scaled.sign != 0, limit.sign = limit.sign != 0;
    return exact_subtract(&scaled, &limit).sign <= 0;
}

TEST(double_words_keep_their_error_bounds)
{
    struct exact one = exact_from_double(1);
    for (int i = 0; i < 5000; i++) {
        struct dt_double2 a =
            dt_double2_difference(random_double(53, 8), random_double(53, 8 - (int)test_below(30)));
        struct dt_double2 b =
            dt_double2_difference(random_double(53, 8), random_double(53, 8 - (int)test_below(30)));
        struct dt_double2 sum = dt_double2_add(a, dt_double2_negate(b)),
                          product = dt_double2_multiply(a, b);
        struct exact xa = total(2, (double[]){a.lo, a.hi}), xb = total(2, (double[]){b.lo, b.hi});
        struct exact got = total(2, (double[]){sum.lo, sum.hi}), want = exact_subtract(&xa, &xb);
        CHECK(close_to(&got, &want, 104));
        got = total(2, (double[]){product.lo, product.hi});
        got = exact_multiply(&got, &one), want = exact_multiply(&xa, &xb);
        CHECK(close_to(&got, &want, 103));
    }
}
