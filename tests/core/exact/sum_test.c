/* sum_test.c - exact sums, beside numbers of 2,560 bits. */
#include "core/exact/sum.h"

#include <math.h>

#include "core/exact/bignum.h"
#include "tests/test.h"

/* A number of any size that coordinates may have. */
static double coordinate(void)
{
    double v = ldexp((double)(test_random() >> 11), (int)(test_random() % 340) - 53 - 142);
    return test_random() % 2 == 0 ? v : -v;
}

static void add_product(struct dt_big *sum, double a, double b, bool minus)
{
    struct dt_big x, y;
    x = dt_big_of(a);
    y = dt_big_of(b);
    x = dt_big_multiply(x, y);
    if (minus)
        *sum = dt_big_subtract(*sum, x);
    else
        *sum = dt_big_add(*sum, x);
}

TEST(half_the_sum_of_cross_products_is_rounded_once)
{
    for (int round = 0; round < 2000; round++) {
        struct dt_sum sum = {0};
        struct dt_big exact = dt_big_of(0);
        for (uint64_t n = test_random() % 20; n > 0; n--) {
            struct dt_point a = {coordinate(), coordinate()}, b = {coordinate(), coordinate()};
            bool back = test_random() % 3 == 0; /* terms that cancel */
            for (int k = 0; k < 1 + back; k++) {
                struct dt_point p = k == 0 ? a : b, q = k == 0 ? b : a;
                dt_sum_cross(&sum, p, q);
                add_product(&exact, p.x, q.y, false);
                add_product(&exact, p.y, q.x, true);
            }
        }
        CHECK(dt_sum_half(&sum) == (exact.sign == 0 ? 0 : dt_big_nearest(exact) / 2));
    }
}

TEST(sums_of_the_largest_and_least_terms_lose_nothing)
{
    struct dt_sum sum = {0};
    const double most = 0x1p201, least = 0x1p-142;
    dt_sum_cross(&sum, (struct dt_point){least, 0}, (struct dt_point){0, least});
    for (int i = 0; i < 1000; i++)
        dt_sum_cross(&sum, (struct dt_point){most, -most}, (struct dt_point){most, most});
    for (int i = 0; i < 1000; i++)
        dt_sum_cross(&sum, (struct dt_point){most, most}, (struct dt_point){most, -most});
    CHECK(dt_sum_half(&sum) == least * least / 2);
    CHECK(dt_sum_half(&(struct dt_sum){0}) == 0);
}

/* ---- of any size ---- */

/* From the least double to some power of two, sometimes 0. */
static double any_double(int from, int range)
{
    double v = ldexp((double)(test_random() >> 11), (int)(test_random() % (uint64_t)range) + from);
    return test_random() % 10 == 0 ? 0 : v;
}

/* v with few bits, so that the product of two such numbers has at most 53. */
static double few_bits(double v)
{
    return v == 0 ? 0 : ldexp(1 + (double)(test_random() % 1000) / 1024, ilogb(v));
}

TEST(wide_sums_of_any_doubles_are_exact_and_in_any_order)
{
    static const struct {
        int from, range;
    } kind[] = {{-60, 20}, {-1074, 1900}, {-700, 1400}, {-1074, 30}};
    for (int round = 0; round < 2000; round++) {
        struct dt_wide_sum sum = {0}, back = {0};
        struct dt_big exact, six;
        double a[20], b[20];
        int n = (int)(test_random() % 20), k = round % 4;
        exact = dt_big_of(0);
        six = dt_big_of(6);
        for (int i = 0; i < n; i++) {
            a[i] = few_bits(any_double(kind[k].from, kind[k].range));
            b[i] = few_bits(any_double(-60, k == 1 ? 500 : 20));
            dt_wide_sum_add(&sum, a[i], b[i]);
            add_product(&exact, a[i], b[i], false);
        }
        for (int i = n; i-- > 0;)
            dt_wide_sum_add(&back, a[i], b[i]);
        six = dt_big_divide(exact, six);
        double want = exact.sign == 0 ? 0 : dt_big_nearest(six);
        CHECK(dt_wide_sum_over(&sum, 6) == want && dt_wide_sum_over(&back, 6) == want);
    }
}
