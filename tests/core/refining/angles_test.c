/* angles_test.c - least and largest angles, in degrees. */
#include <math.h>

#include "core/refining/angles.h"
#include "tests/test.h"

static double degrees(double hi)
{
    return dt_degrees((struct dt_double2){hi, 0});
}

static struct dt_angles angles_of(struct dt_point a, struct dt_point b, struct dt_point c)
{
    struct dt_shape s;
    struct dt_angles angles = {0};
    dt_shape_of(a, b, c, &s);
    dt_angles_add(&angles, &s);
    return angles;
}

TEST(degrees_are_those_of_the_library)
{
    CHECK(degrees(1) == 45 && degrees(-1) == 135 && degrees(0) == 90);
    CHECK(degrees(2) == 26.565051177077989 && degrees(-2) == 153.43494882292201);
    CHECK(degrees(0x1p700) == 0x1p-700 * 57.295779513082323 && degrees(-0x1p700) == 180);
    for (int i = 0; i < 100000; i++) {
        double c =
            ldexp((double)(test_random() >> 11) - 0x1p52, -52 + (int)(test_random() % 40) - 20);
        double want = (double)(atan2l(1, (long double)c) * (180 / 3.14159265358979323846264338L));
        CHECK(fabs(degrees(c) - want) <= want * 0x1p-52);
    }
}

TEST(a_right_triangle_has_an_angle_of_90_degrees_at_any_size)
{
    const double size[] = {0x1p-142, 1, 3e60};
    for (int k = 0; k < 3; k++) {
        struct dt_point a = {0, 0}, b = {size[k], 0}, c = {0, size[k]};
        struct dt_angles angles = angles_of(a, b, c);
        CHECK(dt_degrees(angles.least) == 45 && dt_degrees(angles.largest) == 90);
    }
}

/* With N = 2^52, twice the area is 1 + b - a: the difference of two products of about N^2 with factors as N - a, of which double words
 * keep too few bits. */
TEST(a_triangle_that_is_nearly_flat_has_the_angles_of_exact_arithmetic)
{
    const double n = 0x1p52, a = 0.3, b = 0.7;
    const double least = (1 + b - a) * 0x1p-105 * 57.295779513082323;
    struct dt_point r = {a, b}, p = {n + 1, n}, q = {n, n - 1};
    struct dt_angles angles = angles_of(r, q, p);
    CHECK(fabs(dt_degrees(angles.least) - least) < least * 1e-12);
    CHECK(dt_degrees(angles.largest) == 180);
}

/* The long edges of the second triangle have equal lengths in doubles, and angles of 1 and 179 degrees at their ends. */
TEST(the_largest_angle_of_a_needle_is_found_at_either_end)
{
    const struct dt_point before[] = {{0, 0}, {0x1p80, 0}, {0, 1}};
    for (int k = 0; k < 6; k++) {
        double side = k < 3 ? -1 : 1;
        const struct dt_point p[] = {{0, 0}, {0x1p60, 0}, {side, 0x1p-6}};
        struct dt_angles angles = angles_of(before[0], before[1], before[2]);
        struct dt_shape s;
        dt_shape_of(p[k % 3], p[(k + 1) % 3], p[(k + 2) % 3], &s);
        dt_angles_add(&angles, &s);
        CHECK(fabs(dt_degrees(angles.largest) - 179.104826) < 1e-6);
    }
}

TEST(extremes_are_those_of_the_triangles_whatever_their_order)
{
    for (int round = 0; round < 2000; round++) {
        enum { N = 20 };
        struct dt_shape s[N];
        struct dt_angles up = {0}, down = {0};
        double least = 180, largest = 0;
        for (int i = 0; i < N; i++) {
            struct dt_point p[3];
            double thin = i % 3 == 0 ? 0x1p-30 : 1;
            for (int k = 0; k < 3; k++)
                p[k] = (struct dt_point){(double)test_below(1000), (double)test_below(1000) * thin};
            p[1].x += 1000, p[2].y += 1000 * thin;
            dt_shape_of(p[0], p[1], p[2], &s[i]);
            if (s[i].cross <= 0) {
                i--;
                continue;
            }
            struct dt_angles one = angles_of(p[1], p[2], p[0]);
            least = fmin(least, dt_degrees(one.least));
            largest = fmax(largest, dt_degrees(one.largest));
        }
        for (int i = 0; i < N; i++) {
            dt_angles_add(&up, &s[i]);
            dt_angles_add(&down, &s[N - 1 - i]);
        }
        CHECK(dt_degrees(up.least) == least && dt_degrees(down.least) == least);
        CHECK(dt_degrees(up.largest) == largest && dt_degrees(down.largest) == largest);
    }
}
