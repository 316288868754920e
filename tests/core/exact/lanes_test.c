/* lanes_test.c - the operations on lanes. lanes.h has some of them in two forms, for x86 and for other machines; these are
 * tested on arm64, too (.ci/run). */
#include "core/exact/lanes.h"

#include <math.h>

#include "tests/test.h"

static const double values[] = {0, -0.0, 1, -1, 0x1p-1074, -0x1p-1074, 1.5, -HUGE_VAL, HUGE_VAL};
enum { N = sizeof values / sizeof *values };

TEST(lanes_bits_are_where_a_comparison_holds)
{
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            dt_lanes a = {values[i], values[k]}, b = {values[k], values[i]};
            int expected = (values[i] > values[k] ? 1 : 0) | (values[k] > values[i] ? 2 : 0);
            CHECK(dt_lanes_bits(a > b) == expected);
        }
}

TEST(lanes_bits_of_doubles_are_their_signs)
{
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            dt_lanes a = {values[i], values[k]};
            int expected = (signbit(values[i]) ? 1 : 0) | (signbit(values[k]) ? 2 : 0);
            CHECK(dt_lanes_bits((dt_lanes_holds)a) == expected);
        }
}

TEST(lanes_that_are_least_or_most_are_the_second_ones_beside_a_nan)
{
    dt_lanes a = {(double)NAN, 2}, b = {1, 3};
    dt_lanes least = dt_lanes_least(a, b), most = dt_lanes_most(a, b);
    CHECK(least[0] == 1 && least[1] == 2);
    CHECK(most[0] == 1 && most[1] == 3);
}
