/* outside_test.c - values outside the hull equal the values of its nearest place. */
#include "core/delaunay_constraints.h"
#include "core/exact/bignum.h"
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

/* The nearest place between two points: the square of its distance, as a quotient, and 0 at a to 1 at b. Only `along`
 * is rounded. */
struct foot {
    struct dt_big over, under;
    double along;
};

struct vector {
    struct dt_big x, y;
};

static struct vector vector(struct dt_point a, struct dt_point b)
{
    struct vector v;
    v.x = dt_big_difference(b.x, a.x);
    v.y = dt_big_difference(b.y, a.y);
    return v;
}

/* u.x v.x + sign u.y v.y */
static struct dt_big products(struct dt_big ux, struct dt_big vx, int sign, struct dt_big uy,
                              struct dt_big vy)
{
    ux = dt_big_multiply(ux, vx);
    uy = dt_big_multiply(uy, vy);
    return sign > 0 ? dt_big_add(ux, uy) : dt_big_subtract(ux, uy);
}

static struct dt_big dot(struct vector u, struct vector v)
{
    return products(u.x, v.x, 1, u.y, v.y);
}

static struct foot foot_between(struct dt_point a, struct dt_point b, struct dt_point q)
{
    struct vector e = vector(a, b), d = vector(a, q), back = vector(b, q);
    struct dt_big along = dot(d, e), past = dot(back, e);
    struct foot f = {.along = past.sign >= 0};
    f.under = dt_big_of(1);
    if (along.sign <= 0 || past.sign >= 0) {
        f.along = along.sign > 0;
        f.over = along.sign <= 0 ? dot(d, d) : dot(back, back);
        return f;
    }
    struct dt_big across = products(d.x, e.y, -1, d.y, e.x);
    f.under = dot(e, e);
    f.over = dt_big_multiply(across, across);
    along = dt_big_divide(along, f.under);
    f.along = dt_big_to_double(along);
    return f;
}

static bool is_nearer(struct foot f, struct foot g)
{
    f.over = dt_big_multiply(f.over, g.under);
    g.over = dt_big_multiply(g.over, f.under);
    return dt_big_compare(f.over, g.over) < 0;
}

/* The value at the nearest place of the hull. */
static double brute_value(const struct pair *pair, const struct dt_ids *hull, struct dt_point q)
{
    struct foot best = {.along = 0};
    double value = (double)NAN;
    for (size_t i = 0; i < hull->n; i++) {
        bool last = i + 1 == hull->n && (pair->b->line != NULL || i == 0);
        uint32_t a = hull->v[i], b = last ? a : hull->v[(i + 1) % hull->n];
        struct foot f = foot_between(pair->b->p[a], pair->b->p[b], q);
        if (i > 0 && !is_nearer(f, best))
            continue;
        best = f;
        value = value_of(a) + f.along * (value_of(b) - value_of(a));
    }
    return value;
}

static void check_outside(const struct pair *pair, const struct dt_ids *hull, struct dt_point q)
{
    struct dt_surface s = surface_of(DT_LINEAR);
    struct dt_location at;
    double plain = value_at(pair->t, &s, q);
    s.beyond = true;
    double got = value_at(pair->t, &s, q);
    CHECK(dt_locate(pair->t, q, &at) == DT_OK);
    if (at.where != DT_OUTSIDE || hull->n == 0) {
        check_same(got, plain, q);
        return;
    }
    double want = brute_value(pair, hull, q);
    CHECK_MSG(fabs(got - want) <= DT_WEIGHTS_ERROR + 0x1p-41,
              "%.17g instead of %.17g at %.17g %.17g", got, want, q.x, q.y);
    for (int how = 1; how < METHODS; how++) { /* on the hull, means are linear */
        s.how = all_methods[how];
        if (s.how != DT_CLOSEST)
            check_same(value_at(pair->t, &s, q), got, q);
    }
}

/* Places around the set, also far away. */
static struct dt_point around(const struct pair *pair)
{
    struct dt_point p = random_place(pair->b), q = random_place(pair->b);
    double far = ldexp(test_uniform(), (int)test_below(12));
    struct dt_point at = {p.x + (p.x - q.x) * far, p.y + (p.y - q.y) * far};
    return dt_coordinate_ok(at.x) && dt_coordinate_ok(at.y) ? at : p;
}

static void check_family(const struct pair *pair)
{
    struct dt_ids hull = {0};
    brute_table(pair->b, DT_HULL, false, &hull);
    make_values();
    for (int i = 0; i < 40; i++)
        check_outside(pair, &hull, around(pair));
    free(hull.v);
}

TEST_TIMEOUT(values_outside_are_those_of_the_nearest_place_on_every_family, 120)
{
    for_each_pair(check_family);
}

/* Beside a square the foot is known exactly. */
TEST(values_outside_a_square_are_exact)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 0}};
    static const double z[] = {0, 8, 4, 1, 2};
    struct dt *t = set_with(p, z, 5);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    static const struct {
        struct dt_point q;
        double want;
    } cases[] = {{{1, -1}, 1},         {{3, -0x1p200}, 5}, {{2, -3}, 2}, {{-1, -1}, 0},
                 {{0x1p200, 9}, 4},    {{5, 2}, 6},        {{4, 5}, 4},  {{-2, 2}, 0.5},
                 {{-0x1p200, 3}, .75}, {{1.5, 1e9}, 2.125}};
    s.beyond = true;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_same(value_at(t, &s, cases[i].q), cases[i].want, cases[i].q);
    dt_surface_end(&s);
    dt_free(t);
}

TEST(values_outside_sets_without_triangles)
{
    static const struct dt_point p[] = {{0, 0}, {2, 2}, {6, 6}};
    static const double z[] = {1, 3, 11};
    for (uint32_t n = 0; n <= 3; n++) {
        struct dt *t = set_with(p, z, n);
        struct dt_surface s = surface_in(t, DT_LINEAR);
        s.beyond = true;
        check_same(value_at(t, &s, (struct dt_point){-1, -5}), n > 0 ? 1 : (double)NAN, p[0]);
        check_same(value_at(t, &s, (struct dt_point){2, 0}),
                   n == 0   ? (double)NAN
                   : n == 1 ? 1
                            : 2,
                   p[1]);
        if (n == 3) {
            check_same(value_at(t, &s, (struct dt_point){8, 0}), 7, p[2]);
            check_same(value_at(t, &s, (struct dt_point){0, 8}), 7, p[2]);
            check_same(value_at(t, &s, (struct dt_point){7, 7}), 11, p[2]);
            check_same(value_at(t, &s, (struct dt_point){-7, -7}), 1, p[2]);
        }
        dt_surface_end(&s);
        dt_free(t);
    }
}

/* If a value is missing on the hull, it is missing beyond the hull; a hole inside stays. */
TEST(values_outside_are_missing_where_those_of_the_hull_are)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}};
    const double z[] = {0, 8, (double)NAN, 1, 3};
    struct dt *t = set_with(p, z, 5);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    s.beyond = true;
    CHECK(isnan(value_at(t, &s, (struct dt_point){5, 2})));
    CHECK(isnan(value_at(t, &s, (struct dt_point){5, 5})));
    CHECK(isnan(value_at(t, &s, (struct dt_point){3, 2})));
    CHECK(value_at(t, &s, (struct dt_point){5, -1}) == 8);
    CHECK(value_at(t, &s, (struct dt_point){5, 0}) == 8);
    CHECK(value_at(t, &s, (struct dt_point){2, -1}) == 4);
    s.max_edge = 3.5; /* no edge of the hull, but its points */
    CHECK(isnan(value_at(t, &s, (struct dt_point){2, -1})));
    CHECK(value_at(t, &s, (struct dt_point){5, -1}) == 8);
    dt_surface_end(&s);
    dt_free(t);
}

TEST(values_outside_end_at_borders)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 8, 4, 1, 3};
    static const struct dt_constraint c[] = {{0, 1, true, 7}, {1, 4, true, 7}, {0, 4, true, 7}};
    struct dt *t = set_with(p, z, 5);
    uint32_t missing;
    size_t added;
    CHECK(dt_constrain(t, c, 3, NULL, &added, &missing) == DT_OK && dt_survey(t, NULL) == DT_OK);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    s.beyond = s.inside = true;
    s.number = 7;
    CHECK(value_at(t, &s, (struct dt_point){2, -1}) == 4);
    CHECK(value_at(t, &s, (struct dt_point){5, -1}) == 8);
    CHECK(isnan(value_at(t, &s, (struct dt_point){5, 2})));
    CHECK(isnan(value_at(t, &s, (struct dt_point){5, 6})));
    dt_surface_end(&s);
    dt_free(t);
}

TEST(values_outside_by_the_nearest_point)
{
    static const struct dt_point p[] = {{0, 0}, {8, 0}, {4, 1}};
    static const double z[] = {1, 2, 3};
    struct dt *t = set_with(p, z, 3);
    struct dt_surface s = surface_in(t, DT_CLOSEST);
    s.beyond = true;
    CHECK(value_at(t, &s, (struct dt_point){4.5, -0.5}) == 3);
    CHECK(value_at(t, &s, (struct dt_point){4, -20}) == 1);
    CHECK(value_at(t, &s, (struct dt_point){9, -1}) == 2);
    dt_surface_end(&s);
    dt_free(t);
}

/* The signs of dot products beside those in long doubles, where these are exact. */
TEST(dot_products_have_exact_signs)
{
    for (int i = 0; i < 100000; i++) {
        struct dt_point p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (struct dt_point){1e15 + test_below(i % 2 == 0 ? 9 : 100000),
                                     test_below(i % 2 == 0 ? 9 : 100000)};
        double x = (p[1].x - p[0].x) * (p[2].x - p[0].x), y = (p[1].y - p[0].y) * (p[2].y - p[0].y);
        CHECK(dt_dot(p[0], p[1], p[2]) == (x + y > 0) - (x + y < 0));
    }
    struct dt_point o = {0, 0}, a = {1 + 0x1p-52, 1}, b = {-1 + 0x1p-53, 1};
    CHECK(dt_dot(o, a, b) == -1 && dt_dot(o, b, a) == -1);
    CHECK(dt_dot(o, (struct dt_point){1, 0x1p-140}, (struct dt_point){0x1p-140, -1}) == 0);
}
