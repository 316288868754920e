/* raster_test.c - values of surfaces at the cells of rasters: those at their centres. */
#include "tests/core/sets.h"
#include "tests/core/surface/values.h"
#include "tests/core/threads.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
        struct dt_surface s = surface_of(all_methods[test_below(METHODS + 1)]);
        struct dt_raster r = random_raster(pair->b);
        s.beyond = test_below(2) == 0;
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
    for (int how = 0; how <= METHODS; how++) {
        struct dt_surface s = surface_of(all_methods[how]);
        s.beyond = true;
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
    for (int how = 0; how <= METHODS; how++) {
        s = surface_of(all_methods[how]);
        s.beyond = how % 2 == 0;
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

TEST(cells_have_the_same_bytes_after_other_histories)
{
    enum { N = 300 };
    struct dt_point p[N];
    make_values();
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(30), test_below(30)};
    struct dt *at_once = set_of(p, N), *one_by_one = set_of_each(p, N);
    for (int i = 0; i < 2 * METHODS; i++) {
        struct dt_surface s = surface_of(all_methods[i / 2]);
        struct dt_raster r = {{-1, -1}, {i % 2 == 0 ? 31 : 30.3, 31}, 64, 63};
        static double a[64 * 63], b[64 * 63];
        size_t done;
        CHECK(dt_raster_values(at_once, &s, &r, 0, 64 * 63, NULL, a, &done) == DT_OK);
        CHECK(dt_raster_values(one_by_one, &s, &r, 0, 64 * 63, NULL, b, &done) == DT_OK);
        for (uint32_t k = 0; k < 64 * 63; k++)
            check_same(a[k], b[k], dt_raster_centre(&r, k));
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
    for (int how = 0; how <= METHODS; how++) {
        struct dt_surface s = surface_in(t, all_methods[how]);
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
    for (int how = 0; how <= METHODS; how++) {
        struct dt_surface s = surface_in(t, all_methods[how]);
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
    for (int how = 0; how <= METHODS; how++) {
        enum dt_status status = DT_NOMEM;
        struct dt_surface s = surface_of(all_methods[how]);
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
