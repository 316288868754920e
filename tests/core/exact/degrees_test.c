/* degrees_test.c - angles beside those of the C library in long doubles, and some whose bytes are known. */
#include "core/exact/degrees.h"

#include <float.h>
#include <math.h>

#include "tests/test.h"

static const long double turn = 57.295779513082320876798154814105170332L;

static void check_near(double got, long double want, double dx, double dy)
{
    long double error = fabsl((long double)got - want);
    CHECK_MSG(error <= 0x1p-52L * fabsl(want) + 0x1p-1067L, "%.17g instead of %.17Lg for %a %a",
              got, want, dx, dy);
}

static long double steep(double dx, double dy)
{
    return atanl(hypotl((long double)dx, (long double)dy)) * turn;
}

static long double downhill(double dx, double dy)
{
    long double angle = atan2l(-(long double)dx, -(long double)dy) * turn;
    return angle < 0 ? 360 + angle : angle;
}

static double any_slope(int kind)
{
    int range = kind == 0 ? 3 : kind == 1 ? 60 : 2000;
    double v = ldexp(2 * test_uniform() - 1, (int)(test_random() % (uint64_t)range) - range / 2);
    return test_random() % 10 == 0 ? 0 : test_random() % 5 == 0 ? copysign(1, v) : v;
}

TEST(degrees_err_by_less_than_2_to_minus_52)
{
    for (int i = 0; i < 200000; i++) {
        double dx = any_slope(i % 3), dy = any_slope(i % 3);
        check_near(dt_degrees_steep(dx, dy), steep(dx, dy), dx, dy);
        if (dx == 0 && dy == 0)
            CHECK(isnan(dt_degrees_downhill(dx, dy)));
        else if (downhill(dx, dy) < 359.9999999999999L)
            check_near(dt_degrees_downhill(dx, dy), downhill(dx, dy), dx, dy);
    }
}

TEST(degrees_of_eighths_of_a_turn_are_exact)
{
    static const double slope[8][2] = {{0, -3}, {-3, -3}, {-3, 0}, {-3, 3},
                                       {0, 3},  {3, 3},   {3, 0},  {3, -3}};
    static const double size[] = {0x1p-1074, 0x1p-1000, 1, 0x1p1000, HUGE_VAL};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 5; k++) {
            double dx = slope[i][0] == 0 ? 0 : slope[i][0] * size[k],
                   dy = slope[i][1] == 0 ? 0 : slope[i][1] * size[k];
            CHECK(dt_degrees_downhill(dx, dy) == 45 * i);
        }
    CHECK(dt_degrees_downhill(-0.0, -1) == 0 && dt_degrees_downhill(1, 0.0) == 270);
    CHECK(dt_degrees_steep(1, 0) == 45 && dt_degrees_steep(0, -1) == 45);
}

TEST(degrees_at_the_ends_of_their_ranges)
{
    CHECK(dt_degrees_steep(0, 0) == 0 && dt_degrees_steep(0, -0.0) == 0);
    CHECK(dt_degrees_steep(HUGE_VAL, 0) == 90 && dt_degrees_steep(1, -HUGE_VAL) == 90);
    CHECK(dt_degrees_steep(DBL_MAX, DBL_MAX) == 90 && dt_degrees_steep(0x1p60, 0) == 90);
    CHECK(dt_degrees_steep(0x1p-1074, 0) == 57 * 0x1p-1074);
    CHECK(dt_degrees_downhill(0x1p-1074, -1) == 0); /* 360 less nearly nothing */
    CHECK(dt_degrees_downhill(0x1p-60, -1) == 0 && dt_degrees_downhill(-0x1p-60, -1) > 0);
    CHECK(isnan(dt_degrees_downhill(0, 0)) && isnan(dt_degrees_downhill((double)NAN, 1)));
    CHECK(isnan(dt_degrees_steep(1, (double)NAN)));
}

/* Computed with 80 digits. */
TEST(degrees_have_the_same_bytes_on_all_machines)
{
    static const double known[][4] = {
        {0x1.7bcb8116f23eep-9, 0x1.8d4a70fc5ff4dp-2, 0x1.534acb52de611p+4, 0x1.68db161800935p+7},
        {-0x1.cd42d44a09da2p-6, 0x1.e053a2ef29388p-3, 0x1.a94d3d26d314bp+3, 0x1.5a4f63fdce1f9p+7},
        {0x1.1667d2c686bfap-2, -0x1.765db64ddee6ap+4, 0x1.5e362a0dbf84cp+6, 0x1.67559212f5c2bp+8},
        {0x1.74e415ea959c0p+1, -0x1.861b16f30474dp-7, 0x1.1c37f69fe5430p+6, 0x1.0e3bf0c87a068p+8},
        {-0x1.3c60d22784579p+5, -0x1.0ed44b0074510p-11, 0x1.6234c0c4410c5p+6, 0x1.67ff3bcff643bp+6},
        {-0x1.8c14794dca718p-4, -0x1.283f9d2825ba4p-4, 0x1.b8aad9df7d24ap+2, 0x1.a9a476ab4be07p+5},
        {-0x1.740eb3f0e3cd8p-5, 0x1.31f5b782c2d00p+1, 0x1.0d34a5bf080efp+6, 0x1.65d2ada669722p+7},
        {0x1.53e0c4ef901b8p-7, 0x1.0acff0a9e8d48p-3, 0x1.dc894ba5002f9p+2, 0x1.711aa3455d7f0p+7},
        {-0x1.3124272b63465p+1, -0x1.3d659cad7c272p-1, 0x1.0f9db83d14d9fp+6, 0x1.2db1bfc65cb8fp+6},
        {0x1.6491231435f44p-4, 0x1.e3e117da32992p-5, 0x1.805915e4f602ep+2, 0x1.d7af2a86bb321p+7},
        {-0x1.065487fcd00fep-10, 0x1.b0943a59dff44p-9, 0x1.94acab081c223p-3, 0x1.46437f3b7ff65p+7},
        {0x1.76f910302cbdep-10, 0x1.7ec9ded4be940p-8, 0x1.60cffef5986adp-2, 0x1.838574c6665d6p+7},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const double *k = known[i];
        CHECK_MSG(dt_degrees_steep(k[0], k[1]) == k[2] && dt_degrees_downhill(k[0], k[1]) == k[3],
                  "%a %a", dt_degrees_steep(k[0], k[1]), dt_degrees_downhill(k[0], k[1]));
    }
}
