/* bignum_test.c - bignums against schoolbook integers of a fixed length, and identities that hold exactly or up to the
 * stated error. */
#include "core/exact/bignum.h"

#include "tests/oracle/exact.h"
#include "tests/test.h"

#include <math.h>

typedef struct dt_big num;

static num of(double v)
{
    return dt_big_of(v);
}

static num minus(num a, num b)
{
    return dt_big_subtract(a, b);
}

static num plus(num a, num b)
{
    return dt_big_add(a, b);
}

static num times(num a, num b)
{
    return dt_big_multiply(a, b);
}

static num over(num a, num b)
{
    return dt_big_divide(a, b);
}

static num difference(double a, double b)
{
    return dt_big_difference(a, b);
}

static int compare(num a, num b)
{
    return dt_big_compare(a, b);
}

static double random_double(void)
{
    double m = (double)(test_random() >> 11) * (test_below(2) ? 1 : -1);
    return ldexp(m, (int)test_below(600) - 300);
}

/* ---- sums and products of coordinates ---- */

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
static struct exact exact_of(num a)
{
    struct exact r = {a.sign, {0}};
    CHECK(a.n == 0 || (a.exponent >= -8 && 2 * (a.exponent + 8 + (int)a.n) <= EXACT_LIMBS));
    CHECK((a.sign == 0) == (a.n == 0) && (a.n == 0 || (a.limb[0] != 0 && a.limb[a.n - 1] != 0)));
    for (uint32_t i = 0; i < a.n; i++) {
        r.limb[2 * (a.exponent + 8 + (int)i)] = (uint32_t)a.limb[i];
        r.limb[2 * (a.exponent + 8 + (int)i) + 1] = (uint32_t)(a.limb[i] >> 32);
    }
    return r;
}

/* The number is the sum of products, which the oracle has times 2^388. */
static void check_equal(num got, struct exact want)
{
    struct exact scale = exact_from_double(0x1p-70), value = exact_of(got); /* 2^124 */
    want = exact_multiply(&want, &scale);
    CHECK(exact_subtract(&value, &want).sign == 0 && got.sign == want.sign);
}

/* A random difference of coordinates in both forms. */
static struct exact draw(num *r)
{
    double a = coordinate(), b = test_below(8) == 0 ? a : coordinate();
    if (test_below(16) == 0) /* the largest one */
        a = 0x1p201, b = -0x1p201;
    struct exact x = exact_from_double(a), y = exact_from_double(b);
    *r = dt_big_difference(a, b);
    return exact_subtract(&x, &y);
}

static int sign_of_difference(const struct exact *a, const struct exact *b)
{
    return exact_subtract(a, b).sign;
}

TEST(sums_of_products_are_exact_and_compare_exactly)
{
    for (int i = 0; i < 10000; i++) {
        num v[4], sum[2];
        struct exact x[4], y[2];
        for (int k = 0; k < 4; k++)
            x[k] = draw(&v[k]);
        if (test_below(8) == 0)
            x[2] = x[0], v[2] = v[0], x[3] = x[1], v[3] = v[1];
        struct exact left = exact_multiply(&x[0], &x[1]), right = exact_multiply(&x[2], &x[3]);
        y[0] = exact_add(&left, &right), y[1] = exact_subtract(&left, &right);
        sum[0] = plus(times(v[0], v[1]), times(v[2], v[3]));
        sum[1] = minus(times(v[0], v[1]), times(v[2], v[3]));
        check_equal(sum[0], y[0]);
        check_equal(sum[1], y[1]);
        CHECK(compare(sum[0], sum[1]) == sign_of_difference(&y[0], &y[1]));
        CHECK(compare(sum[0], sum[0]) == 0);
        left = exact_multiply(&y[0], &y[0]), right = exact_multiply(&y[1], &y[1]);
        num squares[2] = {times(sum[0], sum[0]), times(sum[1], sum[1])};
        CHECK(compare(squares[0], squares[1]) == sign_of_difference(&left, &right));
        left = exact_multiply(&y[0], &y[1]);
        CHECK(compare(times(sum[0], sum[1]), times(sum[1], sum[0])) == 0);
        CHECK(compare(times(sum[0], sum[1]), squares[1]) == sign_of_difference(&left, &right));
    }
}

/* The last bits of products of four and of six, which no double word sees. */
TEST(products_that_differ_in_one_unit_compare_so)
{
    num large = difference(0x1p201, -0x1p-142), zero = of(0), one = of(1);
    num unit = difference(0x1p-142, nextafter(0x1p-142, 0));
    num a = times(large, large), b = plus(a, times(unit, unit));
    CHECK(compare(a, b) < 0 && compare(b, a) > 0 && compare(a, a) == 0);
    CHECK(compare(times(a, a), times(b, b)) < 0 && compare(times(a, b), times(a, a)) > 0);
    num units = times(unit, unit), cube = times(times(a, a), a);
    CHECK(compare(plus(cube, times(times(units, units), units)), cube) > 0);
    CHECK(compare(times(times(b, b), b), times(times(b, b), a)) > 0);
    CHECK(compare(minus(one, one), b) < 0 && compare(zero, minus(one, one)) == 0);
}

/* ---- any doubles ---- */

TEST(a_bignum_keeps_every_double)
{
    static const double v[] = {0,       1,     -1, 0.1, 3, 0x1p-1074, 0x1.fffffffffffffp1023,
                               -0x1p63, 0x1p64};
    for (unsigned i = 0; i < sizeof v / sizeof *v; i++) {
        num a = of(v[i]);
        CHECK(dt_big_to_double(a) == v[i]);
    }
    for (int i = 0; i < 10000; i++) {
        double a = random_double();
        num b = of(a);
        CHECK(dt_big_to_double(b) == a);
    }
}

TEST(sums_and_products_of_doubles_are_exact)
{
    for (int i = 0; i < 10000; i++) {
        num a = of(random_double()), b = of(random_double()), c = of(random_double());
        num left = times(plus(a, b), minus(a, b)), right = minus(times(a, a), times(b, b));
        CHECK(minus(left, right).sign == 0);
        CHECK(minus(times(plus(a, b), c), plus(times(a, c), times(b, c))).sign == 0);
        CHECK(minus(minus(plus(a, b), b), a).sign == 0);
        CHECK(minus(a, b).sign == -minus(b, a).sign && minus(a, b).sign == compare(a, b));
    }
}

TEST(a_sum_ignores_only_what_is_too_small)
{
    num one = of(1), tiny = of(0x1p-1000), least = times(tiny, of(0x1p-700));
    CHECK(minus(plus(one, tiny), one).sign == 1);
    CHECK(minus(minus(plus(one, least), one), least).sign == 0);
    CHECK(minus(plus(one, times(least, tiny)), one).sign == 0);
    CHECK(minus(one, minus(one, least)).sign == 1);
}

/* The power of two below |a|, about. */
static int magnitude(num a)
{
    return 64 * (a.exponent + (int)a.n) + (int)log2((double)a.limb[a.n - 1]) - 64;
}

TEST(a_quotient_times_its_divisor_is_the_dividend_up_to_the_stated_error)
{
    for (int i = 0; i < 3000; i++) {
        num a = times(of(random_double()), of(random_double())),
            b = plus(of(random_double()), of(random_double()));
        if (a.sign == 0 || b.sign == 0)
            continue;
        num rest = minus(times(over(a, b), b), a);
        CHECK_MSG(rest.sign == 0 || magnitude(rest) <= magnitude(a) - 2490, "%d beside %d",
                  magnitude(rest), magnitude(a));
    }
}

TEST(a_short_quotient_is_exact)
{
    num q = over(of(12), of(-0.75));
    CHECK(dt_big_to_double(q) == -16);
}
