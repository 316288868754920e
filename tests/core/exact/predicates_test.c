/* predicates_test.c - the predicates against schoolbook big integers, on inputs chosen to defeat
 * the cheap stages. */
#include "core/exact/predicates.h"

#include "tests/oracle/exact.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <math.h>

static struct dt_point uniform(void)
{
    return (struct dt_point){test_uniform(), test_uniform()};
}

static struct dt_point lattice(void)
{
    return (struct dt_point){test_below(6), test_below(6)};
}

static struct dt_point
tenths(void) /* rounded, so neither collinear nor cocircular where it seems so */
{
    return (struct dt_point){0.1 * test_below(5) + 3.3, 0.1 * test_below(5) + 7.7};
}

static struct dt_point
ulps(void) /* neighbours of (1, 1), on either side of the change of exponent */
{
    return (struct dt_point){1 + ((int)test_below(9) - 4) * 0x1p-53,
                             1 + ((int)test_below(9) - 4) * 0x1p-53};
}

static struct dt_point circle(void) /* 12 lattice points of radius 5 */
{
    static const double x[12] = {5, 4, 3, 0, -3, -4, -5, -4, -3, 0, 3, 4};
    uint32_t i = test_below(12);
    return (struct dt_point){x[i], x[(i + 9) % 12]};
}

static struct dt_point integer_circle(void) /* too large for doubles, not for 128-bit integers */
{
    struct dt_point p = circle();
    return (struct dt_point){p.x * 99999989, p.y * 99999989};
}

static struct dt_point large_circle(void) /* too large for those */
{
    struct dt_point p = circle();
    return (struct dt_point){p.x * 999999999989, p.y * 999999999989};
}

static struct dt_point far_circle(void)
{
    struct dt_point p = circle();
    return (struct dt_point){p.x * 0x1p-20 + 1e8, p.y * 0x1p-20 - 3e7};
}

static struct dt_point wobbly_circle(void) /* the circle, some coordinates off by an ulp */
{
    struct dt_point p = circle();
    if (p.x != 0 && test_below(3) == 0)
        p.x = nextafter(p.x, 9);
    if (p.y != 0 && test_below(3) == 0)
        p.y = nextafter(p.y, -9);
    return p;
}

static struct dt_point near_line(void)
{
    double t = test_uniform();
    return (struct dt_point){t, 0.3 * t};
}

static struct dt_point smallest(void)
{
    struct dt_point p = {test_below(4) * 0x1p-142, test_below(4) * 0x1p-142};
    if (p.x != 0 && test_below(2))
        p.x = nextafter(p.x, 1);
    if (p.y != 0 && test_below(2))
        p.y = -nextafter(p.y, 1);
    return p;
}

static struct dt_point largest(void)
{
    struct dt_point p = {nextafter(0x1p201, 0) * (1 - (int)test_below(3)),
                         0x1p201 * (1 - (int)test_below(3))};
    if (test_below(2))
        p.y = nextafter(p.y, 0) + 0x1p100;
    return p;
}

static struct dt_point mixed(void) /* any exponent at all */
{
    double x = ldexp(0.5 + test_uniform() / 2, (int)test_below(343) - 141);
    double y = ldexp(0.5 + test_uniform() / 2, (int)test_below(343) - 141);
    return (struct dt_point){test_below(2) ? x : -x, test_below(2) ? y : -y};
}

static struct dt_point mixed_ends(void) /* huge and tiny in one set: bignums at their longest */
{
    switch (test_below(3)) {
    case 0:
        return smallest();
    case 1:
        return largest();
    default:
        return uniform();
    }
}

static struct dt_point hyperbola(void) /* near both axes, and near each other on one */
{
    double x = ldexp(1 + (test_below(2) ? test_uniform() : test_below(3) * 0x1p-52),
                     (int)(test_below(2) ? test_below(280) : test_below(4) * 60) - 141);
    x = test_below(2) ? x : -x;
    return (struct dt_point){x, 1 / x};
}

static struct dt_point far_apart_pairs(void) /* some closer to each other than any word is long */
{
    static const double at[] = {0x1p120, -0x1p60, 0, 1};
    double size = ldexp(1, -(int)test_below(8) * 16);
    return (struct dt_point){at[test_below(4)] + test_below(9) * size,
                             at[test_below(4)] + test_below(9) * size};
}

static struct dt_point
ray(void) /* on a line through the origin or an ulp beside it, on any scale */
{
    double size = ldexp(1, 20 * (int)test_below(15) - 138);
    struct dt_point p = {3 * size, 5 * size};
    if (test_below(3) == 0)
        p.y = nextafter(p.y, test_below(2) ? 0 : HUGE_VAL);
    return p;
}

static struct dt_point (*const kinds[])(void) = {
    uniform,    lattice,         tenths,    ulps,     circle,  integer_circle, large_circle,
    far_circle, wobbly_circle,   near_line, smallest, largest, mixed,          mixed_ends,
    hyperbola,  far_apart_pairs, ray};
enum { FAMILIES = sizeof kinds / sizeof *kinds, ROUNDS = 600 };

static bool distinct(const struct dt_point *p, int n)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            if (dt_compare_xy(p[i], p[j]) == 0)
                return false;
    return true;
}

/* Every family's points are within what the predicates promise to handle. */
static struct dt_point draw(int family)
{
    struct dt_point p = kinds[family]();
    for (int k = 0; k < 2; k++) {
        double v = fabs(k ? p.y : p.x);
        CHECK(v == 0 || (v >= 0x1p-142 && v <= 0x1p201));
    }
    return p;
}

TEST(orient2d_equals_exact_arithmetic_and_flips_under_swaps)
{
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point a = draw(f), b = draw(f), c = draw(f);
            int want = exact_orient2d(a, b, c);
            CHECK_MSG(dt_orient2d(a, b, c) == want, "family %d", f);
            CHECK(dt_orient2d_exact(a, b, c) == want);
            CHECK(dt_orient2d(b, c, a) == want && dt_orient2d(c, a, b) == want);
            CHECK(dt_orient2d(b, a, c) == -want && dt_orient2d(a, c, b) == -want &&
                  dt_orient2d(c, b, a) == -want);
        }
}

TEST(orient2d_distinguishes_the_sides_of_a_line_by_one_ulp)
{
    struct dt_point a = {0.5, 0.5}, b = {12, 12}, c = {24, 24};
    CHECK(dt_orient2d(a, b, c) == 0);
    c.y = nextafter(24, 25);
    CHECK(dt_orient2d(a, b, c) == 1);
    c.y = nextafter(24, 0);
    CHECK(dt_orient2d(a, b, c) == -1);
}

TEST(incircle_equals_exact_arithmetic_in_every_order)
{
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point a = draw(f), b = draw(f), c = draw(f), d = draw(f);
            int want = exact_incircle(a, b, c, d);
            CHECK_MSG(dt_incircle(a, b, c, d) == want, "family %d", f);
            CHECK(dt_incircle_exact(a, b, c, d) == want);
            CHECK(dt_incircle(b, c, a, d) == want && dt_incircle(c, a, b, d) == want);
            CHECK(dt_incircle(b, a, c, d) == -want && dt_incircle(a, b, d, c) == -want);
            CHECK(dt_incircle(d, b, c, a) == -want && dt_incircle(d, a, b, c) == -want);
        }
}

/* Each stage is right or does not decide, and the last one is right. Each stage must be reached; the number of its
 * decisions does not matter. */
TEST(every_stage_of_orient2d_is_right_or_in_doubt)
{
    int decided = 0, last = 0;
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point a = draw(f), b = draw(f), c = draw(f);
            struct dt_near_corner k = dt_near_corner_of(a, b, c);
            int want = exact_orient2d(a, b, c), d = dt_orient2d_double2(&k);
            CHECK_MSG(d == 0 || d == want, "family %d", f);
            CHECK_MSG(dt_orient2d_big(&k) == want, "family %d", f);
            decided += d != 0, last += d == 0 && want != 0;
        }
    CHECK_MSG(decided > 1000 && last > 10, "%d %d", decided, last);
}

/* r and q lie on a line through the origin. p lies near the origin and, as far as its last bits allow, on that
 * line. So the difference of the products lies at the end of double words. */
TEST(orient2d_in_double_words_is_in_doubt_where_its_last_bits_decide)
{
    int doubt = 0, decided = 0;
    for (int i = 0; i < 20000; i++) {
        struct dt_point r = {1 + test_uniform(), 1 + test_uniform()};
        struct dt_point q = {r.x * 4, r.y * 4};
        double share = ldexp(1 + test_uniform(), -40 - (int)test_below(25));
        struct dt_point p = {r.x * share, r.y * share};
        struct dt_near_corner k = dt_near_corner_of(p, q, r);
        int want = exact_orient2d(k.p, k.q, k.s), got = dt_orient2d_double2(&k);
        CHECK(got == 0 || got == want);
        doubt += got == 0 && want != 0;
        decided += got != 0;
    }
    CHECK_MSG(doubt > 1000 && decided > 1000, "%d in doubt, %d decided", doubt, decided);
}

TEST(every_stage_of_incircle_is_right_or_in_doubt)
{
    int decided = 0, last = 0;
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point a = draw(f), b = draw(f), c = draw(f), e = draw(f);
            struct dt_near_base k = dt_near_base_of(a, b, c, e);
            int want = exact_incircle(a, b, c, e), d = dt_incircle_double2(&k);
            CHECK_MSG(d == 0 || d == want, "family %d", f);
            CHECK_MSG(dt_incircle_big(&k) == want, "family %d", f);
            decided += d != 0, last += d == 0 && want != 0;
        }
    CHECK_MSG(decided > 1000 && last > 10, "%d %d", decided, last);
}

/* Two pairs, 2^100 and more apart: from a point of the other pair all is lost to rounding, even in double
 * words. */
TEST(points_near_each_other_and_far_from_others_are_seen_from_nearby)
{
    for (int i = 0; i < 2000; i++) {
        double far = ldexp(1 + test_uniform(), 100 + (int)test_below(40));
        struct dt_point p[4] = {uniform(), uniform(), {far, far * test_uniform()}, {0, 0}};
        p[3] = (struct dt_point){p[2].x * (1 + test_uniform()), -p[2].y};
        for (int turn = 0; turn < 4; turn++) {
            struct dt_point a = p[turn], b = p[(turn + 1) % 4], c = p[(turn + 2) % 4],
                            d = p[(turn + 3) % 4];
            struct dt_near_base k = dt_near_base_of(a, b, c, d);
            CHECK(dt_incircle_double2(&k) == exact_incircle(a, b, c, d));
            struct dt_near_corner corner = dt_near_corner_of(a, b, c);
            CHECK(dt_orient2d_double2(&corner) == exact_orient2d(a, b, c));
        }
    }
}

TEST(perturbed_incircle_never_ties_and_obeys_the_rule)
{
    int ties = 0;
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point p[4] = {draw(f), draw(f), draw(f), draw(f)};
            if (!distinct(p, 4) || exact_orient2d(p[0], p[1], p[2]) <= 0)
                continue;
            int got = dt_incircle_perturbed(p[0], p[1], p[2], p[3]);
            CHECK(got != 0);
            CHECK_MSG(got == exact_incircle_perturbed(p[0], p[1], p[2], p[3]), "family %d", f);
            CHECK(got == dt_incircle_perturbed(p[1], p[2], p[0], p[3]));
            ties += exact_incircle(p[0], p[1], p[2], p[3]) == 0;
        }
    CHECK(ties > 200);
}

/* Integers of 46 and of 53 bits: one unit off the circle is beyond double words. */
TEST(incircle_distinguishes_ties_of_large_integers_from_one_unit)
{
    struct dt_point p[2000];
    unsigned ties = 0;
    family_points(family_find("circle_exact"), p, 2000, 1);
    for (unsigned round = 0; round < 3000; round++) {
        struct dt_point q[4];
        double scale = round % 2 == 0 ? 1 : 128; /* differences that are no doubles */
        for (unsigned i = 0; i < 4; i++) {
            q[i] = p[test_below(2000)];
            q[i] = (struct dt_point){q[i].x * scale, q[i].y * scale};
            q[i].x += (double)test_below(3) * (test_below(8) == 0) - (test_below(8) == 0);
            q[i].y *= test_below(16) == 0 ? 1 + 0x1p-40 : 1;
        }
        int want = exact_incircle(q[0], q[1], q[2], q[3]);
        CHECK(dt_incircle(q[0], q[1], q[2], q[3]) == want);
        ties += want == 0;
    }
    CHECK(ties > 300 && ties < 2900);
}

/* By the rule the greatest corner is lifted off the others' circle, so the diagonal avoids it. */
TEST(the_tie_of_a_square_is_cut_off_the_greatest_corner)
{
    struct dt_point a = {0, 0}, b = {1, 0}, c = {1, 1}, d = {0, 1};
    CHECK(dt_incircle(a, b, d, c) == 0);
    CHECK(dt_incircle_perturbed(a, b, d, c) < 0); /* triangle a b d stays, so the diagonal is b-d */
    CHECK(dt_incircle_perturbed(a, b, c, d) > 0); /* and a b c does not */
    CHECK(dt_incircle_perturbed(b, c, d, a) < 0);
    CHECK(dt_incircle_perturbed(c, d, a, b) > 0);
}

TEST(distances_compare_exactly)
{
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point q = draw(f), a = draw(f), b = draw(f);
            int want = exact_compare_distance(q, a, b);
            CHECK_MSG(dt_compare_distance(q, a, b) == want, "family %d", f);
            CHECK(dt_compare_distance(q, b, a) == -want);
        }
}

TEST(a_radius_compares_exactly)
{
    for (int f = 0; f < FAMILIES; f++)
        for (int i = 0; i < ROUNDS; i++) {
            struct dt_point a = draw(f), b = draw(f);
            double r = fabs(draw(f).x), d = hypot(a.x - b.x, a.y - b.y);
            CHECK_MSG(dt_compare_radius(a, b, r) == exact_compare_radius(a, b, r), "family %d", f);
            if (d >= 0x1p-142 && d <= 0x1p201)
                CHECK(dt_compare_radius(a, b, d) == exact_compare_radius(a, b, d));
        }
    struct dt_point o = {0, 0}, p = {3, 4};
    CHECK(dt_compare_radius(o, p, 5) == 0 && dt_compare_radius(o, p, nextafter(5, 0)) > 0);
    CHECK(dt_compare_radius(p, p, 0) == 0 && dt_compare_radius(o, p, 0) > 0);
}

TEST(points_compare_lexicographically)
{
    struct dt_point a = {0, 1}, b = {0, 2}, c = {1, 0}, minus = {-0.0, 1};
    CHECK(dt_compare_xy(a, b) < 0 && dt_compare_xy(b, a) > 0 && dt_compare_xy(b, c) < 0);
    CHECK(dt_compare_xy(a, a) == 0 && dt_compare_xy(a, minus) == 0);
}
