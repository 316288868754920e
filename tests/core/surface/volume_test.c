/* volume_test.c - volumes beside exact rational numbers, and equal bytes in any order. */
#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/exact/bignum.h"
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct dt_volumes volumes_in(const struct dt *t, const struct dt_view *view,
                                    const char *minus, double level)
{
    struct dt_volume *v = NULL;
    struct dt_volumes r;
    bool done = false;
    const struct dt_field *low = minus == NULL ? NULL : dt_field_find(t, minus, strlen(minus));
    CHECK(dt_volume_begin(t, view, dt_field_find(t, "z", 1), low, level, &v) == DT_OK);
    while (!done)
        CHECK(dt_volume_read(t, v, &done) == DT_OK);
    dt_volume_end(v, &r);
    dt_volume_free(v);
    return r;
}

static bool is_near(double got, double want)
{
    return fabs(got - want) <= 0x1p-45 * fabs(want);
}

static void check_volumes(const struct dt_volumes *got, double above, double below, double area)
{
    CHECK_MSG(is_near(got->above, above) && is_near(got->below, below) && is_near(got->area, area),
              "above %.17g below %.17g area %.17g", got->above, got->below, got->area);
}

/* A square of side 4 with a peak in its middle. */
static struct dt *peak(double foot, double top)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    const double z[] = {foot, foot, foot, foot, top};
    return set_with(p, z, 5);
}

TEST(the_volume_of_a_pyramid_is_a_third_of_its_height_times_its_base)
{
    struct dt *t = peak(0, 3);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0);
    check_volumes(&r, 16, 0, 16);
    CHECK(r.below == 0 && r.area == 16);
    dt_free(t);
}

TEST(a_level_divides_a_pyramid_into_its_tip_and_what_is_around)
{
    struct dt *t = peak(0, 1);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0.5);
    check_volumes(&r, 2. / 3, 16 * 0.5 - 16. / 3 + 2. / 3, 16);
    dt_free(t);
    t = peak(0, -1); /* upside down */
    r = volumes_in(t, NULL, NULL, -0.5);
    check_volumes(&r, 16 * 0.5 - 16. / 3 + 2. / 3, 2. / 3, 16);
    dt_free(t);
}

TEST(triangles_with_a_missing_value_count_for_nothing)
{
    struct dt *t = peak(1, 1);
    double none = (double)NAN;
    uint32_t missing;
    CHECK(dt_field_set_run(t, "z", 1, 0, &none, 1, NULL, &missing) == DT_OK);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0);
    check_volumes(&r, 8, 0, 8);
    dt_free(t);
}

TEST(volumes_between_two_fields_have_both_signs)
{
    struct dt *t = peak(0, 3);
    const double other[] = {1, 1, 1, 1, 1};
    uint32_t missing;
    CHECK(dt_field_set_run(t, "low", 3, 0, other, 5, NULL, &missing) == DT_OK);
    struct dt_volumes a = volumes_in(t, NULL, "low", 77), b = volumes_in(t, NULL, NULL, 1);
    CHECK(memcmp(&a, &b, sizeof a) == 0);
    dt_free(t);
}

TEST(points_that_were_taken_back_count_for_nothing)
{
    enum { MORE = 1000 };
    struct dt *t = peak(0, 3);
    struct dt_point p[MORE];
    struct dt_added added;
    for (int i = 0; i < MORE; i++)
        p[i] = (struct dt_point){(i % 40) * 0.1, (double)(i / 40) * 0.1 + 0.05};
    CHECK(dt_add(t, p, MORE, &added) == DT_OK);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    dt_take_back(t, MORE);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0);
    check_volumes(&r, 16, 0, 16);
    dt_free(t);
}

TEST(a_set_without_triangles_has_no_volume)
{
    static const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}};
    static const double z[] = {1, 2, 3};
    struct dt *t = set_with(p, z, 3);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0);
    CHECK(r.above == 0 && r.below == 0 && r.area == 0);
    dt_free(t);
}

/* ---- beside exact numbers ---- */

struct exact {
    struct dt_big above, below, area; /* six times the volumes, twice the area */
};

static struct dt_big product(const struct dt_big *a, const struct dt_big *b)
{
    return dt_big_multiply(*a, *b);
}

/* h / (h - other) of the height h. */
static struct dt_big share_of(const struct dt_big *h, const struct dt_big *other)
{
    struct dt_big r = dt_big_subtract(*h, *other);
    return dt_big_divide(*h, r);
}

static void add_to(struct dt_big *sum, const struct dt_big *v)
{
    struct dt_big size = *v;
    size.sign = v->sign * v->sign;
    *sum = dt_big_add(*sum, size);
}

static struct dt_big exact_area(const struct dt_point p[3])
{
    struct dt_big ax, ay, bx, by;
    ax = dt_big_difference(p[1].x, p[0].x);
    ay = dt_big_difference(p[1].y, p[0].y);
    bx = dt_big_difference(p[2].x, p[0].x);
    by = dt_big_difference(p[2].y, p[0].y);
    ax = product(&ax, &by);
    ay = product(&ay, &bx);
    return dt_big_subtract(ax, ay);
}

static void add_exact(struct exact *e, const struct dt_point p[3], const double z[3], double level)
{
    struct dt_big area = exact_area(p), h[3], whole, tip;
    int above = 0, below = 0;
    whole = dt_big_of(0);
    for (int k = 0; k < 3; k++) {
        h[k] = dt_big_difference(z[k], level);
        whole = dt_big_add(whole, h[k]);
        above += h[k].sign > 0;
        below += h[k].sign < 0;
    }
    add_to(&e->area, &area);
    whole = product(&whole, &area);
    if (above == 0 || below == 0) {
        add_to(above == 0 ? &e->below : &e->above, &whole);
        return;
    }
    int sign = above == 1 ? 1 : -1, lone = 0;
    while (h[lone].sign != sign)
        lone++;
    const struct dt_big *other = &h[(lone + 1) % 3], *third = &h[(lone + 2) % 3];
    struct dt_big a = share_of(&h[lone], other), b = share_of(&h[lone], third);
    tip = product(&h[lone], &area);
    tip = product(&tip, &a);
    tip = product(&tip, &b);
    add_to(sign > 0 ? &e->above : &e->below, &tip);
    whole = dt_big_subtract(whole, tip);
    add_to(sign > 0 ? &e->below : &e->above, &whole);
}

static struct exact exact_volumes(const struct dt *t, const double *z, double level)
{
    struct exact e;
    uint32_t row[3 * 64];
    struct dt_cursor c;
    size_t rows = 1, words;
    e.above = dt_big_of(0);
    e.below = e.area = e.above;
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    while (rows > 0) {
        CHECK(dt_table_read(t, &c, row, 3 * 64, 64, &rows, &words) == DT_OK);
        for (size_t at = 0; at < words; at += 3) {
            struct dt_point p[3];
            double corner[3];
            for (size_t k = 0; k < 3; k++) {
                CHECK(dt_get(t, row[at + k], &p[k]) == DT_OK);
                corner[k] = z[row[at + k]];
            }
            add_exact(&e, p, corner, level);
        }
    }
    return e;
}

/* got = exact / divisor, within 2^-45 of limit / divisor and the least double. */
static void check_exact(double got, const struct dt_big *exact, const struct dt_big *limit,
                        double divisor, double level)
{
    struct dt_big v, by, error, most = *limit;
    v = dt_big_of(got);
    by = dt_big_of(divisor);
    v = product(&v, &by);
    error = dt_big_subtract(v, *exact);
    error.sign = error.sign * error.sign;
    v = dt_big_of(0x1p-45);
    most = product(&most, &v);
    v = dt_big_of(0x1p-1070);
    most = dt_big_add(most, v);
    CHECK_MSG(dt_big_compare(error, most) <= 0, "%.17g instead of %.17g, level %g", got,
              dt_big_to_double(*exact) / divisor, level);
}

static void check_beside_exact(const struct dt *t, const double *z, double level)
{
    struct exact e = exact_volumes(t, z, level);
    struct dt_volumes got = volumes_in(t, NULL, NULL, level);
    struct dt_big both = dt_big_add(e.above, e.below);
    check_exact(got.above, &e.above, &both, 6, level);
    check_exact(got.below, &e.below, &both, 6, level);
    check_exact(got.area, &e.area, &e.area, 2, level);
}

static double any_value(int kind)
{
    double unit = (double)(test_random() >> 11) * 0x1p-53, size = 1;
    switch (kind) {
    case 0: /* near each other, many equal */
        return 100 + (double)(test_random() % 4);
    case 1:
        return 2 * unit - 1;
    case 2: /* of all magnitudes whose volumes are doubles */
        size = ldexp(1, (int)(test_random() % 400) - 200);
        break;
    default: /* the least ones */
        size = 0x1p-1060;
    }
    return (2 * unit - 1) * size;
}

static void check_set(const struct pair *pair)
{
    uint32_t n = dt_next_id(pair->t), missing;
    double *z = malloc(n * sizeof *z + 1);
    for (int kind = 0; kind < 4; kind++) {
        struct dt_point p;
        for (uint32_t i = 0; i < n; i++)
            z[i] = dt_get(pair->t, i, &p) == DT_OK ? any_value(kind) : (double)NAN;
        CHECK(dt_field_set_run(pair->t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
        check_beside_exact(pair->t, z, 0);
        check_beside_exact(pair->t, z, n > 0 && !isnan(z[n / 2]) ? z[n / 2] : 0.5);
        check_beside_exact(pair->t, z, 101);
    }
    free(z);
}

TEST(volumes_of_every_family_err_by_less_than_2_to_minus_45_of_their_sum)
{
    for_each_pair(check_set);
}

TEST(volumes_of_the_largest_values_do_not_overflow_before_their_sum_does)
{
    struct dt *t = peak(-0x1.8p1023, 0x1.8p1023);
    struct dt_volumes r = volumes_in(t, NULL, NULL, 0x1p1023);
    CHECK(isinf(r.below) && r.area == 16 && r.above > 0x1p1000);
    dt_free(t);
}

/* ---- the same bytes ---- */

enum { MANY = 3000 };

static void make_many(struct dt_point *p, double *z)
{
    for (uint32_t i = 0; i < MANY; i++) {
        p[i] =
            (struct dt_point){(double)(test_random() % 1000) / 7, (double)(test_random() % 1000)};
        z[i] = any_value(2);
    }
}

TEST(equal_sets_have_volumes_of_equal_bytes)
{
    static struct dt_point p[MANY];
    static double z[MANY];
    uint32_t missing;
    make_many(p, z);
    struct dt *a = set_with(p, z, MANY), *b = set_of_each(p, MANY);
    CHECK(dt_field_set_run(b, "z", 1, 0, z, MANY, NULL, &missing) == DT_OK);
    struct dt_volumes one = volumes_in(a, NULL, NULL, 1e-3),
                      other = volumes_in(b, NULL, NULL, 1e-3);
    CHECK(memcmp(&one, &other, sizeof one) == 0);
    dt_free(a);
    dt_free(b);
}

TEST(volumes_are_those_of_the_moment_of_a_view_while_the_set_is_edited)
{
    static struct dt_point p[MANY];
    static double z[MANY];
    make_many(p, z);
    struct dt *t = set_with(p, z, MANY);
    struct dt_volumes want = volumes_in(t, NULL, NULL, 0), got;
    struct dt_volume *v;
    bool done = false;
    struct dt_view *view = dt_view_begin(t, true);
    CHECK(dt_volume_begin(t, view, dt_field_find(t, "z", 1), NULL, 0, &v) == DT_OK);
    for (uint32_t id = 0; !done; id += 7) {
        CHECK(dt_volume_read(t, v, &done) == DT_OK);
        uint32_t deleted, missing;
        double other = 1e9;
        dt_delete(t, &id, 1, &deleted, &missing);
        CHECK(dt_field_set(t, "z", 1, &(uint32_t){id + 1}, &other, 1, NULL, &missing) == DT_OK);
    }
    dt_volume_end(v, &got);
    CHECK(memcmp(&want, &got, sizeof want) == 0);
    dt_volume_free(v);
    dt_view_end(view);
    dt_free(t);
}

/* ---- in a box ---- */

static struct dt_volumes volumes_in_box(const struct dt *t, double level, struct dt_point lo,
                                        struct dt_point hi)
{
    struct dt_volume *v = NULL;
    struct dt_volumes r;
    bool done = false;
    CHECK(dt_volume_begin(t, NULL, dt_field_find(t, "z", 1), NULL, level, &v) == DT_OK);
    dt_volume_clip(v, lo, hi);
    while (!done)
        CHECK(dt_volume_read(t, v, &done) == DT_OK);
    dt_volume_end(v, &r);
    dt_volume_free(v);
    return r;
}

TEST(volumes_in_a_box_are_cut_at_its_sides)
{
    struct dt *t = peak(0, 3);
    struct dt_volumes r = volumes_in_box(t, 0, (struct dt_point){1, 1}, (struct dt_point){3, 3});
    check_volumes(&r, 8, 0, 4);
    r = volumes_in_box(t, 1.5, (struct dt_point){0, 0}, (struct dt_point){2, 4});
    check_volumes(&r, 1, 5, 8);
    r = volumes_in_box(t, 0, (struct dt_point){-9, -9}, (struct dt_point){9, 9});
    struct dt_volumes all = volumes_in(t, NULL, NULL, 0);
    CHECK(memcmp(&r, &all, sizeof r) == 0);
    r = volumes_in_box(t, 0, (struct dt_point){1, 0}, (struct dt_point){1, 4});
    CHECK(r.above == 0 && r.below == 0 && r.area == 0);
    dt_free(t);
}

TEST(volumes_in_a_tiny_corner_of_a_triangle_are_exact)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0}, {0, 1}};
    const double z[] = {0, 1, 0}, tiny = 0x1p-60;
    struct dt *t = set_with(p, z, 3);
    struct dt_volumes r =
        volumes_in_box(t, 0, (struct dt_point){-1, -1}, (struct dt_point){tiny, 5});
    check_volumes(&r, tiny * tiny / 2, 0, tiny); /* less 2^-60 of itself */
    r = volumes_in_box(t, 0, (struct dt_point){1 - tiny * 128, -1}, (struct dt_point){5, 5});
    check_volumes(&r, tiny * tiny * 0x1p13, 0, tiny * tiny * 0x1p13);
    r = volumes_in_box(t, 0x1p-61, (struct dt_point){-1, -1}, (struct dt_point){tiny, 5});
    check_volumes(&r, 0x1p-123, 0x1p-123, tiny);
    dt_free(t);
}

TEST(volumes_in_boxes_that_tile_the_plane_add_up)
{
    static struct dt_point p[MANY];
    static double z[MANY];
    uint32_t missing;
    struct dt_volumes sum = {0, 0, 0};
    make_many(p, z);
    struct dt *t = set_with(p, z, MANY), *other = set_of_each(p, MANY);
    CHECK(dt_field_set_run(other, "z", 1, 0, z, MANY, NULL, &missing) == DT_OK);
    struct dt_volumes all = volumes_in(t, NULL, NULL, 1e-3);
    for (int i = 0; i < 9; i++) {
        const double x[] = {-1, 33.3, 101, 1000}, y[] = {-1, 250, 600.25, 2000};
        struct dt_point lo = {x[i % 3], y[i / 3]}, hi = {x[i % 3 + 1], y[i / 3 + 1]};
        struct dt_volumes r = volumes_in_box(t, 1e-3, lo, hi),
                          same = volumes_in_box(other, 1e-3, lo, hi);
        CHECK(memcmp(&r, &same, sizeof r) == 0);
        sum.above += r.above;
        sum.below += r.below;
        sum.area += r.area;
    }
    CHECK(fabs(sum.above - all.above) + fabs(sum.below - all.below) <=
          0x1p-43 * (all.above + all.below));
    CHECK(fabs(sum.area - all.area) <= 0x1p-43 * all.area);
    dt_free(t);
    dt_free(other);
}
