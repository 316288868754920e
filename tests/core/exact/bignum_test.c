/* bignum_test.c - bignums against schoolbook integers of a fixed length. */
#include "core/exact/bignum.h"

#include "tests/oracle/exact.h"
#include "tests/test.h"

#include <math.h>

/* A coordinate: of any exponent, or near the ends of a limb, or 0, of few bits or of many. */
static double coordinate(void)
{
    static const int corner[] = {-142, -129, -128, -127, -65, -64, -63, -1,  0,  1,
                                 53,   63,   64,   65,   127, 128, 191, 192, 200};
    int exponent = test_below(2) ? (int)test_below(343) - 142
                                 : corner[test_below(sizeof corner / sizeof *corner)];
    double v = test_below(3) == 0 ? 1 : 1 + test_uniform();
    if (test_below(3) == 0)
        v = nextafter(v, test_below(2) ? 1 : 2);
    return test_below(8) == 0 ? 0 : ldexp(test_below(2) ? v : -v, exponent);
}

/* The value times 2^512. */
static struct exact exact_of(const struct dt_big *a)
{
    struct exact r = {a->sign, {0}};
    CHECK(a->lo >= 0 && a->lo <= a->hi && a->hi <= DT_BIG_LIMBS);
    for (int i = a->lo; i < a->hi; i++) {
        r.limb[2 * i] = (uint32_t)a->limb[i];
        r.limb[2 * i + 1] = (uint32_t)(a->limb[i] >> 32);
    }
    return r;
}

/* The number is the sum of products, which the oracle has times 2^388. */
static void check_equal(const struct dt_big *got, struct exact want)
{
    struct exact scale = exact_from_double(0x1p-70), value = exact_of(got); /* 2^124 */
    want = exact_multiply(&want, &scale);
    CHECK(exact_subtract(&value, &want).sign == 0);
    CHECK(got->sign == want.sign && (got->sign == 0) == (got->lo == got->hi));
    CHECK(got->sign == 0 || (got->limb[got->lo] != 0 && got->limb[got->hi - 1] != 0));
}

/* A random difference of coordinates in both forms. */
static struct exact draw(struct dt_double2 *r)
{
    double a = coordinate(), b = test_below(8) == 0 ? a : coordinate();
    if (test_below(16) == 0) /* the largest one */
        a = 0x1p201, b = -0x1p201;
    struct exact x = exact_from_double(a), y = exact_from_double(b);
    *r = dt_double2_difference(a, b);
    return exact_subtract(&x, &y);
}

static int sign_of_difference(const struct exact *a, const struct exact *b)
{
    return exact_subtract(a, b).sign;
}

TEST(sums_of_products_are_exact_and_compare_exactly)
{
    for (int i = 0; i < 10000; i++) {
        struct dt_double2 v[4];
        struct dt_big sum[2];
        struct exact x[4], y[2];
        for (int k = 0; k < 4; k++)
            x[k] = draw(&v[k]);
        if (test_below(8) == 0)
            x[2] = x[0], v[2] = v[0], x[3] = x[1], v[3] = v[1];
        struct exact left = exact_multiply(&x[0], &x[1]), right = exact_multiply(&x[2], &x[3]);
        y[0] = exact_add(&left, &right), y[1] = exact_subtract(&left, &right);
        dt_big_products(v[0], v[1], 1, v[2], v[3], &sum[0]);
        dt_big_products(v[0], v[1], -1, v[2], v[3], &sum[1]);
        check_equal(&sum[0], y[0]);
        check_equal(&sum[1], y[1]);
        CHECK(dt_big_compare(&sum[0], &sum[1]) == sign_of_difference(&y[0], &y[1]));
        CHECK(dt_big_compare(&sum[0], &sum[0]) == 0);
        left = exact_multiply(&y[0], &y[0]), right = exact_multiply(&y[1], &y[1]);
        CHECK(dt_big_compare_products(&sum[0], &sum[0], &sum[1], &sum[1]) ==
              sign_of_difference(&left, &right));
        left = exact_multiply(&y[0], &y[1]);
        CHECK(dt_big_compare_products(&sum[0], &sum[1], &sum[1], &sum[0]) == 0);
        CHECK(dt_big_compare_products(&sum[0], &sum[1], &sum[1], &sum[1]) ==
              sign_of_difference(&left, &right));
    }
}

/* The last bits of products of four, which no double word sees. */
TEST(products_that_differ_in_one_unit_of_2_to_the_minus_388_compare_so)
{
    struct dt_double2 large = dt_double2_difference(0x1p201, -0x1p-142), one = {1, 0},
                      zero = {0, 0};
    struct dt_double2 unit = dt_double2_difference(0x1p-142, nextafter(0x1p-142, 0));
    struct dt_big a, b;
    dt_big_products(large, large, 1, zero, zero, &a);
    dt_big_products(large, large, 1, unit, unit, &b);
    CHECK(dt_big_compare(&a, &b) < 0 && dt_big_compare(&b, &a) > 0);
    CHECK(dt_big_compare_products(&a, &a, &b, &b) < 0);
    CHECK(dt_big_compare_products(&a, &b, &a, &a) > 0);
    dt_big_products(one, one, -1, one, one, &a);
    CHECK(a.sign == 0 && dt_big_compare(&a, &b) < 0 && dt_big_compare(&a, &a) == 0);
    CHECK(dt_big_compare_products(&a, &b, &b, &b) < 0);
    dt_big_products(zero, one, 1, zero, zero, &a);
    CHECK(a.sign == 0 && a.lo == a.hi);
}
