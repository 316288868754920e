/* bigfloat_test.c - identities that hold exactly, or up to the stated error. */
#include "core/exact/bigfloat.h"
#include "tests/test.h"

#include <math.h>

typedef struct dt_bigfloat num;

static double random_double(void)
{
    double m = (double)(test_random() >> 11) * (test_below(2) ? 1 : -1);
    return ldexp(m, (int)test_below(600) - 300);
}

static num of(double v)
{
    return dt_bigfloat_of(v);
}

static num minus(num a, num b)
{
    return dt_bigfloat_subtract(&a, &b);
}

static num plus(num a, num b)
{
    return dt_bigfloat_add(&a, &b);
}

static num times(num a, num b)
{
    return dt_bigfloat_multiply(&a, &b);
}

/* The power of two below |a|, about. */
static int magnitude(num a)
{
    return 64 * (a.exponent + DT_BIGFLOAT_LIMBS) +
           (int)log2((double)a.limb[DT_BIGFLOAT_LIMBS - 1]) - 64;
}

TEST(bigfloat_keeps_every_double)
{
    static const double v[] = {0,       1,     -1, 0.1, 3, 0x1p-1074, 0x1.fffffffffffffp1023,
                               -0x1p63, 0x1p64};
    for (unsigned i = 0; i < sizeof v / sizeof *v; i++) {
        num a = of(v[i]);
        CHECK(dt_bigfloat_to_double(&a) == v[i]);
    }
    for (int i = 0; i < 10000; i++) {
        double a = random_double();
        num b = of(a);
        CHECK(dt_bigfloat_to_double(&b) == a);
    }
}

TEST(bigfloat_sums_and_products_of_doubles_are_exact)
{
    for (int i = 0; i < 10000; i++) {
        num a = of(random_double()), b = of(random_double()), c = of(random_double());
        num left = times(plus(a, b), minus(a, b)), right = minus(times(a, a), times(b, b));
        CHECK(minus(left, right).sign == 0);
        CHECK(minus(times(plus(a, b), c), plus(times(a, c), times(b, c))).sign == 0);
        CHECK(minus(minus(plus(a, b), b), a).sign == 0);
        CHECK(minus(a, b).sign == -minus(b, a).sign);
    }
}

TEST(bigfloat_sum_ignores_only_what_is_too_small)
{
    num one = of(1), tiny = of(0x1p-1000), least = times(tiny, of(0x1p-700));
    CHECK(minus(plus(one, tiny), one).sign == 1);
    CHECK(minus(minus(plus(one, least), one), least).sign == 0);
    CHECK(minus(plus(one, times(least, tiny)), one).sign == 0);
    CHECK(minus(one, minus(one, least)).sign == 1);
}

TEST(bigfloat_quotient_times_divisor_is_the_dividend_up_to_the_stated_error)
{
    for (int i = 0; i < 3000; i++) {
        num a = times(of(random_double()), of(random_double())),
            b = plus(of(random_double()), of(random_double()));
        if (a.sign == 0 || b.sign == 0)
            continue;
        num rest = minus(times(dt_bigfloat_divide(&a, &b), b), a);
        CHECK_MSG(rest.sign == 0 || magnitude(rest) <= magnitude(a) - 1850, "%d beside %d",
                  magnitude(rest), magnitude(a));
    }
}

TEST(bigfloat_division_is_exact_where_the_quotient_is_short)
{
    num a = of(12), b = of(-0.75), q = dt_bigfloat_divide(&a, &b);
    CHECK(dt_bigfloat_to_double(&q) == -16);
}
