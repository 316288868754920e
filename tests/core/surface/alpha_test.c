/* alpha_test.c - alpha shapes: the edges between triangles that are in and the rest, as loops. */
#include "core/delaunay_surface.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t alpha(const struct dt *t, const struct dt_view *v, double radius, struct dt_ids *out)
{
    struct dt_alpha *a;
    size_t loops;
    bool done = false;
    CHECK(dt_alpha_begin(t, v, radius, &a) == DT_OK);
    while (!done)
        CHECK(dt_alpha_read(t, a, 70, &done) == DT_OK);
    size_t memory = dt_alpha_memory(a, 0);
    CHECK(dt_alpha_end(a, NULL, out, &loops) == DT_OK);
    CHECK(memory >= out->cap * sizeof *out->v);
    dt_alpha_free(a);
    return loops;
}

/* The edges with a triangle that is in on the left only, as a matrix. */
static bool *want_edges(const struct brute *b, double radius)
{
    struct dt_ids all = {0};
    bool *left = calloc((size_t)b->n * b->n + 1, 1);
    CHECK(left != NULL);
    brute_table(b, DT_TRIANGLES, false, &all);
    for (size_t i = 0; i < all.n; i += 3)
        for (int k = 0; k < 3; k++) {
            const uint32_t *v = all.v + i;
            if (dt_compare_circumradius(b->p[v[0]], b->p[v[1]], b->p[v[2]], radius) <= 0)
                left[v[k] * b->n + v[(k + 1) % 3]] = true;
        }
    for (uint32_t i = 0; i < b->n; i++)
        for (uint32_t k = 0; k < i; k++)
            if (left[i * b->n + k] && left[k * b->n + i])
                left[i * b->n + k] = left[k * b->n + i] = false;
    free(all.v);
    return left;
}

/* 0 where rounding hides its sign (dt_polygon_area). */
static double area_of(const struct brute *b, const uint32_t *id, uint32_t n)
{
    struct dt_point *p = malloc(n * sizeof *p);
    CHECK(p != NULL);
    for (uint32_t i = 0; i < n; i++)
        p[i] = b->p[id[i]];
    struct dt_box box = dt_box_of(p, n);
    double area = dt_polygon_area(p, n);
    double error = 0x1p-98 * n * dt_box_width(&box) * dt_box_height(&box);
    free(p);
    return fabs(area) <= 2 * error ? 0 : area;
}

static void check_loops(const struct pair *pair, double radius)
{
    const struct brute *b = pair->b;
    struct dt_ids rows = {0};
    bool *want = want_edges(b, radius);
    size_t loops = alpha(pair->t, NULL, radius, &rows), seen = 0;
    for (size_t at = 0; at < rows.n; seen++) {
        const uint32_t *id = rows.v + at + 2;
        uint32_t n = rows.v[at + 1];
        CHECK(n >= 3 && rows.v[at] <= 1);
        for (uint32_t i = 0; i < n; i++) {
            size_t edge = (size_t)id[i] * b->n + id[(i + 1) % n];
            CHECK_MSG(want[edge], "%u %u is not on the boundary, or twice", id[i], id[(i + 1) % n]);
            want[edge] = false;
            CHECK(i == 0 || id[i] > id[0]);
            for (uint32_t k = 0; k < i; k++)
                CHECK(id[k] != id[i]);
        }
        double area = area_of(b, id, n);
        CHECK(area == 0 || (area > 0) == (rows.v[at] == 0));
        at += 2 + n;
    }
    CHECK(seen == loops);
    for (size_t i = 0; i < (size_t)b->n * b->n; i++)
        CHECK(!want[i]);
    free(want);
    free(rows.v);
}

/* The radii of some triangles, of which rounded ones are near, and all. */
static void check_radii(const struct pair *pair)
{
    struct dt_ids all = {0};
    brute_table(pair->b, DT_TRIANGLES, false, &all);
    for (int i = 0; i < 8 && all.n > 0; i++) {
        const uint32_t *v = all.v + test_random() % (all.n / 3) * 3;
        struct dt_point a = pair->b->p[v[0]], b = pair->b->p[v[1]], c = pair->b->p[v[2]];
        double ab = hypot(a.x - b.x, a.y - b.y), bc = hypot(b.x - c.x, b.y - c.y);
        double ca = hypot(c.x - a.x, c.y - a.y), size;
        double r = ab * bc * ca / (2 * fabs(dt_orient2d_rounded(a, b, c, &size)));
        if (dt_coordinate_ok(r))
            check_loops(pair, r);
    }
    check_loops(pair, 0);
    check_loops(pair, 0x1p201);
    free(all.v);
}

TEST_TIMEOUT(loops_are_the_edges_between_triangles_in_and_out_on_every_family, 120)
{
    for_each_pair(check_radii);
}

static void check_row(const struct dt_ids *rows, size_t at, const char *want)
{
    char text[200] = "";
    for (uint32_t i = 0; i < rows->v[at + 1]; i++)
        sprintf(text + strlen(text), " %u", rows->v[at + 2 + i]);
    CHECK_STR(text + 1, want);
}

TEST(a_circumradius_that_is_exactly_the_radius_is_in)
{
    static const struct dt_point p[] = {{0, 0}, {6, 0}, {0, 8}}; /* radius 5 */
    struct dt *t = set_of(p, 3);
    struct dt_ids rows = {0};
    CHECK(alpha(t, NULL, nextafter(5, 0), &rows) == 0 && rows.n == 0);
    CHECK(alpha(t, NULL, 5, &rows) == 1 && rows.n == 5 && rows.v[0] == 0);
    check_row(&rows, 0, "0 1 2");
    free(rows.v);
    dt_free(t);
}

TEST(circumradii_of_the_widest_exponents_are_compared_exactly)
{
    double big = 0x1p200, small = 0x1p-142;
    struct dt_point a = {0, 0}, b = {big, 0}, c = {0, small};
    CHECK(dt_compare_circumradius(a, b, c, big / 2) > 0); /* half the hypotenuse */
    CHECK(dt_compare_circumradius(a, b, c, nextafter(big / 2, HUGE_VAL)) < 0);
    CHECK(dt_compare_circumradius((struct dt_point){-big, small}, (struct dt_point){big, small},
                                  (struct dt_point){0, big + 0}, big) != 0);
    for (int i = 0; i < 2000; i++) {
        struct dt_point p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (struct dt_point){ldexp(test_uniform(), (int)(test_random() % 300) - 140),
                                     ldexp(test_uniform(), (int)(test_random() % 300) - 140)};
        double r = ldexp(test_uniform(), (int)(test_random() % 300) - 140);
        if (dt_orient2d(p[0], p[1], p[2]) == 0)
            continue;
        CHECK(dt_compare_circumradius(p[0], p[1], p[2], r) ==
              dt_compare_circumradius(p[2], p[0], p[1], r));
    }
}

/* A square frame whose hole touches the outer boundary at a corner, and a triangle that touches it outside. */
TEST(loops_that_touch_in_a_point_are_cut_there)
{
    struct dt_point p[200];
    uint32_t n = 0;
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 12; k++)
            if (i < 3 || k < 3 || i > 8 || k > 8 || (i + k) % 5 == 0)
                p[n++] = (struct dt_point){i, k};
    struct pair pair = pair_of(p, n);
    for (double r = 0.6; r < 4; r += 0.05)
        check_loops(&pair, r);
    pair_free(&pair);
}

TEST(points_on_a_line_have_no_alpha_shape)
{
    static const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}};
    struct dt_ids rows = {0};
    for (uint32_t n = 0; n <= 3; n++) {
        struct dt *t = set_of(p, n);
        CHECK(alpha(t, NULL, 100, &rows) == 0 && rows.n == 0);
        dt_free(t);
    }
    free(rows.v);
}

TEST(an_alpha_shape_of_a_view_stays_as_it_was)
{
    struct dt_point p[300];
    uint32_t deleted, missing;
    for (int i = 0; i < 300; i++)
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
    struct dt *t = set_of(p, 300);
    struct dt_ids before = {0}, then = {0};
    CHECK(alpha(t, NULL, 0.05, &before) > 1);
    struct dt_view *v = dt_view_begin(t, true);
    for (uint32_t i = 0; i < 100; i++) {
        CHECK(dt_delete(t, &i, 1, &deleted, &missing) == DT_OK);
        CHECK(dt_move(t, i + 150, (struct dt_point){test_uniform(), test_uniform()}) == DT_OK);
    }
    alpha(t, v, 0.05, &then);
    check_equal_ids("rows", &then, &before);
    dt_view_end(v);
    free(before.v);
    free(then.v);
    dt_free(t);
}

/* ---- the radius by itself ---- */

static double automatic(const struct dt *t, const struct dt_view *v)
{
    struct dt_alpha_auto *a;
    bool done = false;
    double radius;
    CHECK(dt_alpha_auto_begin(t, v, &a) == DT_OK);
    while (!done)
        CHECK(dt_alpha_auto_read(t, a, &done) == DT_OK);
    CHECK(dt_alpha_auto_end(a, NULL, &radius) == DT_OK);
    dt_alpha_auto_free(a);
    return radius;
}

/* The triangles that come with a radius: whether they are one piece, through edges, with all points. */
static bool is_one_piece(const struct brute *b, const struct dt_ids *all, double radius)
{
    const size_t n = all->n / 3;
    bool *in = calloc(n + 1, 1), *seen = calloc(n + 1, 1), *corner = calloc(b->n + 1, 1);
    size_t *stack = calloc(n + 1, sizeof *stack), stacked = 0, count = 0, reached = 0;
    CHECK(in != NULL && seen != NULL && corner != NULL && stack != NULL);
    for (size_t i = 0; i < n; i++) {
        const uint32_t *v = all->v + 3 * i;
        in[i] = dt_compare_circumradius(b->p[v[0]], b->p[v[1]], b->p[v[2]], radius) <= 0;
        count += in[i];
        for (int k = 0; in[i] && k < 3; k++)
            corner[v[k]] = true;
        if (in[i] && stacked == 0 && reached == 0) {
            stack[stacked++] = i;
            seen[i] = true;
            reached = 1;
        }
    }
    while (stacked > 0) {
        const uint32_t *v = all->v + 3 * stack[--stacked];
        for (size_t i = 0; i < n; i++) {
            const uint32_t *w = all->v + 3 * i;
            int common = 0;
            for (int k = 0; k < 9; k++)
                common += v[k / 3] == w[k % 3];
            if (in[i] && !seen[i] && common == 2) {
                seen[i] = true;
                stack[stacked++] = i;
                reached++;
            }
        }
    }
    bool good = count > 0 && reached == count;
    for (size_t i = 0; i < all->n; i++)
        good = good && corner[all->v[i]]; /* every representative is a corner of some triangle */
    free(in);
    free(seen);
    free(corner);
    free(stack);
    return good;
}

/* The least double that is not less than the circumradius, by halves. */
static double radius_of(const struct brute *b, const uint32_t *v)
{
    double lo = 0, hi = 0x1p1000;
    while (nextafter(lo, HUGE_VAL) < hi) {
        double middle = lo > 0 && hi / lo > 4 ? sqrt(lo) * sqrt(hi)
                        : lo == 0             ? (hi > 0x1p-900 ? hi * 0x1p-100 : hi / 2)
                                              : lo + (hi - lo) / 2;
        middle = middle <= lo ? nextafter(lo, HUGE_VAL) : middle >= hi ? nextafter(hi, 0) : middle;
        if (dt_compare_circumradius(b->p[v[0]], b->p[v[1]], b->p[v[2]], middle) > 0)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

static void check_automatic(const struct pair *pair)
{
    struct dt_ids all = {0};
    double want = 0;
    brute_table(pair->b, DT_TRIANGLES, false, &all);
    for (size_t i = 0; i < all.n; i += 3) {
        double radius = radius_of(pair->b, all.v + i);
        if ((want == 0 || radius < want) && is_one_piece(pair->b, &all, radius))
            want = radius;
    }
    double got = automatic(pair->t, NULL);
    CHECK_MSG(got == want, "%.17g instead of %.17g", got, want);
    free(all.v);
}

TEST_TIMEOUT(the_automatic_radius_is_the_least_of_all_circumradii_that_will_do_on_every_family, 240)
{
    for_each_pair(check_automatic);
}

TEST(the_automatic_radius_of_a_view_stays_as_it_was)
{
    static const struct dt_point p[] = {{0, 0}, {6, 0}, {0, 8}, {6, 8}, {20, 4}};
    struct dt *t = set_of(p, 5);
    uint32_t id = 4, deleted, missing;
    double before = automatic(t, NULL); /* 53/7, of the triangle 1 4 3 */
    CHECK(before > 7.571 && before < 7.572);
    struct dt_view *v = dt_view_begin(t, true);
    CHECK(v != NULL && dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    CHECK(automatic(t, v) == before && automatic(t, NULL) == 5);
    dt_view_end(v);
    dt_free(t);
}

TEST(the_search_for_a_radius_ends_when_it_is_cancelled)
{
    struct dt_point p[5000];
    family_points(family_find("uniform"), p, 5000, 7);
    struct dt *t = set_of(p, 5000);
    dt_atomic_bool cancel;
    struct dt_options opt = {.cancel = &cancel};
    struct dt_alpha_auto *a;
    bool done = false;
    double radius;
    atomic_init(&cancel, true);
    CHECK(dt_alpha_auto_begin(t, NULL, &a) == DT_OK);
    while (!done)
        CHECK(dt_alpha_auto_read(t, a, &done) == DT_OK);
    CHECK(dt_alpha_auto_end(a, &opt, &radius) == DT_CANCELLED);
    dt_alpha_auto_free(a);
    dt_free(t);
}
