/* smooth_test.c - smooth values: their slopes are continuous, and planes stay planes. */
#include "core/delaunay_constraints.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

enum { N = 200 };

static struct dt_point random_point(void)
{
    return (struct dt_point){test_uniform(), test_uniform()};
}

static void fill_random(struct dt_point *p, double *z, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        p[i] = random_point();
        z[i] = sin(7 * p[i].x) * cos(5 * p[i].y);
    }
}

TEST(smooth_values_of_a_plane_are_on_it)
{
    struct dt_point p[N];
    double z[N];
    for (int round = 0; round < 20; round++) {
        double a = test_uniform() - 0.5, b = test_uniform() - 0.5;
        for (int i = 0; i < N; i++) {
            p[i] =
                round % 2 == 0 ? random_point() : (struct dt_point){test_below(9), test_below(9)};
            z[i] = 3 + a * p[i].x + b * p[i].y;
        }
        struct dt *t = set_with(p, z, N);
        struct dt_surface s = surface_in(t, DT_SMOOTH);
        for (int i = 0; i < 200; i++) {
            double side = round % 2 == 0 ? 1 : 8;
            struct dt_point q = {side * test_uniform(), side * test_uniform()};
            double got = value_at(t, &s, q), want = 3 + a * q.x + b * q.y;
            CHECK_MSG(isnan(got) || fabs(got - want) < 1e-11, "%.17g instead of %.17g", got, want);
        }
        dt_surface_end(&s);
        dt_free(t);
    }
}

/* The rings of a lattice are symmetric, so slopes of quadratic functions are exact there, and their patches are the functions. */
TEST(smooth_values_of_a_quadratic_function_over_a_lattice_are_exact)
{
    enum { SIDE = 9 };
    struct dt_point p[SIDE * SIDE];
    double z[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        p[i] = (struct dt_point){i % SIDE, i / SIDE};
        z[i] = p[i].x * p[i].x + p[i].x * p[i].y - 2 * p[i].y * p[i].y + p[i].x;
    }
    struct dt *t = set_with(p, z, SIDE * SIDE);
    struct dt_surface s = surface_in(t, DT_SMOOTH);
    for (int i = 0; i < 2000; i++) {
        struct dt_point q = {1 + 6 * test_uniform(), 1 + 6 * test_uniform()};
        double want = q.x * q.x + q.x * q.y - 2 * q.y * q.y + q.x;
        CHECK(fabs(value_at(t, &s, q) - want) < 1e-12);
    }
    dt_surface_end(&s);
    dt_free(t);
}

/* The kink between a and b at the place: the difference of the slopes on both sides, by second differences. */
static double kink(const struct dt *t, const struct dt_surface *s, struct dt_point q,
                   struct dt_point across, double by)
{
    struct dt_point left = {q.x - by * across.x, q.y - by * across.y};
    struct dt_point right = {q.x + by * across.x, q.y + by * across.y};
    return (value_at(t, s, left) + value_at(t, s, right) - 2 * value_at(t, s, q)) / by;
}

/* A kink that is as large from near as from farther away; curvature makes one that is larger from farther away. */
static double sharp_kink(const struct dt *t, const struct dt_surface *s, struct dt_point q,
                         struct dt_point across)
{
    return fabs(kink(t, s, q, across, 1e-9)) - fabs(kink(t, s, q, across, 1e-7)) / 10;
}

/* At places of edges, of the lines inside triangles, and at points. */
static void check_slopes(const struct dt *t, enum dt_interpolation how, double *largest)
{
    struct dt_surface s = surface_in(t, how);
    *largest = 0;
    for (int i = 0; i < 300; i++) {
        struct dt_location at;
        struct dt_point p[3], q = {0.25 + test_uniform() / 2, 0.25 + test_uniform() / 2};
        CHECK(dt_locate(t, q, &at) == DT_OK && at.where == DT_INSIDE);
        for (int k = 0; k < 3; k++)
            CHECK(dt_get(t, at.id[k], &p[k]) == DT_OK);
        double u = test_uniform();
        if (i % 3 == 1)
            p[1] =
                (struct dt_point){(p[0].x + p[1].x + p[2].x) / 3, (p[0].y + p[1].y + p[2].y) / 3};
        if (i % 3 == 2)
            u = 0;
        q = (struct dt_point){p[0].x + u * (p[1].x - p[0].x), p[0].y + u * (p[1].y - p[0].y)};
        double angle = 6.28 * test_uniform();
        *largest = fmax(*largest, sharp_kink(t, &s, q, (struct dt_point){cos(angle), sin(angle)}));
    }
    dt_surface_end(&s);
}

TEST(smooth_values_have_continuous_slopes)
{
    struct dt_point p[N];
    double z[N], smooth, linear;
    fill_random(p, z, N);
    struct dt *t = set_with(p, z, N);
    check_slopes(t, DT_SMOOTH, &smooth);
    check_slopes(t, DT_LINEAR, &linear);
    CHECK_MSG(smooth < 1e-4 && linear > 0.1, "%g %g", smooth, linear);
    dt_free(t);
}

TEST(smooth_values_are_near_the_function)
{
    enum { MANY = 4000 };
    static struct dt_point p[MANY];
    static double z[MANY];
    double smooth = 0, linear = 0;
    fill_random(p, z, MANY);
    struct dt *t = set_with(p, z, MANY);
    struct dt_surface s = surface_in(t, DT_SMOOTH), l = surface_in(t, DT_LINEAR);
    for (int i = 0; i < 2000; i++) {
        struct dt_point q = {0.2 + 0.6 * test_uniform(), 0.2 + 0.6 * test_uniform()};
        double want = sin(7 * q.x) * cos(5 * q.y);
        smooth += fabs(value_at(t, &s, q) - want);
        linear += fabs(value_at(t, &l, q) - want);
    }
    CHECK_MSG(smooth < linear / 2, "%g %g", smooth, linear);
    dt_surface_end(&s);
    dt_surface_end(&l);
    dt_free(t);
}

/* The same set has the same bytes. */
TEST(smooth_values_do_not_depend_on_history)
{
    struct dt_point p[N];
    double z[N];
    uint32_t missing;
    fill_random(p, z, N);
    struct dt *t = set_with(p, z, N), *u = set_of_each(p, N);
    CHECK(dt_field_set_run(u, "z", 1, 0, z, N, NULL, &missing) == DT_OK);
    struct dt_surface a = surface_in(t, DT_SMOOTH), b = surface_in(u, DT_SMOOTH);
    for (int i = 0; i < 500; i++) {
        struct dt_point q = random_point();
        check_same(value_at(t, &a, q), value_at(u, &b, q), q);
    }
    dt_surface_end(&a);
    dt_surface_end(&b);
    dt_free(t);
    dt_free(u);
}

static void check_family(const struct pair *pair)
{
    struct dt_surface s = surface_of(DT_SMOOTH), l = surface_of(DT_LINEAR);
    make_values();
    for (int i = 0; i < 40; i++) {
        struct dt_point q = random_place(pair->b);
        double got = value_at(pair->t, &s, q), linear = value_at(pair->t, &l, q);
        CHECK(isnan(got) == isnan(linear) && !isinf(got));
        struct dt_location at;
        CHECK(dt_locate(pair->t, q, &at) == DT_OK);
        if (at.where == DT_ON_VERTEX)
            CHECK(got == value_of(at.id[0]));
    }
}

TEST_TIMEOUT(smooth_values_exist_where_linear_ones_do_on_every_family, 60)
{
    for_each_pair(check_family);
}

/* Along a line they are Hermite's cubics. */
TEST(smooth_values_along_a_line)
{
    static const struct dt_point p[] = {{0, 0}, {1, 1}, {3, 3}};
    static const double z[] = {0, 2, 10};
    struct dt *t = set_with(p, z, 3);
    /* slopes along the line, of x: 2, (2 + 4) / 2 = 3, 4 */
    CHECK(fabs(value_in(t, DT_SMOOTH, HUGE_VAL, 0.5, 0.5) - (1 + (2 - 3) / 8.0)) < 1e-14);
    CHECK(fabs(value_in(t, DT_SMOOTH, HUGE_VAL, 2, 2) - (6 + 2 * (3 - 4) / 8.0)) < 1e-14);
    CHECK(value_in(t, DT_SMOOTH, HUGE_VAL, 3, 3) == 10);
    CHECK(isnan(value_in(t, DT_SMOOTH, HUGE_VAL, 4, 4)));
    struct dt_surface s = surface_in(t, DT_SMOOTH);
    s.beyond = true;
    CHECK(fabs(value_at(t, &s, (struct dt_point){1, 0}) - (1 + (2 - 3) / 8.0)) < 1e-14);
    CHECK(value_at(t, &s, (struct dt_point){4, 4}) == 10);
    dt_surface_end(&s);
    dt_free(t);
    t = set_with(p, z, 1);
    CHECK(value_in(t, DT_SMOOTH, HUGE_VAL, 0, 0) == 0);
    dt_free(t);
}

/* Points without values have no part in slopes, and triangles with one have no surface. */
TEST(smooth_values_beside_missing_ones)
{
    struct dt_point p[N];
    double z[N], few[N];
    for (int i = 0; i < N; i++) {
        p[i] = random_point();
        z[i] = 1 + 2 * p[i].x - p[i].y;
        few[i] = i % 7 == 0 ? (double)NAN : z[i];
    }
    struct dt *t = set_with(p, few, N);
    struct dt_surface s = surface_in(t, DT_SMOOTH), l = surface_in(t, DT_LINEAR);
    int there = 0;
    for (int i = 0; i < 1000; i++) {
        struct dt_point q = random_point();
        double got = value_at(t, &s, q);
        CHECK(isnan(got) == isnan(value_at(t, &l, q)));
        CHECK(isnan(got) || fabs(got - (1 + 2 * q.x - q.y)) < 1e-9);
        there += !isnan(got);
    }
    CHECK(there > 300 && there < 900);
    dt_surface_end(&s);
    dt_surface_end(&l);
    dt_free(t);
}

TEST(smooth_values_beyond_the_range_of_doubles_are_linear)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1.5}};
    static const double z[] = {-1.7e308, 1.7e308, -1.7e308, 1.7e308, 1e308};
    struct dt *t = set_with(p, z, 5);
    for (int i = 0; i < 200; i++) {
        double x = 2 * test_uniform(), y = 2 * test_uniform();
        CHECK(value_in(t, DT_SMOOTH, HUGE_VAL, x, y) == value_in(t, DT_LINEAR, HUGE_VAL, x, y));
        CHECK(value_in(t, DT_SMOOTH, HUGE_VAL, x, 0) == value_in(t, DT_LINEAR, HUGE_VAL, x, 0));
    }
    dt_free(t);
}

/* In thin triangles, where weights in doubles are not exact enough. */
TEST(smooth_values_in_thin_triangles)
{
    enum { FEW = 12 };
    struct dt_point p[FEW];
    double z[FEW];
    for (int i = 0; i < FEW; i++) {
        p[i] = (struct dt_point){i, i % 2 == 0 ? 0 : 1e-13 * (1 + test_uniform())};
        z[i] = 5 + 0.5 * p[i].x;
    }
    struct dt *t = set_with(p, z, FEW);
    struct dt_surface s = surface_in(t, DT_SMOOTH);
    for (int i = 0; i < 300; i++) {
        double x = (FEW - 1) * test_uniform(), got = value_at(t, &s, (struct dt_point){x, 5e-14});
        CHECK(isnan(got) || fabs(got - (5 + 0.5 * x)) < 1e-9);
    }
    dt_surface_end(&s);
    dt_free(t);
}

/* A constraint shapes the triangulation alone: slopes go on across it. */
TEST(smooth_values_across_a_constraint)
{
    struct dt_point p[N];
    double z[N], smooth;
    size_t added;
    uint32_t missing;
    fill_random(p, z, N);
    p[0] = (struct dt_point){0.1, 0.1};
    p[1] = (struct dt_point){0.9, 0.9};
    for (int i = 0; i < 2; i++)
        z[i] = sin(7 * p[i].x) * cos(5 * p[i].y);
    struct dt *t = set_with(p, z, N);
    CHECK(dt_constrain(t, &(struct dt_constraint){0, 1, false, 0}, 1, NULL, &added, &missing) ==
          DT_OK);
    struct dt_surface s = surface_in(t, DT_SMOOTH);
    for (int i = 1; i < 50; i++) {
        struct dt_point q = {0.1 + 0.8 * i / 50, 0.1 + 0.8 * i / 50};
        CHECK(sharp_kink(t, &s, q, (struct dt_point){0.6, -0.8}) < 1e-4);
    }
    check_slopes(t, DT_SMOOTH, &smooth);
    CHECK_MSG(smooth < 1e-4, "%g", smooth);
    dt_surface_end(&s);
    dt_free(t);
}
