/* contour_test.c - contours: closed or from border to border, the higher ground on the left, never across each
 * other. */
#include "core/delaunay_surface.h"
#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct lines {
    struct dt_contour *c;
    const struct dt_contour_line *line;
    size_t n;
};

static enum dt_status try_lines(const struct dt *t, const struct dt_view *v, const double *level,
                                uint32_t levels, double max_edge, struct lines *r)
{
    bool done = false;
    *r = (struct lines){NULL, NULL, 0};
    enum dt_status s =
        dt_contour_begin(t, v, dt_field_find(t, "z", 1), level, levels, max_edge, &r->c);
    while (s == DT_OK && !done)
        s = dt_contour_read(t, r->c, &done);
    return s == DT_OK ? dt_contour_end(r->c, NULL, &r->line, &r->n) : s;
}

static struct lines lines_of(const struct dt *t, const double *level, uint32_t levels,
                             double max_edge)
{
    struct lines r;
    CHECK(try_lines(t, NULL, level, levels, max_edge, &r) == DT_OK);
    return r;
}

static void set_values(struct dt *t, const double *z, uint32_t n)
{
    uint32_t missing;
    CHECK(dt_field_set_run(t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
}

static struct dt *set_with(const struct dt_point *p, const double *z, uint32_t n)
{
    struct dt *t = set_of(p, n);
    set_values(t, z, n);
    return t;
}

static void check_line(const struct dt_contour_line *line, bool closed, const struct dt_point *p,
                       size_t n)
{
    CHECK(line->closed == closed && line->n == n);
    for (size_t i = 0; i < n; i++)
        CHECK_MSG(line->p[i].x == p[i].x && line->p[i].y == p[i].y, "place %zu is %g %g", i,
                  line->p[i].x, line->p[i].y);
}

static void check_equal(const struct lines *a, const struct lines *b)
{
    CHECK(a->n == b->n);
    for (size_t i = 0; i < a->n; i++) {
        CHECK(a->line[i].level == b->line[i].level);
        check_line(&a->line[i], b->line[i].closed, b->line[i].p, b->line[i].n);
    }
}

/* ---- single lines ---- */

TEST(contour_around_a_peak_is_closed_and_counterclockwise)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 1}, level[] = {0.5};
    static const struct dt_point want[] = {{1, 1}, {3, 1}, {3, 3}, {1, 3}};
    struct dt *t = set_with(p, z, 5);
    struct lines r = lines_of(t, level, 1, HUGE_VAL);
    CHECK(r.n == 1 && r.line[0].level == 0.5);
    check_line(&r.line[0], true, want, 4);
    dt_contour_free(r.c);
    dt_free(t);
}

TEST(contour_across_the_hull_has_the_higher_ground_on_its_left)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}}, want[] = {{2, 0}, {2, 2}};
    static const double z[] = {2, 0, 2}, level[] = {1};
    struct dt *t = set_with(p, z, 3);
    struct lines r = lines_of(t, level, 1, HUGE_VAL);
    CHECK(r.n == 1);
    check_line(&r.line[0], false, want, 2);
    dt_contour_free(r.c);
    dt_free(t);
}

TEST(contour_along_the_border_of_a_plateau_goes_through_its_points)
{
    static const struct dt_point p[] = {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {2, 2}, {4, 2}, {3, 4}};
    static const double z[] = {0, 0, 0, 0, 1, 1, 1}, level[] = {1};
    static const struct dt_point want[] = {{2, 2}, {4, 2}, {3, 4}};
    struct dt *t = set_with(p, z, 7);
    struct lines r = lines_of(t, level, 1, HUGE_VAL);
    CHECK(r.n == 1);
    check_line(&r.line[0], true, want, 3);
    dt_contour_free(r.c);
    dt_free(t);
}

TEST(contour_of_one_place_is_left_out)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 1}, level[] = {0, 1, 2};
    struct dt *t = set_with(p, z, 5);
    struct lines r = lines_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 0);
    dt_contour_free(r.c);
    dt_free(t);
}

TEST(contours_end_where_values_are_missing_and_where_edges_are_long)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {4, 0}, {0, 2}, {2, 2}, {4, 2}};
    double z[] = {0, 0, 0, 2, 2, (double)NAN};
    static const double level[] = {1};
    struct dt *t = set_with(p, z, 6);
    struct lines r = lines_of(t, level, 1, HUGE_VAL);
    CHECK(r.n == 1 && !r.line[0].closed);
    double least = 4;
    for (size_t i = 0; i < r.line[0].n; i++)
        least = fmin(least, r.line[0].p[i].x);
    CHECK(least == 0 && r.line[0].p[r.line[0].n - 1].x <= 3);
    dt_contour_free(r.c);
    z[5] = 2;
    set_values(t, z, 6);
    r = lines_of(t, level, 1, 2);
    CHECK(r.n == 0);
    dt_contour_free(r.c);
    r = lines_of(t, level, 1, sqrt(8));
    CHECK(r.n == 1 && r.line[0].n == 5);
    dt_contour_free(r.c);
    dt_free(t);
}

static bool has_place(const struct lines *r, double level, struct dt_point p)
{
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; r->line[i].level == level && k < r->line[i].n; k++)
            if (r->line[i].p[k].x == p.x && r->line[i].p[k].y == p.y)
                return true;
    return false;
}

TEST(contours_that_end_at_missing_values_have_no_place_of_their_own)
{
    enum { N = 4 * DT_FIELD_PAGE, WITH = DT_FIELD_PAGE }; /* so ids have no page, too */
    static const double level[] = {0.2, 0.4, 0.7};
    struct dt_point p[N];
    double z[N];
    size_t places = 0;
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){1 + test_uniform() * (i < WITH ? 0.6 : 1), 1 + test_uniform()};
        z[i] = test_uniform();
    }
    struct dt *all = set_with(p, z, N), *some = set_of(p, N);
    set_values(some, z, WITH);
    struct lines whole = lines_of(all, level, 3, HUGE_VAL),
                 part = lines_of(some, level, 3, HUGE_VAL);
    for (size_t i = 0; i < part.n; i++)
        for (size_t k = 0; k < part.line[i].n; k++, places++)
            CHECK(has_place(&whole, part.line[i].level, part.line[i].p[k]));
    CHECK(places > 20);
    dt_contour_free(whole.c);
    dt_contour_free(part.c);
    dt_free(all);
    dt_free(some);
}

TEST(contours_of_sets_without_triangles)
{
    static const struct dt_point p[] = {{0, 0}, {2, 2}, {4, 4}};
    static const double z[] = {0, 1, 2}, level[] = {0.5, 1.5};
    for (uint32_t n = 1; n <= 3; n++) {
        struct dt *t = set_with(p, z, n);
        struct lines r = lines_of(t, level, 2, HUGE_VAL);
        CHECK(r.n == 0);
        dt_contour_free(r.c);
        dt_free(t);
    }
}

TEST(contours_of_more_levels_than_a_piece_has_crossings)
{
    enum { LEVELS = 30000 };
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}};
    static const double z[] = {0, 0, LEVELS};
    static double level[LEVELS];
    for (int i = 0; i < LEVELS; i++)
        level[i] = i + 1;
    struct dt *t = set_with(p, z, 3);
    struct lines r = lines_of(t, level, LEVELS, HUGE_VAL);
    CHECK(r.n == LEVELS - 1); /* that of the highest is one place */
    for (size_t i = 0; i < r.n; i++)
        CHECK(r.line[i].level == level[i] && r.line[i].n == 2);
    dt_contour_free(r.c);
    dt_free(t);
}

TEST(contours_of_the_largest_magnitudes_are_between_their_ends)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}};
    static const double z[] = {-1.7e308, -1.7e308, 1.7e308}, level[] = {-1e308, 0, 1e308};
    struct dt *t = set_with(p, z, 3);
    struct lines r = lines_of(t, level, 3, HUGE_VAL);
    CHECK(r.n == 3 && r.line[1].p[0].y == 2);
    for (size_t i = 1; i < 3; i++)
        CHECK(r.line[i].p[0].y > r.line[i - 1].p[0].y);
    dt_contour_free(r.c);
    dt_free(t);
}

/* ---- all lines ---- */

/* < 0, 0 or > 0, exact for small multiples of a power of 2. */
static int side(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double d = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return (d > 0) - (d < 0);
}

static bool cross(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

static size_t sides_of(const struct dt_contour_line *l)
{
    return l->closed ? l->n : l->n - 1;
}

static void check_no_crossing(const struct dt_contour_line *k, const struct dt_contour_line *l)
{
    for (size_t i = 0; i < sides_of(k); i++)
        for (size_t j = 0; j < sides_of(l); j++)
            CHECK(!cross(k->p[i], k->p[(i + 1) % k->n], l->p[j], l->p[(j + 1) % l->n]));
}

static double value_at(const struct dt *t, const struct dt_surface *s, double x, double y)
{
    struct dt_point q = {x, y};
    double z;
    size_t done;
    CHECK(dt_values(t, s, &q, 1, NULL, &z, &done) == DT_OK);
    return z;
}

/* Whether the lines go along a ridge of no width, there and back. */
static bool is_ridge(const struct lines *r, double level, struct dt_point a, struct dt_point b)
{
    for (size_t i = 0; i < r->n; i++) {
        const struct dt_contour_line *l = &r->line[i];
        for (size_t k = 0; k < sides_of(l); k++) {
            struct dt_point c = l->p[k], d = l->p[(k + 1) % l->n];
            if (l->level == level && a.x == d.x && a.y == d.y && b.x == c.x && b.y == c.y)
                return true;
        }
    }
    return false;
}

/* Left of the middle of each side the ground is not lower than the level, right of it not higher; and both ends of
 * an open line are on the hull. */
static void check_sides(const struct dt *t, const struct dt_surface *s, const struct lines *r,
                        const struct dt_contour_line *l)
{
    for (size_t i = 0; i < sides_of(l); i++) {
        struct dt_point a = l->p[i], b = l->p[(i + 1) % l->n];
        double x = (a.x + b.x) / 2, y = (a.y + b.y) / 2, dx = 0x1p-20 * (b.x - a.x),
               dy = 0x1p-20 * (b.y - a.y);
        double left = value_at(t, s, x - dy, y + dx), right = value_at(t, s, x + dy, y - dx);
        CHECK(isnan(left) || left >= l->level || is_ridge(r, l->level, a, b));
        CHECK(isnan(right) || right <= l->level);
    }
    for (int end = 0; end < 2 && !l->closed; end++) {
        struct dt_point p = l->p[end == 0 ? 0 : l->n - 1];
        CHECK(p.x == 0 || p.y == 0 || p.x == 7 || p.y == 7);
    }
}

/* Values of a few powers of 2 on a lattice: plateaus and saddles, and exact places. */
TEST_TIMEOUT(contours_of_plateaus_and_saddles_never_cross, 60)
{
    enum { N = 64 };
    static const double heights[] = {0, 1, 2, 4}, level[] = {0.5, 1, 1.5, 2, 3, 4};
    for (int round = 0; round < 60; round++) {
        struct dt_point p[N];
        double z[N];
        for (int i = 0; i < N; i++) {
            p[i] = (struct dt_point){i % 8, i / 8};
            z[i] = heights[test_below(2 + (uint32_t)round % 3)];
        }
        struct dt *t = set_with(p, z, N);
        struct dt_surface s = {.how = DT_LINEAR, .max_edge = HUGE_VAL};
        CHECK(dt_surface_begin(&s, dt_field_find(t, "z", 1), NULL) == DT_OK);
        struct lines r = lines_of(t, level, 6, HUGE_VAL);
        for (size_t i = 0; i < r.n; i++) {
            check_sides(t, &s, &r, &r.line[i]);
            for (size_t k = 0; k <= i; k++)
                check_no_crossing(&r.line[i], &r.line[k]);
        }
        dt_surface_end(&s);
        dt_contour_free(r.c);
        dt_free(t);
    }
}

/* The sides of lines, also sides of length 0, are as many as triangles with corners above and below. */
static void check_counts(const struct pair *pair)
{
    enum { MOST = 64 };
    double z[MOST], level = 0.5;
    uint32_t n = dt_next_id(pair->t), missing;
    struct dt_ids triangles = {0};
    size_t crossed = 0, sides = 0;
    struct lines r;
    if (n == 0)
        return;
    for (uint32_t i = 0; i < n; i++) {
        struct dt_point p;
        z[i] = dt_get(pair->t, i, &p) == DT_OK ? (double)test_below(2) : (double)NAN;
    }
    CHECK(dt_field_set_run(pair->t, "z", 1, 0, z, n, NULL, &missing) == DT_OK);
    CHECK(try_lines(pair->t, NULL, &level, 1, HUGE_VAL, &r) == DT_OK);
    brute_table(pair->b, DT_TRIANGLES, false, &triangles);
    for (size_t i = 0; i < triangles.n; i += 3) {
        const uint32_t *v = triangles.v + i;
        crossed += z[v[0]] != z[v[1]] || z[v[1]] != z[v[2]];
    }
    for (size_t i = 0; i < r.n; i++)
        sides += sides_of(&r.line[i]);
    CHECK_MSG(sides <= crossed, "%zu sides in %zu triangles", sides, crossed);
    CHECK(sides > 0 || r.n == 0);
    free(triangles.v);
    dt_contour_free(r.c);
}

TEST_TIMEOUT(contours_have_no_more_sides_than_triangles_on_every_family, 60)
{
    for_each_pair(check_counts);
}

TEST(contours_have_the_same_bytes_after_other_histories)
{
    enum { N = 300 };
    static const double level[] = {10, 20, 30.5, 40};
    struct dt_point p[N];
    double z[N];
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){test_below(30), test_below(30)};
        z[i] = test_below(50);
    }
    struct dt *at_once = set_with(p, z, N), *one_by_one = set_of_each(p, N);
    set_values(one_by_one, z, N);
    struct lines a = lines_of(at_once, level, 4, HUGE_VAL),
                 b = lines_of(one_by_one, level, 4, HUGE_VAL);
    CHECK(a.n > 4);
    check_equal(&a, &b);
    dt_contour_free(a.c);
    dt_contour_free(b.c);
    dt_free(at_once);
    dt_free(one_by_one);
}

TEST(contours_of_a_view_are_those_of_its_moment)
{
    enum { N = 200 };
    static const double level[] = {10, 20, 30};
    struct dt_point p[N];
    double z[N];
    struct lines r;
    uint32_t n, missing;
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
        z[i] = test_below(50);
    }
    struct dt *t = set_with(p, z, N);
    struct lines before = lines_of(t, level, 3, HUGE_VAL);
    struct dt_view *v = dt_view_begin(t, true);
    for (uint32_t i = 0; i < 40; i++) {
        CHECK(dt_move(t, i, (struct dt_point){test_uniform(), test_uniform()}) == DT_OK);
        uint32_t id = 40 + i, other = 80 + i;
        CHECK(dt_field_set(t, "z", 1, &id, &z[i], 1, NULL, &missing) == DT_OK);
        CHECK(dt_delete(t, &other, 1, &n, &missing) == DT_OK);
    }
    CHECK(dt_refresh(t, NULL) == DT_OK);
    CHECK(try_lines(t, v, level, 3, HUGE_VAL, &r) == DT_OK);
    check_equal(&r, &before);
    dt_contour_free(r.c);
    dt_contour_free(before.c);
    dt_view_end(v);
    dt_free(t);
}

TEST(contours_that_an_edit_interrupts_are_those_of_the_moment_of_their_view)
{
    enum { N = 30000 };
    static const double level[] = {-0.5, 0, 0.25};
    struct dt_point *p = malloc(N * sizeof *p);
    double *z = malloc(N * sizeof *z);
    CHECK(p != NULL && z != NULL);
    for (int i = 0; i < N; i++) {
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
        z[i] = sin(7 * p[i].x) * cos(5 * p[i].y);
    }
    struct dt *t = set_with(p, z, N);
    struct lines before = lines_of(t, level, 3, HUGE_VAL);
    for (uint32_t pieces = 0, all = 9; pieces < all; pieces++) {
        struct lines r = {NULL, NULL, 0};
        struct dt_view *v = dt_view_begin(t, true);
        struct dt_point there, to = {test_uniform(), test_uniform()};
        bool done = false;
        CHECK(dt_contour_begin(t, v, dt_field_find(t, "z", 1), level, 3, HUGE_VAL, &r.c) == DT_OK);
        for (uint32_t i = 0; i < pieces && !done; i++)
            CHECK(dt_contour_read(t, r.c, &done) == DT_OK);
        all = done ? 0 : all;
        CHECK(dt_get(t, pieces, &there) == DT_OK);
        CHECK(dt_move(t, pieces, to) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        while (!done)
            CHECK(dt_contour_read(t, r.c, &done) == DT_OK);
        CHECK(dt_contour_end(r.c, NULL, &r.line, &r.n) == DT_OK);
        check_equal(&r, &before);
        CHECK(dt_move(t, pieces, there) == DT_OK && dt_refresh(t, NULL) == DT_OK);
        dt_contour_free(r.c);
        dt_view_end(v);
    }
    dt_contour_free(before.c);
    dt_free(t);
    free(p);
    free(z);
}

TEST(contours_survive_without_memory)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    static const double z[] = {0, 0, 0, 0, 1}, level[] = {0.25, 0.5};
    struct dt *t = set_with(p, z, 5);
    enum dt_status s = DT_NOMEM;
    for (long n = 1; s == DT_NOMEM; n++) {
        struct lines r;
        test_fail_alloc(n);
        s = try_lines(t, NULL, level, 2, HUGE_VAL, &r);
        CHECK(test_alloc_failed() == (s == DT_NOMEM));
        dt_contour_free(r.c);
    }
    test_fail_alloc(0);
    CHECK(s == DT_OK);
    dt_free(t);
}
