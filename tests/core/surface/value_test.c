/* value_test.c - values of surfaces at places. */
#include "tests/core/surface/values.h"

#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Beside the mean by the weights of WEIGHTS. */
static void check_mean(const struct dt *t, struct dt_point q, enum dt_interpolation how)
{
    struct dt_surface s = surface_of(how);
    double got = value_at(t, &s, q), sum = 0, least = HUGE_VAL, most = -HUGE_VAL;
    struct dt_weigher *w;
    struct dt_weight *weight;
    size_t n;
    CHECK(dt_weights_begin(t, q, how, NULL, &w) == DT_OK);
    CHECK(dt_weights_end(w, NULL, &weight, &n) == DT_OK);
    for (size_t i = 0; i < n; i++) {
        double z = value_of(weight[i].id);
        sum += weight[i].weight * (z - value_of(weight[0].id));
        least = fmin(least, z);
        most = fmax(most, z);
    }
    CHECK(n > 0 || isnan(got));
    if (n > 0) {
        double want = value_of(weight[0].id) + sum, error = 2 * DT_WEIGHTS_ERROR + 0x1p-41;
        CHECK_MSG(got >= least && got <= most, "%.17g outside %.17g to %.17g", got, least, most);
        CHECK_MSG(fabs(got - want) <= error, "%.17g instead of %.17g", got, want);
    }
    free(weight);
    dt_weights_free(w);
}

static void check_means(const struct pair *pair)
{
    make_values();
    for (int i = 0; i < 20; i++)
        for (int how = 0; how < 3; how++)
            check_mean(pair->t, random_place(pair->b), all_methods[how]);
}

TEST_TIMEOUT(values_are_means_by_the_weights_on_every_family, 120)
{
    for_each_pair(check_means);
}

static void check_points(const struct pair *pair)
{
    make_values();
    for (uint32_t id = 0; id < dt_next_id(pair->t); id++) {
        struct dt_point p;
        uint32_t rep;
        if (dt_get(pair->t, id, &p) != DT_OK)
            continue;
        CHECK(dt_representative(pair->t, id, &rep) == DT_OK);
        for (int how = 0; how < METHODS; how++) {
            struct dt_surface s = surface_of(all_methods[how]);
            check_same(value_at(pair->t, &s, p), value_of(rep), p);
        }
    }
}

TEST_TIMEOUT(values_at_points_are_theirs_on_every_family, 60)
{
    for_each_pair(check_points);
}

static void check_closest(const struct pair *pair)
{
    struct dt_surface s = surface_of(DT_CLOSEST);
    make_values();
    for (int i = 0; i < 20; i++) {
        struct dt_point q = random_place(pair->b);
        struct dt_location at;
        struct dt_ids ids = {0};
        CHECK(dt_locate(pair->t, q, &at) == DT_OK);
        CHECK(dt_nearest(pair->t, q, 1, &ids) == DT_OK);
        check_same(value_at(pair->t, &s, q),
                   at.where == DT_OUTSIDE ? (double)NAN : value_of(ids.v[0]), q);
        free(ids.v);
    }
}

TEST_TIMEOUT(values_of_the_nearest_points_on_every_family, 60)
{
    for_each_pair(check_closest);
}

TEST(values_of_a_constant_are_that_constant)
{
    struct dt_point p[100];
    double z[100];
    for (int i = 0; i < 100; i++) {
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
        z[i] = 0.1;
    }
    struct dt *t = set_with(p, z, 100);
    for (int i = 0; i < 400; i++) {
        double got =
            value_in(t, all_methods[i % METHODS], HUGE_VAL, test_uniform(), test_uniform());
        CHECK(isnan(got) || got == 0.1);
    }
    dt_free(t);
}

TEST(values_of_the_largest_magnitudes_stay_between_them)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1.5}};
    static const double z[] = {-1.7e308, 1.7e308, -1.7e308, 1.7e308, 1e308};
    struct dt *t = set_with(p, z, 5);
    for (int how = 0; how < METHODS; how++) {
        double got = value_in(t, all_methods[how], HUGE_VAL, 1, 0.5);
        CHECK(got >= -1.7e308 && got <= 1.7e308);
    }
    dt_free(t);
}

/* Values times 2^e, for which a mean may round at the least doubles, but not before. */
static void check_scaled(const struct dt_point *p, const double *z, uint32_t n, int e)
{
    double scaled[16];
    for (uint32_t i = 0; i < n; i++)
        scaled[i] = ldexp(z[i], e);
    struct dt *t = set_with(p, z, n), *u = set_with(p, scaled, n);
    struct dt_surface s, r;
    for (int how = 0; how < METHODS; how++) {
        s = surface_in(t, all_methods[how]);
        r = surface_in(u, all_methods[how]);
        for (int i = 0; i < 20; i++) {
            struct dt_point q = {4 * test_uniform() * p[1].x, 4 * test_uniform() * p[1].x};
            double want = value_at(t, &s, q), got = value_at(u, &r, q);
            CHECK_MSG((isnan(want) && isnan(got)) ||
                          fabs(got - ldexp(want, e)) <= ldexp(DT_WEIGHTS_ERROR, e + 2) + 0x1p-1074,
                      "%.17g instead of %.17g times 2^%d at %.17g %.17g", got, want, e, q.x, q.y);
        }
        dt_surface_end(&s);
        dt_surface_end(&r);
    }
    dt_free(t);
    dt_free(u);
}

TEST(values_of_the_least_magnitudes_are_as_exact_as_others)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0.25}, {4, 0}, {4, 4},
                                        {0, 4}, {2, 2.5},  {1, 3}};
    static const double z[] = {1, 2, 0, 4, 1, 3, 0};
    static const double side[] = {1, 0x1p-140, 0x1p198, 1e-9};
    for (size_t k = 0; k < sizeof side / sizeof *side; k++) {
        struct dt_point at[7];
        for (int i = 0; i < 7; i++)
            at[i] = (struct dt_point){p[i].x * side[k], p[i].y * side[k]};
        check_scaled(at, z, 7, -700);
        check_scaled(at, z, 7, -960);
        check_scaled(at, z, 7, -1010);
        check_scaled(at, z, 7, -1060);
        check_scaled(at, z, 7, 1020);
    }
}

TEST(means_of_the_least_doubles_are_rounded_once)
{
    static const struct dt_point p[] = {{0, 1}, {0, 2}, {2, 1}, {2, 2}, {1, 1}, {1, 2}, {1, 0}};
    double z[] = {0, 19, 19, 19,
                  8, 8,  0}; /* of which at 1 1.5 a 36th counts four times, and 4/9 twice */
    for (int i = 0; i < 7; i++)
        z[i] *= 0x1p-1074;
    struct dt *t = set_with(p, z, 7);
    CHECK(value_in(t, DT_NATURAL, HUGE_VAL, 1, 1.5) == 9 * 0x1p-1074); /* 8.69 */
    dt_free(t);
}

TEST(values_are_missing_where_one_that_counts_is)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2.5}};
    static const double z[] = {1, 2, (double)NAN, 4, 5};
    struct dt *t = set_with(p, z, 5), *fewer = set_with(p, z, 1);
    CHECK(value_in(t, DT_LINEAR, HUGE_VAL, 1, 0) == 1.25);
    CHECK(isnan(value_in(t, DT_LINEAR, HUGE_VAL, 3.5, 2)));
    CHECK(isnan(value_in(t, DT_LINEAR, HUGE_VAL, 4, 4)));
    CHECK(!isnan(value_in(t, DT_LINEAR, HUGE_VAL, 0.25, 2)));
    CHECK(isnan(value_in(t, DT_NATURAL, HUGE_VAL, 2, 2.75)));
    CHECK(isnan(value_in(t, DT_LAPLACE, HUGE_VAL, 2, 2.75)));
    CHECK(isnan(value_in(fewer, DT_LINEAR, HUGE_VAL, 1, 0)));
    CHECK(value_in(fewer, DT_LINEAR, HUGE_VAL, 0, 0) == 1);
    dt_free(t);
    dt_free(fewer);
}

/* Two unit squares, far apart: the triangles between them have long edges. */
TEST(values_are_missing_in_triangles_with_long_edges)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0},  {1, 1},  {0, 1},
                                        {9, 0}, {10, 0}, {10, 1}, {9, 1}};
    static const double z[] = {0, 1, 2, 3, 4, 5, 6, 7};
    struct dt *t = set_with(p, z, 8);
    for (int how = 0; how < METHODS; how++) {
        double edge = sqrt(2);
        CHECK(!isnan(value_in(t, all_methods[how], edge, 0.25, 0.5)));
        CHECK(!isnan(value_in(t, all_methods[how], edge, 1, 0.5)));
        CHECK(value_in(t, all_methods[how], edge, 9, 0) == 4);
        CHECK(isnan(value_in(t, all_methods[how], edge, 1.25, 0.5)));
        CHECK(isnan(value_in(t, all_methods[how], edge, 5, 0)));
        CHECK(isnan(value_in(t, all_methods[how], 1.25, 0.25, 0.5)));
        CHECK(value_in(t, all_methods[how], 1.25, 9, 0) == 4);
    }
    dt_free(t);
}

TEST(values_on_a_line_at_one_point_and_at_none)
{
    static const struct dt_point p[] = {{0, 0}, {4, 4}, {2, 2}};
    static const double z[] = {1, 3, 7};
    struct dt *line = set_with(p, z, 3), *one = set_with(p, z, 1), *none = set_of(p, 0);
    struct dt_surface s = {.how = DT_NATURAL, .max_edge = HUGE_VAL};
    for (int how = 0; how < METHODS; how++) {
        bool near = all_methods[how] == DT_CLOSEST;
        CHECK(value_in(line, all_methods[how], HUGE_VAL, 3.5, 3.5) == (near ? 3 : 4));
        CHECK(isnan(value_in(line, all_methods[how], HUGE_VAL, 3, 2)));
        CHECK(isnan(value_in(line, all_methods[how], HUGE_VAL, 5, 5)));
        CHECK(value_in(one, all_methods[how], HUGE_VAL, 0, 0) == 1);
        CHECK(isnan(value_in(one, all_methods[how], HUGE_VAL, 4, 4)));
        CHECK(isnan(value_in(line, all_methods[how], 2.5, 3.5, 3.5)));
        CHECK(value_in(line, all_methods[how], 2.5, 4, 4) == 3);
    }
    CHECK(isnan(value_at(none, &s, p[0])));
    dt_free(line);
    dt_free(one);
    dt_free(none);
}

/* Also where steps end the calls early. */
TEST(values_of_many_places_are_those_of_each)
{
    enum { N = 200, PLACES = 150 };
    struct dt_point p[N], q[PLACES];
    double got[PLACES];
    size_t done;
    make_values();
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(20), test_below(20)};
    for (int i = 0; i < PLACES; i++)
        q[i] = (struct dt_point){test_below(44) / 2.0 - 1, test_uniform() * 20};
    for (uint32_t n = 0; n <= N; n += n < 4 ? 1 : N - 4) {
        struct dt *t = set_of(p, n);
        for (int how = 0; how < METHODS; how++) {
            struct dt_surface s = surface_of(all_methods[how]);
            for (size_t at = 0; at < PLACES; at += done) {
                struct dt_options few = {.steps = at == 0 ? 100000 : 700};
                size_t most = at == 0 ? PLACES / 2 : PLACES - at;
                enum dt_status status = dt_values(t, &s, q + at, most, &few, got + at, &done);
                CHECK((status == DT_OK && done == most) || (status == DT_TOOLONG && done > 0));
            }
            for (int i = 0; i < PLACES; i++)
                check_same(got[i], value_at(t, &s, q[i]), q[i]);
        }
        dt_free(t);
    }
}

/* The surfaces of one search, each alone; enough places that data is kept from one to the next. */
static void check_several(const struct dt *t, enum dt_interpolation how, const struct dt_point *q,
                          const struct dt_raster *cells, size_t n)
{
    enum { SURFACES = 3 };
    struct dt_surface s[SURFACES];
    double *got = malloc(n * SURFACES * sizeof *got), *want = malloc(n * sizeof *want);
    size_t done;
    CHECK(got != NULL && want != NULL);
    for (int k = 0; k < SURFACES; k++) {
        s[k] = (struct dt_surface){.how = how, .max_edge = HUGE_VAL, .beyond = true};
        s[k].next = k + 1 < SURFACES ? &s[k + 1] : NULL;
        CHECK(dt_surface_begin(&s[k], dt_field_find(t, &"xyz"[k], 1), NULL) == DT_OK);
    }
    CHECK((cells != NULL ? dt_raster_values(t, s, cells, 0, n, NULL, got, &done)
                         : dt_values(t, s, q, n, NULL, got, &done)) == DT_OK);
    for (int k = 0; k < SURFACES; k++) {
        s[k].next = NULL;
        CHECK((cells != NULL ? dt_raster_values(t, &s[k], cells, 0, n, NULL, want, &done)
                             : dt_values(t, &s[k], q, n, NULL, want, &done)) == DT_OK);
        for (size_t i = 0; i < n; i++)
            check_same(got[i * SURFACES + (size_t)k], want[i],
                       cells != NULL ? dt_raster_centre(cells, i) : q[i]);
        dt_surface_end(&s[k]);
    }
    free(got);
    free(want);
}

TEST(values_of_several_surfaces_are_those_of_each)
{
    enum { N = 300, SIDE = 40, PLACES = SIDE * SIDE };
    static struct dt_point p[N], q[PLACES];
    static double z[N];
    const struct dt_raster cells = {{-1, -1}, {21, 21}, SIDE, SIDE};
    uint32_t missing;
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(20), test_below(20)};
    for (int i = 0; i < PLACES; i++)
        q[i] = (struct dt_point){test_below(44) / 2.0 - 1, test_uniform() * 20};
    struct dt *t = set_of(p, N);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < N; i++)
            z[i] = test_below(12) == 0 ? (double)NAN : test_uniform() * pow(1000, k);
        CHECK(dt_field_set_run(t, &"xyz"[k], 1, 0, z, N, NULL, &missing) == DT_OK);
    }
    for (int how = 0; how <= METHODS; how++) {
        check_several(t, all_methods[how], q, NULL, PLACES);
        check_several(t, all_methods[how], q, &cells, PLACES);
    }
    dt_free(t);
}

TEST(values_need_a_triangulation)
{
    struct dt *t = dt_new(0);
    struct dt_surface s = surface_of(DT_LINEAR);
    struct dt_point q = {0, 0};
    double out;
    size_t done;
    CHECK(dt_values(t, &s, &q, 1, NULL, &out, &done) == DT_UNTRIANGULATED && done == 0);
    dt_free(t);
}
