/* slope_test.c - slopes of the linear surface: exact gradients, the triangle that counts, and several numbers of a place. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/exact/bignum.h"
#include "core/exact/degrees.h"
#include "core/triangle/gradient.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- one triangle ---- */

static double any_number(int range)
{
    double v = ldexp(2 * test_uniform() - 1, (int)(test_random() % (uint64_t)range) - range / 2);
    return test_random() % 8 == 0 ? 0 : v;
}

static struct dt_big times(const struct dt_big *a, const struct dt_big *b)
{
    return dt_big_multiply(*a, *b);
}

/* a d - b c of differences to the first number of each array */
static struct dt_big determinant(const double *a, const double *d, int i, int k)
{
    struct dt_big p, q, r, s;
    p = dt_big_difference(a[i], a[0]);
    q = dt_big_difference(d[k], d[0]);
    r = dt_big_difference(d[i], d[0]);
    s = dt_big_difference(a[k], a[0]);
    p = times(&p, &q);
    r = times(&r, &s);
    return dt_big_subtract(p, r);
}

/* Whether no other double is nearer to num / den. */
static bool is_nearest(double got, const struct dt_big *num, const struct dt_big *den)
{
    struct dt_big v, middle, half;
    double other[2] = {nextafter(got, -HUGE_VAL), nextafter(got, HUGE_VAL)};
    half = dt_big_of(0.5);
    for (int i = 0; i < 2; i++) { /* num - den (got + other) / 2 */
        v = dt_big_of(got);
        middle = dt_big_of(other[i]);
        v = dt_big_add(v, middle);
        v = times(&v, &half);
        v = times(&v, den);
        int side = dt_big_compare(*num, v) * den->sign;
        if (i == 0 ? side < 0 : side > 0)
            return false;
    }
    return true;
}

static void check_gradient(struct dt_point p[3], double z[3])
{
    double x[] = {p[0].x, p[1].x, p[2].x}, y[] = {p[0].y, p[1].y, p[2].y};
    struct dt_big area = determinant(x, y, 1, 2), dx = determinant(z, y, 1, 2),
                  dy = determinant(x, z, 1, 2);
    if (area.sign == 0)
        return;
    struct dt_gradient g = dt_gradient_of(p, z);
    CHECK_MSG(is_nearest(g.dx, &dx, &area) && is_nearest(g.dy, &dy, &area), "%a %a", g.dx, g.dy);
}

TEST(gradients_are_the_nearest_doubles)
{
    for (int i = 0; i < 20000; i++) {
        struct dt_point p[3];
        double z[3];
        int kind = i % 4, range = kind == 0 ? 4 : kind == 1 ? 60 : kind == 2 ? 240 : 1;
        for (int k = 0; k < 3; k++) {
            p[k] = (struct dt_point){any_number(range), any_number(range)};
            z[k] = any_number(kind == 2 ? 800 : range);
            if (kind == 3) /* nearly on a line */
                p[k] =
                    (struct dt_point){p[k].x, p[k].x / 3 + (double)(test_random() % 3) * 0x1p-50};
        }
        check_gradient(p, z);
    }
}

TEST(gradients_of_planes_are_exact)
{
    struct dt_point p[3] = {{1e6, 3}, {1e6 + 0.125, 3}, {1e6, 3 + 0x1p-20}};
    double z[3] = {5, 5 + 0.25, 5 - 0x1p-21};
    struct dt_gradient g = dt_gradient_of(p, z);
    CHECK(g.dx == 2 && g.dy == -0.5);
    double level[3] = {1e300, 1e300, 1e300}, high[3] = {-1.7e308, 1.7e308, -1.7e308};
    g = dt_gradient_of(p, level);
    CHECK(g.dx == 0 && g.dy == 0 && !signbit(g.dx) && !signbit(g.dy));
    g = dt_gradient_of(p, high);
    CHECK(isinf(g.dx) && g.dx > 0 && g.dy == 0);
}

TEST(gradients_in_the_middle_of_two_doubles_are_even)
{
    const double unit = 0x1p-52;
    struct dt_point p[3] = {{0, 0}, {4, 0}, {0, 4}};
    for (int k = 0; k < 8; k++) {
        double high = 4 + 4 * unit * k, z[3] = {-2 * unit, high, high};
        struct dt_gradient g = dt_gradient_of(p, z);
        double even = 1 + unit * (k % 2 == 0 ? k : k + 1);
        CHECK_MSG(g.dx == even && g.dy == even, "%d: %a", k, g.dx);
    }
}

/* ---- places ---- */

static void numbers_at(const struct dt *t, const struct dt_surface *s, struct dt_point q,
                       double *out)
{
    size_t done;
    CHECK(dt_values(t, s, &q, 1, NULL, out, &done) == DT_OK && done == 1);
}

static struct dt_gradient gradient_at(const struct dt *t, struct dt_point q)
{
    uint32_t id[3];
    size_t done;
    struct dt_point p[3];
    double z[3];
    CHECK(dt_locate_many(t, NULL, &q, 1, NULL, id, &done) == DT_OK);
    if (id[0] == DT_NONE)
        return (struct dt_gradient){(double)NAN, (double)NAN};
    for (int k = 0; k < 3; k++) {
        CHECK(dt_get(t, id[k], &p[k]) == DT_OK);
        z[k] = value_of(id[k]);
    }
    return dt_gradient_of(p, z);
}

static void check_places(const struct pair *pair)
{
    struct dt_surface slope = surface_of(DT_LINEAR), aspect = slope, both = slope, height = slope;
    slope.quantity = DT_SLOPE;
    aspect.quantity = DT_ASPECT;
    both.quantity = DT_GRADIENT;
    both.next = &slope;
    slope.next = &height;
    for (int i = 0; i < 40; i++) {
        struct dt_point q = random_place(pair->b);
        struct dt_gradient want = gradient_at(pair->t, q);
        double got[4], direction;
        numbers_at(pair->t, &both, q, got);
        numbers_at(pair->t, &aspect, q, &direction);
        check_same(got[0], want.dx, q);
        check_same(got[1], want.dy, q);
        check_same(got[2], dt_degrees_steep(want.dx, want.dy), q);
        check_same(direction, dt_degrees_downhill(want.dx, want.dy), q);
        check_same(got[3], value_at(pair->t, &height, q), q);
    }
}

TEST(slopes_are_those_of_the_first_triangle_at_the_place)
{
    make_values();
    for_each_pair(check_places);
}

enum { POINTS = 300, SIDE = 90 };

/* Every cell has the numbers of its centre, alone or found in the same search. */
static void check_raster(const struct dt *t, const struct dt_surface *s, size_t numbers)
{
    static double got[4 * SIDE * SIDE];
    struct dt_raster r = {{-2, -1}, {22, 21}, SIDE, SIDE};
    size_t done, n = (size_t)SIDE * SIDE;
    double want[4];
    CHECK(dt_raster_values(t, s, &r, 0, n, NULL, got, &done) == DT_OK && done == n);
    for (size_t i = 0; i < n; i++) {
        struct dt_point q = dt_raster_centre(&r, i);
        numbers_at(t, s, q, want);
        for (size_t k = 0; k < numbers; k++)
            check_same(got[i * numbers + k], want[k], q);
    }
}

static struct dt *random_set(void)
{
    struct dt_point p[POINTS];
    for (int i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){(double)(test_random() % 21), (double)(test_random() % 21)};
    make_values();
    return set_of(p, POINTS);
}

TEST(rasters_of_slopes_have_the_numbers_of_their_centres)
{
    struct dt *t = random_set();
    struct dt_surface s = surface_of(DT_LINEAR), more = s, third = s;
    for (int quantity = DT_GRADIENT; quantity <= DT_ASPECT; quantity++) {
        s.quantity = (enum dt_quantity)quantity;
        check_raster(t, &s, quantity == DT_GRADIENT ? 2 : 1);
        s.max_edge = 2;
        check_raster(t, &s, quantity == DT_GRADIENT ? 2 : 1);
        s.max_edge = HUGE_VAL;
    }
    s.quantity = DT_GRADIENT;
    s.next = &more;
    more.quantity = DT_ASPECT;
    more.next = &third;
    check_raster(t, &s, 4);
    dt_free(t);
}

TEST(several_surfaces_of_any_method_are_found_in_one_search)
{
    struct dt *t = random_set();
    static const double *page[61];
    for (int beyond = 0; beyond < 2; beyond++)
        for (int how = 0; how <= METHODS; how++) {
            struct dt_surface s = surface_of(all_methods[how]), other = s;
            for (uint32_t i = 0; i <= s.pages; i++) /* other values */
                page[i] = s.page[i < 2 ? 1 - i : i];
            other.page = page;
            s.beyond = other.beyond = beyond != 0;
            s.next = &other;
            check_raster(t, &s, 2);
            for (int i = 0; i < 100; i++) {
                struct dt_point q = {30 * test_uniform() - 5, 30 * test_uniform() - 5};
                double got[2];
                numbers_at(t, &s, q, got);
                s.next = NULL;
                check_same(got[0], value_at(t, &s, q), q);
                s.next = &other;
                check_same(got[1], value_at(t, &other, q), q);
            }
        }
    dt_free(t);
}

TEST(slopes_end_at_borders_and_at_missing_values)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    static const double z[] = {0, 4, 8, 4};
    static const struct dt_constraint ring[] = {{0, 1, true, 3}, {1, 2, true, 3}, {2, 0, true, 3}};
    struct dt *t = set_with(p, z, 4);
    size_t added;
    uint32_t missing;
    CHECK(dt_constrain(t, ring, 3, NULL, &added, &missing) == DT_OK && dt_survey(t, NULL) == DT_OK);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    s.quantity = DT_SLOPE;
    CHECK(value_at(t, &s, (struct dt_point){1, 3}) == value_at(t, &s, (struct dt_point){3, 1}));
    s.inside = true;
    s.number = 3;
    CHECK(isnan(value_at(t, &s, (struct dt_point){1, 3})));
    CHECK(value_at(t, &s, (struct dt_point){2, 2}) == value_at(t, &s, (struct dt_point){3, 1}));
    dt_surface_end(&s);
    double none = (double)NAN;
    CHECK(dt_field_set_run(t, "z", 1, 1, &none, 1, NULL, &missing) == DT_OK);
    s = surface_in(t, DT_LINEAR);
    s.quantity = DT_SLOPE;
    CHECK(isnan(value_at(t, &s, (struct dt_point){3, 1})));
    CHECK(!isnan(value_at(t, &s, (struct dt_point){1, 3})));
    dt_surface_end(&s);
    dt_free(t);
}
