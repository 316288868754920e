/* sight_test.c - visibility from a base edge, in two lanes, against the exact predicates. */
#include "core/divide/sight.h"

#include "core/exact/predicates.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static bool same(dt_lanes a, double first, double second)
{
    return a[0] == first && a[1] == second;
}

TEST(lanes_are_loaded_picked_and_compared_one_by_one)
{
    const double d[] = {0, -1.5, 2, 0x1p-1074, -0.0, 7};
    dt_lanes a = dt_lanes_load(d + 1), b = dt_lanes_load(d + 3);
    CHECK(same(a, -1.5, 2) && same(b, 0x1p-1074, -0.0));
    CHECK(same(dt_lanes_first(a, b), -1.5, 0x1p-1074) && same(dt_lanes_second(a, b), 2, -0.0));
    CHECK(same(dt_lanes_abs(a), 1.5, 2) && !signbit(dt_lanes_abs(b)[1]));
    for (int first = -1; first <= 1; first++)
        for (int second = -1; second <= 1; second++) {
            dt_lanes v = {first, second};
            CHECK(((first > 0) | (second > 0) << 1) == dt_lanes_bits(v > dt_lanes_both(0)));
            CHECK(((first < 0) | (second < 0) << 1) == dt_lanes_bits(v < dt_lanes_both(0)));
            dt_lanes most = dt_lanes_choose(v > dt_lanes_both(0), v, dt_lanes_both(0));
            CHECK(same(most, first > 0 ? first : 0, second > 0 ? second : 0));
        }
}

/* The four answers about a base 0-1 and candidates 2 and 3, with apexes 4 and 5. */
static bool answers_are_exact(const struct dt_point *p)
{
    double x0 = p[0].x, x1 = x0, y0 = p[0].y, y1 = y0;
    for (int i = 1; i < 6; i++) {
        x0 = fmin(x0, p[i].x), x1 = fmax(x1, p[i].x);
        y0 = fmin(y0, p[i].y), y1 = fmax(y1, p[i].y);
    }
    struct dt_merging w = dt_merging_within(&(struct dt_merging){.p = p}, fmax(x1 - x0, y1 - y0));
    struct sight_base at = sight_base_of(p[0], p[1]);
    struct sight c = sight_of(p, &at, 2, 3), x = sight_of(p, &at, 4, 5);
    int u = dt_orient2d(p[0], p[1], p[2]), v = dt_orient2d(p[0], p[1], p[3]);
    int above = (u > 0) | (v > 0) << 1, below = (u < 0) | (v < 0) << 1;
    bool ok = above == sight_side(&w, true, 0, 1, 2, 3, &c) &&
              below == sight_side(&w, false, 0, 1, 2, 3, &c);
    const uint32_t cs[] = {2, 3}, xs[] = {4, 5};
    int better = 0;
    for (int side = 0; side < 2; side++) /* asked only about candidates above the base */
        if ((above >> side & 1) && dt_incircle_perturbed(p[0], p[1], p[cs[side]], p[xs[side]]) > 0)
            better |= 1 << side;
    for (int close = 0; close < 2; close++) {
        struct sight_filter f = {.close = close};
        for (int sides = above; sides > 0; sides = (sides - 1) & above)
            ok = ok && (better & sides) == sight_better(&w, &f, 0, 1, sides, cs, xs, &c, &x);
        bool left = above == 1 || (above == 3 && dt_incircle_perturbed(p[0], p[1], p[2], p[3]) < 0);
        ok = ok && (above == 0 || left == sight_left_wins(&w, &f, 0, 1, above, 2, 3, &c));
        ok = ok && (!close || f.settled == 0);
    }
    return ok;
}

static bool distinct(const struct dt_point *p)
{
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < i; k++)
            if (p[i].x == p[k].x && p[i].y == p[k].y)
                return false;
    return true;
}

TEST(a_base_decides_like_the_exact_predicates_on_every_family)
{
    enum { N = 600 };
    static struct dt_point p[N];
    for (size_t f = 0; families[f].name != NULL; f++) {
        int wrong = 0, asked = 0;
        family_points(&families[f], p, N, 5);
        for (int i = 0; i < 2000; i++) {
            struct dt_point six[6];
            size_t near = test_below(N - 12);
            for (int k = 0; k < 6; k++) /* neighbours in the family's order half of the time */
                six[k] = p[i % 2 ? near + test_below(12) : test_below(N)];
            if (!distinct(six))
                continue;
            asked++;
            wrong += !answers_are_exact(six);
        }
        CHECK_MSG(wrong == 0, "%s: %d of %d wrong", families[f].name, wrong, asked);
    }
}

/* Six neighbours on a circle: the box of all of it leaves open what the close filter knows. */
TEST(the_wide_filter_learns_that_the_close_one_would_do)
{
    const double turn = 6.283185307179586;
    struct dt_point p[6];
    for (int i = 0; i < 6; i++) {
        static const int order[] = {2, 3, 1, 4, 0, 5};
        double a = turn * (0.73 + 1e-6 * (order[i] - 2.5));
        p[i] = (struct dt_point){cos(a), sin(a)};
    }
    struct dt_merging w = dt_merging_within(&(struct dt_merging){.p = p}, 2);
    struct sight_base at = sight_base_of(p[0], p[1]);
    struct sight c = sight_of(p, &at, 2, 3);
    struct sight_filter wide = {.close = false}, close = {.close = true};
    bool expected = dt_incircle_perturbed(p[0], p[1], p[2], p[3]) < 0;
    CHECK(expected == sight_left_wins(&w, &wide, 0, 1, SIGHT_BOTH, 2, 3, &c));
    CHECK(wide.settled == 1);
    CHECK(expected == sight_left_wins(&w, &close, 0, 1, SIGHT_BOTH, 2, 3, &c));
    CHECK(close.settled == 0);
}

TEST(a_tie_on_a_lattice_settles_nothing)
{
    const struct dt_point p[] = {{0, 0}, {3, 0}, {0, 2}, {3, 2}};
    struct dt_merging w = dt_merging_within(&(struct dt_merging){.p = p}, 3);
    struct sight_base at = sight_base_of(p[0], p[1]);
    struct sight c = sight_of(p, &at, 2, 3);
    struct sight_filter f = {.close = false};
    bool expected = dt_incircle_perturbed(p[0], p[1], p[2], p[3]) < 0;
    CHECK(expected == sight_left_wins(&w, &f, 0, 1, SIGHT_BOTH, 2, 3, &c));
    CHECK(f.settled == 0);
}
