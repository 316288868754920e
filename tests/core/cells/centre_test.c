/* centre_test.c - circumcentres are exact places, each coordinate rounded once to nearest. */
#include "core/cells/centre.h"
#include "core/exact/predicates.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

TEST(all_triangles_of_points_on_a_circle_have_the_same_centre)
{
    static const double at[8][2] = {{25, 0}, {24, 7}, {20, 15}, {15, 20},
                                    {7, 24}, {0, 25}, {-7, 24}, {-15, -20}};
    static const double scale[] = {1, 0x1p-130, 0x1p190}, from[] = {0, 1.0 / 3, 12345678.9, 0x1p40};
    for (int s = 0; s < 3; s++) {
        for (int f = 0; f < 4; f++) {
            struct dt_point p[8], first = {0, 0};
            bool exact = true;
            for (int i = 0; i < 8; i++) {
                p[i] = (struct dt_point){(at[i][0] + from[f]) * scale[s], at[i][1] * scale[s]};
                exact &= p[i].x / scale[s] - from[f] == at[i][0];
            }
            for (int a = 0; a < 8; a++)
                for (int b = 0; b < 8; b++)
                    for (int c = 0; c < 8; c++) {
                        if (a == b || b == c || c == a || !exact)
                            continue;
                        struct dt_point q = dt_centre(p[a], p[b], p[c]);
                        if (a == 0 && b == 1 && c == 2)
                            first = q;
                        CHECK(f == 1 || (q.x == first.x && q.y == first.y && q.y == 0));
                    }
        }
    }
}

TEST(a_centre_half_way_between_two_doubles_is_the_even_one)
{
    /* The centres' x is 2^52 + 0.5, 2^52 + 1.5 and, with a point far away, a little more. */
    double big = 0x1p52;
    struct dt_point a = {big, 0}, b = {big + 1, 0}, c = {big, 10}, d = {big + 2, 0};
    CHECK(dt_centre(a, b, c).x == big);
    CHECK(dt_centre(b, d, (struct dt_point){big + 1, 4}).x == big + 2);
    CHECK(dt_centre(a, b, c).y == 5);
    CHECK(dt_bisector_x(a, b, 7) == big && dt_bisector_x(b, d, -0x1p200) == big + 2);
    CHECK(dt_bisector_x((struct dt_point){big, 0}, (struct dt_point){big + 1, 0x1p-142}, 0) ==
          big + 1);
}

__extension__ typedef __int128 wide;

/* Whether v is from + n / d rounded to nearest, for 1 <= |v| < 2^31 and |d| < 2^43. */
static bool is_rounded(double v, int64_t from, wide n, wide d)
{
    int e;
    frexp(v, &e); /* |v| < 2^e: half a unit is 2^(e - 54) */
    wide unit = (wide)1 << (54 - e);
    wide scaled = (wide)ldexp(v, 54 - e), error = (scaled - from * unit) * d - n * unit;
    error = error < 0 ? -error : error;
    return error < (d < 0 ? -d : d) || (error == (d < 0 ? -d : d) && scaled / 2 % 2 == 0);
}

TEST(centres_of_points_far_from_the_origin_are_rounded_to_nearest)
{
    int checked = 0;
    for (int i = 0; i < 100000; i++) {
        int64_t base = (int64_t)(test_random() % (1u << 30)), v[4];
        unsigned spread = 1 + (unsigned)(test_random() % 18);
        for (int k = 0; k < 4; k++)
            v[k] = (int64_t)(test_random() % (2u << spread)) - (1 << spread);
        struct dt_point a = {(double)base, (double)-base};
        struct dt_point b = {(double)(base + v[0]), (double)(v[1] - base)};
        struct dt_point c = {(double)(base + v[2]), (double)(v[3] - base)};
        int64_t bb = v[0] * v[0] + v[1] * v[1], cc = v[2] * v[2] + v[3] * v[3];
        int64_t twice = 2 * (v[0] * v[3] - v[1] * v[2]);
        if (twice == 0)
            continue;
        struct dt_point p = dt_centre(a, b, c);
        if (fabs(p.x) >= 1 && fabs(p.x) < 0x1p31 && ++checked > 0)
            CHECK(is_rounded(p.x, base, (wide)bb * v[3] - (wide)cc * v[1], twice));
        if (fabs(p.y) >= 1 && fabs(p.y) < 0x1p31 && ++checked > 0)
            CHECK(is_rounded(p.y, -base, (wide)cc * v[0] - (wide)bb * v[2], twice));
    }
    CHECK(checked > 100000);
}

TEST(centres_do_not_depend_on_the_order_of_the_corners)
{
    for (int i = 0; i < 5000; i++) {
        struct dt_point p[3];
        int spread = (int)(test_random() % 60), flat = (int)(test_random() % 80);
        for (int k = 0; k < 3; k++) {
            p[k].x = ldexp(test_uniform() - 0.5, (int)(test_random() % (unsigned)(spread + 1)));
            p[k].y = p[k].x / 3 + ldexp(test_uniform(), -flat);
        }
        if (dt_orient2d(p[0], p[1], p[2]) == 0)
            continue;
        struct dt_point q = dt_centre(p[0], p[1], p[2]);
        for (int k = 0; k < 3; k++) {
            struct dt_point r = dt_centre(p[(k + 1) % 3], p[k], p[(k + 2) % 3]);
            CHECK(q.x == r.x && q.y == r.y);
        }
    }
}
