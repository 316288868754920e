/* places_test.c - values of arrays, and places that rounding has put outside the hull. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "tests/core/surface/values.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#define TOL 0x1p-45

TEST_TIMEOUT(values_of_an_array_have_the_bytes_of_those_of_a_field, 60)
{
    enum { N = 300 };
    struct dt_point p[N], q[N];
    double z[N], got[N], want[N];
    uint32_t triangle[6 * N];
    for (const struct family *f = families; f->name != NULL; f++) {
        struct dt_arrays *a, *without_rows;
        uint32_t row;
        size_t done;
        family_points(f, p, N, test_random());
        family_points(f, q, N, test_random());
        memcpy(q, p, 50 * sizeof *q);
        for (unsigned i = 0; i < N; i++)
            z[i] = i % 50 == 3 ? (double)NAN : sin(i);
        struct dt *t = set_with(p, z, N);
        CHECK(dt_arrays_new(p, N, NULL, 1, triangle, &a) == DT_OK);
        CHECK(dt_arrays_new(p, N, NULL, 1, NULL, &without_rows) == DT_OK);
        enum dt_status s_row = dt_arrays_locate(without_rows, q, 1, 0, 1, &row);
        CHECK(s_row == DT_UNTRIANGULATED || (s_row == DT_OK && row == DT_NONE));
        for (unsigned m = 0; m < METHODS; m++) {
            struct dt_surface s = surface_in(t, all_methods[m]);
            CHECK(dt_values(t, &s, q, N, NULL, want, &done) == DT_OK);
            CHECK(dt_arrays_values(a, z, all_methods[m], HUGE_VAL, q, N, 0, (double)NAN, 2, got) ==
                  DT_OK);
            for (unsigned i = 0; i < N; i++)
                check_same(got[i], want[i], q[i]);
            CHECK(dt_arrays_values(without_rows, z, all_methods[m], HUGE_VAL, q, N, 0, (double)NAN,
                                   1, want) == DT_OK);
            CHECK(memcmp(got, want, sizeof got) == 0);
            dt_surface_end(&s);
        }
        dt_arrays_free(a);
        dt_arrays_free(without_rows);
        dt_free(t);
    }
}

/* A square with points along its sides that are not on one line by rounding, turned by an angle. */
static struct dt_arrays *turned_square(unsigned n, double angle, struct dt_point *p)
{
    struct dt_arrays *a;
    uint32_t triangle[2400];
    for (unsigned i = 0; i < 4 * n; i++) {
        double t = 2.0 * (i % n) / n - 1, side = i / n;
        double x = side < 2 ? t : side < 3 ? 1 : -1, y = side < 1 ? 1 : side < 2 ? -1 : t;
        p[i] = (struct dt_point){x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)};
    }
    CHECK(12 * 2 * n <= sizeof triangle / sizeof *triangle);
    CHECK(dt_arrays_new(p, 4 * n, NULL, 1, triangle, &a) == DT_OK);
    return a;
}

TEST(a_place_that_rounding_puts_outside_the_hull_has_a_triangle_and_a_value)
{
    enum { N = 100, PLACES = 400 };
    struct dt_point p[4 * N];
    double z[4 * N], value;
    unsigned outside = 0;
    for (unsigned n = 3; n <= N; n = 2 * n + 1) {
        struct dt_arrays *a = turned_square(n, 0.7 * n, p);
        for (unsigned i = 0; i < 4 * n; i++)
            z[i] = 3 * p[i].x - p[i].y;
        for (unsigned i = 0; i < PLACES; i++) {
            double t = -1 + (2 - 2.0 / n) * i / PLACES, c = cos(0.7 * n), s = sin(0.7 * n);
            struct dt_point q = {t * c - s, t * s + c};
            uint32_t exact, row;
            CHECK(dt_arrays_locate(a, &q, 1, 0, 1, &exact) == DT_OK);
            CHECK(dt_arrays_locate(a, &q, 1, TOL, 1, &row) == DT_OK);
            CHECK(exact == DT_NONE || exact == row);
            CHECK(row != DT_NONE);
            outside += exact == DT_NONE;
            CHECK(dt_arrays_values(a, z, DT_NATURAL, HUGE_VAL, &q, 1, TOL, 100, 1, &value) ==
                  DT_OK);
            CHECK(fabs(value - (3 * q.x - q.y)) < 1e-13);
            CHECK(dt_arrays_values(a, z, DT_LINEAR, 1e-6, &q, 1, TOL, 100, 1, &value) == DT_OK);
            CHECK(value == 100 || exact != DT_NONE);
            q.x += 1e-9 * -s;
            q.y += 1e-9 * c;
            CHECK(dt_arrays_locate(a, &q, 1, TOL, 1, &row) == DT_OK && row == DT_NONE);
            CHECK(dt_arrays_values(a, z, DT_LINEAR, HUGE_VAL, &q, 1, TOL, 100, 1, &value) == DT_OK);
            CHECK(value == 100);
        }
        dt_arrays_free(a);
    }
    CHECK_MSG(outside > PLACES / 5, "%u places outside: nothing was tested", outside);
}

TEST(a_missing_value_is_missing_and_outside_is_what_the_caller_says)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const struct dt_point q[] = {{2, 1}, {3, 2}, {5, 5}, {1e300, 0}, {1e-60, 1e-60}};
    double z[] = {(double)NAN, 1, 2, 3, 4}, value[5];
    uint32_t triangle[30];
    struct dt_arrays *a;
    CHECK(dt_arrays_new(p, 5, NULL, 1, triangle, &a) == DT_OK);
    CHECK(dt_arrays_values(a, z, DT_LINEAR, HUGE_VAL, q, 5, TOL, -7, 1, value) == DT_OK);
    CHECK(isnan(value[0]) && value[1] == 2.75 && value[2] == -7 && value[3] == -7);
    CHECK(isnan(value[4]));
    z[0] = 0; /* values are read during the call */
    CHECK(dt_arrays_values(a, z, DT_LINEAR, HUGE_VAL, q, 5, TOL, -7, 1, value) == DT_OK);
    CHECK(value[0] == 2.25 && value[4] == 0);
    CHECK(dt_arrays_values(a, z, DT_LINEAR, 3, q, 5, TOL, -7, 1, value) == DT_OK);
    CHECK(value[0] == -7);
    dt_arrays_free(a);
}
