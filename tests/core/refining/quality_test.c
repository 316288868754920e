/* quality_test.c - whether triangles are as wanted, beside integers; and angles in degrees. */
#include <math.h>

#include "core/refining/quality.h"
#include "tests/test.h"

static long below(long n)
{
    return (long)(test_random() % (uint64_t)n);
}

static struct dt_wanted wanted(double angle, double area, double length)
{
    struct dt_quality q = {.angle = angle, .area = area, .length = length};
    struct dt_wanted w;
    dt_wanted_of(&q, &w);
    return w;
}

TEST(cosines_are_the_nearest_doubles)
{
    CHECK(wanted(45, 0, 0).cosine2 == 0.5 && wanted(30, 0, 0).cosine2 == 0.75);
    CHECK(wanted(0, 0, 0).cosine2 > 1);
    /* Of 80 digits. */
    CHECK(wanted(20.7, 0, 0).cosine2 == 0.8750555348152298);
    CHECK(wanted(25, 0, 0).cosine2 == 0.8213938048432696);
    CHECK(wanted(33, 0, 0).cosine2 == 0.7033683215379001);
    CHECK(wanted(59.9, 0, 0).cosine2 == 0.25151301948622234);
    CHECK(wanted(1e-9, 0, 0).cosine2 == 1);
}

/* Whether the angle at r is below that whose squared cosine is c / 4. */
static bool is_sharp(const long p[2], const long q[2], const long r[2], long c)
{
    __int128 ux = p[0] - r[0], uy = p[1] - r[1], vx = q[0] - r[0], vy = q[1] - r[1];
    __int128 dot = ux * vx + uy * vy;
    return dot > 0 && 4 * dot * dot > c * (ux * ux + uy * uy) * (vx * vx + vy * vy);
}

static __int128 square(const long p[2], const long q[2])
{
    __int128 x = p[0] - q[0], y = p[1] - q[1];
    return x * x + y * y;
}

TEST(limits_that_triangles_of_integers_just_meet_are_met)
{
    for (int i = 0; i < 200000; i++) {
        const long size = i % 3 == 0 ? 4 : i % 3 == 1 ? 1 << 20 : 1 << 29;
        long v[3][2], c = i % 7 % 3 + 1;
        struct dt_point p[3];
        for (int k = 0; k < 3; k++) {
            v[k][0] = below(size), v[k][1] = below(size);
            p[k] = (struct dt_point){(double)v[k][0] * 0x1p-30, (double)v[k][1] * 0x1p-30};
        }
        if (i % 5 == 0) { /* half of a square: 45 degrees, whatever it is turned by */
            long x = v[1][0] - v[0][0], y = v[1][1] - v[0][1];
            v[2][0] = v[0][0] - y, v[2][1] = v[0][1] + x;
            p[2] = (struct dt_point){(double)v[2][0] * 0x1p-30, (double)v[2][1] * 0x1p-30};
            c = 2;
        }
        __int128 cross = (__int128)(v[1][0] - v[0][0]) * (v[2][1] - v[0][1]) -
                         (__int128)(v[1][1] - v[0][1]) * (v[2][0] - v[0][0]);
        if (cross <= 0 || (i % 4 == 0 && (__int128)(double)cross != cross))
            continue;
        long area = i % 4 == 0 ? (long)cross : (long)(double)(below(size * size) + 1),
             length = below(size) + 1;
        struct dt_wanted w = wanted(c == 1   ? 59.999999999999993
                                    : c == 2 ? 45
                                             : 30,
                                    (double)area * 0x1p-61, (double)length * 0x1p-30);
        w.cosine2 = (double)c / 4;
        struct dt_shape s;
        dt_shape_of(p[0], p[1], p[2], &s);
        bool sharp = is_sharp(v[0], v[1], v[2], c) || is_sharp(v[1], v[2], v[0], c) ||
                     is_sharp(v[2], v[0], v[1], c);
        __int128 most = (__int128)length * length;
        bool is_long =
            square(v[0], v[1]) > most || square(v[1], v[2]) > most || square(v[2], v[0]) > most;
        unsigned want =
            (sharp ? DT_SHARP : 0) | (cross > area ? DT_LARGE : 0) | (is_long ? DT_LONG : 0);
        CHECK_MSG(dt_shape_breaks(&w, &s) == want, "%d: %u, not %u", i, dt_shape_breaks(&w, &s),
                  want);
    }
}

TEST(limits_may_be_as_large_and_as_small_as_coordinates)
{
    const double huge = 0x1p201, tiny = 0x1p-142;
    struct dt_point p[] = {{0, 0}, {huge, 0}, {0, huge}}, q[] = {{0, 0}, {tiny, 0}, {0, tiny}};
    struct dt_shape s;
    struct dt_wanted w = wanted(45, huge * huge / 2, huge * 1.5);
    dt_shape_of(p[0], p[1], p[2], &s);
    CHECK(dt_shape_breaks(&w, &s) == 0);
    w = wanted(45.1, huge * huge / 2 * (1 - 0x1p-53), huge * 1.4);
    CHECK(dt_shape_breaks(&w, &s) == (DT_SHARP | DT_LARGE | DT_LONG));
    w = wanted(45, tiny * tiny / 2, tiny * 1.5);
    dt_shape_of(q[0], q[1], q[2], &s);
    CHECK(dt_shape_breaks(&w, &s) == 0);
    w = wanted(45.1, tiny * tiny / 2 * (1 - 0x1p-53), tiny * 1.4);
    CHECK(dt_shape_breaks(&w, &s) == (DT_SHARP | DT_LARGE | DT_LONG));
}
