/* values_test.c - values of surfaces at places and at cells of rasters. */
#include "core/delaunay_surface.h"
#include "tests/core/sets.h"
#include "tests/core/threads.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const enum dt_interpolation all[] = {DT_LINEAR, DT_NATURAL, DT_LAPLACE, DT_CLOSEST};
enum { METHODS = 4 };

/* Pages of values, by id; of the ids beyond them they are missing. */
enum { PAGES = 60 };
static double random_values[PAGES + 1][DT_FIELD_PAGE];

static void make_values(void)
{
    for (int i = 0; i <= PAGES; i++)
        for (int k = 0; k < DT_FIELD_PAGE; k++)
            random_values[i][k] = i == PAGES ? (double)NAN : 1000 + test_uniform();
}

static double value_of(uint32_t id)
{
    return random_values[id / DT_FIELD_PAGE][id % DT_FIELD_PAGE];
}

static struct dt_surface surface_of(enum dt_interpolation how)
{
    static const double *page[PAGES + 1];
    for (int i = 0; i <= PAGES; i++)
        page[i] = random_values[i];
    return (struct dt_surface){page, PAGES, how, HUGE_VAL};
}

/* A set with values of its points in the field z; nan: none. */
static struct dt *set_with(const struct dt_point *p, const double *z, uint32_t n)
{
    uint32_t missing;
    struct dt *t = set_of(p, n);
    CHECK(dt_field_set_run(t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
    return t;
}

/* The surface of its field z, to be ended. */
static struct dt_surface surface_in(const struct dt *t, enum dt_interpolation how)
{
    struct dt_surface s = {.how = how, .max_edge = HUGE_VAL};
    CHECK(dt_surface_begin(&s, dt_field_find(t, "z", 1), NULL) == DT_OK);
    return s;
}

static double value_at(const struct dt *t, const struct dt_surface *s, struct dt_point q)
{
    double value;
    size_t done;
    CHECK(dt_values(t, s, &q, 1, NULL, &value, &done) == DT_OK && done == 1);
    return value;
}

static void check_same(double got, double want, struct dt_point q)
{
    CHECK_MSG(memcmp(&got, &want, sizeof got) == 0 || (isnan(got) && isnan(want)),
              "%.17g instead of %.17g at %.17g %.17g", got, want, q.x, q.y);
}

/* The value of the field z at x y. */
static double value_in(const struct dt *t, enum dt_interpolation how, double max_edge, double x,
                       double y)
{
    struct dt_surface s = surface_in(t, how);
    s.max_edge = max_edge;
    double value = value_at(t, &s, (struct dt_point){x, y});
    dt_surface_end(&s);
    return value;
}

/* ---- at places ---- */

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
            check_mean(pair->t, random_place(pair->b), all[how]);
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
            struct dt_surface s = surface_of(all[how]);
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
        double got = value_in(t, all[i % METHODS], HUGE_VAL, test_uniform(), test_uniform());
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
        double got = value_in(t, all[how], HUGE_VAL, 1, 0.5);
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
        s = surface_in(t, all[how]);
        r = surface_in(u, all[how]);
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

/* Two unit squares, far apart: what is between them has long edges. */
TEST(values_are_missing_in_triangles_with_long_edges)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0},  {1, 1},  {0, 1},
                                        {9, 0}, {10, 0}, {10, 1}, {9, 1}};
    static const double z[] = {0, 1, 2, 3, 4, 5, 6, 7};
    struct dt *t = set_with(p, z, 8);
    for (int how = 0; how < METHODS; how++) {
        double edge = sqrt(2);
        CHECK(!isnan(value_in(t, all[how], edge, 0.25, 0.5)));
        CHECK(!isnan(value_in(t, all[how], edge, 1, 0.5)));
        CHECK(value_in(t, all[how], edge, 9, 0) == 4);
        CHECK(isnan(value_in(t, all[how], edge, 1.25, 0.5)));
        CHECK(isnan(value_in(t, all[how], edge, 5, 0)));
        CHECK(isnan(value_in(t, all[how], 1.25, 0.25, 0.5)));
        CHECK(value_in(t, all[how], 1.25, 9, 0) == 4);
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
        bool near = all[how] == DT_CLOSEST;
        CHECK(value_in(line, all[how], HUGE_VAL, 3.5, 3.5) == (near ? 3 : 4));
        CHECK(isnan(value_in(line, all[how], HUGE_VAL, 3, 2)));
        CHECK(isnan(value_in(line, all[how], HUGE_VAL, 5, 5)));
        CHECK(value_in(one, all[how], HUGE_VAL, 0, 0) == 1);
        CHECK(isnan(value_in(one, all[how], HUGE_VAL, 4, 4)));
        CHECK(isnan(value_in(line, all[how], 2.5, 3.5, 3.5)));
        CHECK(value_in(line, all[how], 2.5, 4, 4) == 3);
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
            struct dt_surface s = surface_of(all[how]);
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

/* ---- at cells ---- */

enum { MOST_CELLS = 1024 };

/* By calls that may take a few steps only; a cell that takes more by itself is computed without a limit. */
static void check_by_steps(const struct dt *t, const struct dt_surface *s,
                           const struct dt_raster *r, size_t n, const double *want)
{
    double got[MOST_CELLS];
    for (size_t at = 0, done; at < n; at += done) {
        struct dt_options few = {.steps = 200 + test_below(5000)};
        enum dt_status status = dt_raster_values(t, s, r, at, n - at, &few, got + at, &done);
        CHECK(status == DT_TOOLONG || (status == DT_OK && done == n - at));
        if (status == DT_TOOLONG && done == 0)
            CHECK(dt_raster_values(t, s, r, at, 1, NULL, got + at, &done) == DT_OK && done == 1);
    }
    for (size_t i = 0; i < n; i++)
        check_same(got[i], want[i], dt_raster_centre(r, i));
}

static void check_cells(const struct dt *t, const struct dt_surface *s, const struct dt_raster *r)
{
    double at_once[MOST_CELLS], in_pieces[MOST_CELLS], one;
    size_t n = (size_t)r->columns * r->rows, done;
    CHECK(n <= MOST_CELLS && dt_raster_values(t, s, r, 0, n, NULL, at_once, &done) == DT_OK &&
          done == n);
    for (size_t at = 0; at < n; at += done) {
        size_t piece = 1 + test_below((uint32_t)(n - at));
        CHECK(dt_raster_values(t, s, r, at, piece, NULL, in_pieces + at, &done) == DT_OK);
        CHECK(done == piece);
    }
    if (r->columns > 100 || test_below(3) == 0)
        check_by_steps(t, s, r, n, at_once);
    for (size_t i = 0; i < n; i++) {
        struct dt_point q = dt_raster_centre(r, i);
        CHECK(dt_values(t, s, &q, 1, NULL, &one, &done) == DT_OK);
        check_same(at_once[i], one, q);
        check_same(in_pieces[i], one, q);
    }
}

static struct dt_raster random_raster(const struct brute *b)
{
    struct dt_point p = random_place(b), q = random_place(b);
    return (struct dt_raster){{fmin(p.x, q.x), fmin(p.y, q.y)},
                              {fmax(p.x, q.x), fmax(p.y, q.y)},
                              1 + test_below(20),
                              1 + test_below(20)};
}

static void check_rasters(const struct pair *pair)
{
    make_values();
    for (int i = 0; i < 4; i++) {
        struct dt_surface s = surface_of(all[test_below(METHODS)]);
        struct dt_raster r = random_raster(pair->b);
        if (test_below(3) == 0)
            s.max_edge = hypot(r.hi.x - r.lo.x, r.hi.y - r.lo.y);
        if (s.max_edge > 0)
            check_cells(pair->t, &s, &r);
    }
}

TEST_TIMEOUT(cells_have_the_values_at_their_centres_on_every_family, 120)
{
    for_each_pair(check_rasters);
}

/* Cells whose centres are points, middles of edges and places on edges. */
TEST(cells_of_a_lattice_have_the_values_at_their_centres)
{
    struct dt_point p[64];
    make_values();
    for (int i = 0; i < 64; i++)
        p[i] = (struct dt_point){i % 8, i / 8};
    struct dt *t = set_of(p, 64);
    for (int how = 0; how < METHODS; how++) {
        struct dt_surface s = surface_of(all[how]);
        check_cells(t, &s, &(struct dt_raster){{-1.5, -1.5}, {8.5, 8.5}, 10, 10});
        check_cells(t, &s, &(struct dt_raster){{-1.25, -1.25}, {8.75, 8.75}, 20, 20});
        check_cells(t, &s, &(struct dt_raster){{3, 3}, {3, 3}, 3, 2});
        check_cells(t, &s, &(struct dt_raster){{0, 0}, {7, 7}, 1, 1000});
        check_cells(t, &s, &(struct dt_raster){{0, 0}, {7, 7}, 1000, 1});
        check_cells(t, &s, &(struct dt_raster){{-0.5, 2.5}, {7.5, 3.5}, 200, 1});
    }
    dt_free(t);
}

/* Rows along edges, cells on edges and at points, and columns at one place, after cells that are in triangles. */
TEST(cells_on_edges_have_the_values_at_their_centres)
{
    enum { N = 30 };
    struct dt_point p[N];
    struct dt_surface s = surface_of(DT_LINEAR);
    make_values();
    for (int i = 0; i < 100; i++) {
        double x = test_below(15) / 2.0;
        for (int k = 0; k < N; k++)
            p[k] = (struct dt_point){test_below(8), test_below(8)};
        struct dt *t = set_of(p, N);
        s.max_edge = i % 2 == 0 ? HUGE_VAL : 1.5;
        check_cells(t, &s, &(struct dt_raster){{0.1, -0.5}, {6.9, 7.5}, 19, 8});
        check_cells(t, &s, &(struct dt_raster){{-0.25, -0.25}, {7.75, 7.75}, 16, 16});
        check_cells(t, &s, &(struct dt_raster){{x, -0.25}, {x, 7.75}, 3, 16});
        dt_free(t);
    }
}

/* More columns or rows than go together, and more triangles between two cells than are walked. */
TEST(cells_of_wide_and_of_sparse_rasters_have_the_values_at_their_centres)
{
    enum { N = 30000 };
    static struct dt_point p[N];
    make_values();
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
    struct dt *few = set_of(p, 100), *many = set_of(p, N);
    struct dt_surface s = surface_of(DT_LINEAR);
    check_cells(few, &s, &(struct dt_raster){{-0.125, 0}, {1.125, 1}, 600, 1});
    check_cells(few, &s, &(struct dt_raster){{-0.125, 0.25}, {1.125, 0.75}, 300, 3});
    check_cells(many, &s, &(struct dt_raster){{0, 0}, {1, 1}, 10, 20});
    check_cells(many, &s, &(struct dt_raster){{0, 0}, {1, 1}, 3, 9});
    for (int how = 0; how < METHODS; how++) {
        s = surface_of(all[how]);
        check_cells(few, &s, &(struct dt_raster){{-0.125, 0.25}, {1.125, 0.75}, 150, 6});
        check_cells(few, &s, &(struct dt_raster){{0.25, -0.125}, {0.75, 1.125}, 7, 140});
    }
    dt_free(few);
    dt_free(many);
}

TEST(cells_are_in_rows_from_the_north)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {0, 2}, {2, 2}};
    static const double z[] = {0, 1, 10, 11};
    struct dt *t = set_with(p, z, 4);
    struct dt_surface s = surface_in(t, DT_LINEAR);
    struct dt_raster r = {{0, 0}, {2, 2}, 2, 2};
    double out[4];
    size_t done;
    CHECK(dt_raster_values(t, &s, &r, 0, 4, NULL, out, &done) == DT_OK);
    CHECK(out[0] == 7.75 && out[1] == 8.25 && out[2] == 2.75 && out[3] == 3.25);
    dt_surface_end(&s);
    dt_free(t);
}

/* The same points in another order: other vertices, other half edges. */
TEST(cells_have_the_same_bytes_after_other_histories)
{
    enum { N = 300 };
    struct dt_point p[N];
    make_values();
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(30), test_below(30)};
    struct dt *at_once = set_of(p, N), *one_by_one = dt_new(0);
    struct dt_added added;
    CHECK(dt_triangulate(one_by_one, NULL) == DT_OK);
    for (int i = 0; i < N; i++)
        CHECK(dt_add(one_by_one, &p[i], 1, &added) == DT_OK);
    CHECK(dt_refresh(one_by_one, NULL) == DT_OK);
    for (int how = 0; how < METHODS; how++) {
        struct dt_surface s = surface_of(all[how]);
        struct dt_raster r = {{-1, -1}, {test_below(2) ? 31 : 30.3, 31}, 64, 63};
        static double a[64 * 63], b[64 * 63];
        size_t done;
        CHECK(dt_raster_values(at_once, &s, &r, 0, 64 * 63, NULL, a, &done) == DT_OK);
        CHECK(dt_raster_values(one_by_one, &s, &r, 0, 64 * 63, NULL, b, &done) == DT_OK);
        for (uint32_t i = 0; i < 64 * 63; i++)
            check_same(a[i], b[i], dt_raster_centre(&r, i));
    }
    dt_free(at_once);
    dt_free(one_by_one);
}

TEST(cells_take_no_more_steps_than_they_may_and_go_on)
{
    enum { N = 3000 };
    static struct dt_point p[N];
    static double z[N], got[400], want[400];
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){cos(i * 2 * M_PI / N), sin(i * 2 * M_PI / N)};
        z[i] = test_uniform();
    }
    struct dt *t = set_with(p, z, N);
    struct dt_raster r = {{-1, -1}, {1, 1}, 4, 4};
    for (int how = 0; how < METHODS; how++) {
        struct dt_surface s = surface_in(t, all[how]);
        struct dt_options few = {.steps = 1000};
        size_t done, at = 0;
        CHECK(dt_raster_values(t, &s, &r, 0, 16, NULL, want, &done) == DT_OK);
        enum dt_status status = DT_TOOLONG;
        for (few.steps = 1000; status == DT_TOOLONG; few.steps *= 2) {
            status = dt_raster_values(t, &s, &r, at, 16 - at, &few, got + at, &done);
            at += done;
        }
        CHECK(status == DT_OK && at == 16 && memcmp(got, want, sizeof got[0] * 16) == 0);
        dt_surface_end(&s);
    }
    dt_free(t);
}

TEST(cells_have_the_same_bytes_on_any_number_of_threads)
{
    enum { N = 500, SIDE = 90 };
    static struct dt_point p[N];
    static double z[N], one[SIDE * SIDE], many[SIDE * SIDE];
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
        z[i] = test_uniform();
    }
    struct dt *t = set_with(p, z, N);
    struct dt_raster r = {{0, 0}, {1, 1}, SIDE, SIDE};
    for (int how = 0; how < METHODS; how++) {
        struct dt_surface s = surface_in(t, all[how]);
        for (unsigned threads = 2; threads <= 3; threads++) {
            struct dt_pool pool = threads_pool(threads);
            struct dt_options opt = {.pool = &pool};
            size_t done;
            CHECK(dt_raster_values(t, &s, &r, 7, SIDE * SIDE - 7, NULL, one, &done) == DT_OK);
            CHECK(dt_raster_values(t, &s, &r, 7, SIDE * SIDE - 7, &opt, many, &done) == DT_OK);
            CHECK(done == SIDE * SIDE - 7);
            for (uint32_t i = 0; i < SIDE * SIDE - 7; i++)
                check_same(many[i], one[i], dt_raster_centre(&r, i + 7));
        }
        dt_surface_end(&s);
    }
    dt_free(t);
}

TEST(cells_can_be_cancelled)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    struct dt *t = set_of(p, 4);
    atomic_bool cancel = true;
    struct dt_options opt = {.cancel = &cancel};
    struct dt_surface s = surface_of(DT_NATURAL);
    struct dt_raster r = {{0, 0}, {2, 2}, 100, 100};
    double out[1];
    size_t done;
    CHECK(dt_raster_values(t, &s, &r, 0, 10000, &opt, out, &done) == DT_CANCELLED && done == 0);
    CHECK(dt_values(t, &s, p, 1, &opt, out, &done) == DT_CANCELLED && done == 0);
    dt_free(t);
}

TEST(cells_survive_without_memory)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0x1p-45}, {1, 1}};
    struct dt *t = set_of(p, 6);
    static double out[2000];
    make_values();
    for (int how = 0; how < METHODS; how++) {
        enum dt_status status = DT_NOMEM;
        struct dt_surface s = surface_of(all[how]);
        struct dt_raster r = {{0, 0}, {2, 2}, 40, 40};
        size_t done;
        for (long n = 1; status == DT_NOMEM; n++) {
            test_fail_alloc(n);
            status = dt_raster_values(t, &s, &r, 0, 1600, NULL, out, &done);
            CHECK(test_alloc_failed() == (status == DT_NOMEM));
        }
        test_fail_alloc(0);
        CHECK(status == DT_OK && done == 1600);
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
