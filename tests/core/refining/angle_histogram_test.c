/* angle_histogram_test.c - the distribution of angles beside a recount with exact numbers, on all families; views, borders, any order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/exact/bignum.h"
#include "tests/core/sets.h"
#include "tests/test.h"

static struct dt_shapes measure(const struct dt *t, const struct dt_view *view,
                                const uint32_t *border)
{
    struct dt_measure *m = NULL;
    struct dt_shapes r;
    bool done = false;
    CHECK(dt_measure_begin(t, view, &m) == DT_OK);
    CHECK(border == NULL || dt_measure_inside(m, t, *border) == DT_OK);
    while (!done)
        CHECK(dt_measure_read(t, m, &done) == DT_OK);
    dt_measure_end(m, &r);
    dt_measure_free(m);
    return r;
}

/* ---- beside exact numbers ---- */

/* cos^2 of 5, 10, ..., 55 degrees, from 80 digits. */
static const double cosine2[] = {0.9924038765061041,  0.9698463103929542, 0.9330127018922193,
                                 0.8830222215594891,  0.8213938048432696, 0.75,
                                 0.6710100716628343,  0.5868240888334652, 0.5,
                                 0.41317591116653485, 0.3289899283371656};

struct vector {
    struct dt_big x, y;
};

static struct vector vector_of(struct dt_point from, struct dt_point to)
{
    struct vector v;
    v.x = dt_big_difference(to.x, from.x);
    v.y = dt_big_difference(to.y, from.y);
    return v;
}

/* a b + sign c d */
static struct dt_big combine(const struct dt_big *a, const struct dt_big *b, const struct dt_big *c,
                             const struct dt_big *d, bool minus)
{
    struct dt_big r = dt_big_multiply(*a, *b), s = dt_big_multiply(*c, *d);
    return minus ? dt_big_subtract(r, s) : dt_big_add(r, s);
}

/* Of the angle at r. */
static int exact_bin(struct dt_point r, struct dt_point p, struct dt_point q)
{
    struct vector u = vector_of(r, p), v = vector_of(r, q);
    struct dt_big dot = combine(&u.x, &v.x, &u.y, &v.y, false), square, sides;
    struct dt_big uu = combine(&u.x, &u.x, &u.y, &u.y, false);
    struct dt_big vv = combine(&v.x, &v.x, &v.y, &v.y, false);
    int bin = 0;
    if (dot.sign <= 0)
        return DT_ANGLE_BINS - 1;
    square = dt_big_multiply(dot, dot);
    sides = dt_big_multiply(uu, vv);
    for (; bin < DT_ANGLE_BINS - 1; bin++) {
        struct dt_big limit = dt_big_of(cosine2[bin]);
        limit = dt_big_multiply(limit, sides);
        if (dt_big_compare(square, limit) > 0)
            break;
    }
    return bin;
}

/* In degrees, from the exact cross and dot products. */
static double angle_at(struct dt_point r, struct dt_point p, struct dt_point q)
{
    struct vector u = vector_of(r, p), v = vector_of(r, q);
    struct dt_big dot = combine(&u.x, &v.x, &u.y, &v.y, false);
    struct dt_big cross = combine(&u.x, &v.y, &u.y, &v.x, true);
    double angle = atan2(dt_big_nearest(cross), dt_big_nearest(dot));
    return angle * (180 / 3.14159265358979323846);
}

static void recount_triangle(const struct dt_point p[3], struct dt_shapes *out, struct dt_big *area)
{
    struct vector u = vector_of(p[0], p[1]), v = vector_of(p[0], p[2]);
    struct dt_big cross = combine(&u.x, &v.y, &u.y, &v.x, true);
    int least = DT_ANGLE_BINS - 1;
    *area = dt_big_add(*area, cross);
    out->triangles++;
    for (int k = 0; k < 3; k++) {
        struct dt_point r = p[k], a = p[(k + 1) % 3], b = p[(k + 2) % 3];
        int bin = exact_bin(r, a, b);
        double angle = angle_at(r, a, b), edge = hypot(a.x - r.x, a.y - r.y);
        least = bin < least ? bin : least;
        out->least = fmin(out->least, angle);
        out->largest = fmax(out->largest, angle);
        out->shortest = fmin(out->shortest, edge);
        out->longest = fmax(out->longest, edge);
    }
    out->count[least]++;
}

/* Of n triangles, by ids. */
static struct dt_shapes recount(const struct dt *t, const struct dt_ids *ids)
{
    const double nan = (double)NAN;
    struct dt_shapes r = {.least = nan, .largest = nan, .shortest = nan, .longest = nan};
    struct dt_big area = {0}, two;
    for (size_t i = 0; i < ids->n; i += 3) {
        struct dt_point p[3];
        for (size_t k = 0; k < 3; k++)
            CHECK(dt_get(t, ids->v[i + k], &p[k]) == DT_OK);
        recount_triangle(p, &r, &area);
    }
    two = dt_big_of(2);
    r.area = area.sign == 0 ? 0 : dt_big_quotient(area, two);
    return r;
}

static bool is_near(double got, double want)
{
    return fabs(got - want) <= 0x1p-50 * fabs(want) || (isnan(got) && isnan(want));
}

static void check_shapes(const struct dt_shapes *got, const struct dt_shapes *want)
{
    CHECK(got->triangles == want->triangles);
    for (int k = 0; k < DT_ANGLE_BINS; k++)
        CHECK_MSG(got->count[k] == want->count[k], "bin %d: %zu, not %zu", k, got->count[k],
                  want->count[k]);
    CHECK_MSG(got->area == want->area, "%.17g, not %.17g", got->area, want->area);
    CHECK_MSG(is_near(got->least, want->least), "%.17g, not %.17g", got->least, want->least);
    CHECK_MSG(is_near(got->largest, want->largest), "%.17g, not %.17g", got->largest,
              want->largest);
    CHECK(is_near(got->shortest, want->shortest) && is_near(got->longest, want->longest));
}

static struct dt_ids all_triangles(const struct dt *t)
{
    struct dt_ids ids = {0};
    struct dt_cursor c;
    size_t rows = 1, words, room = 3000;
    uint32_t row[3000];
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK);
    while (rows > 0) {
        CHECK(dt_table_read(t, &c, row, room, room / 3, &rows, &words) == DT_OK);
        append_ids(&ids, row, words);
    }
    return ids;
}

static void check_pair(const struct pair *pair)
{
    struct dt_ids ids = all_triangles(pair->t);
    struct dt_shapes got = measure(pair->t, NULL, NULL), want = recount(pair->t, &ids);
    check_shapes(&got, &want);
    free(ids.v);
}

TEST(angles_of_every_family_are_those_of_exact_arithmetic)
{
    for_each_pair(check_pair);
}

static double signed_below(uint32_t n)
{
    return (double)test_below(n) - n / 2;
}

/* Corners on a lattice have many angles of exactly 45 degrees; near ones are decided in long numbers. */
TEST(angles_at_the_end_of_a_bin_are_decided_exactly)
{
    for (int round = 0; round < 300; round++) {
        struct dt_point p[12];
        for (int i = 0; i < 12; i++) {
            double beside = i % 3 == 0 ? 0 : signed_below(3) * 0x1p-45;
            p[i] = (struct dt_point){signed_below(5) + beside, signed_below(5)};
        }
        struct dt *t = set_of(p, 12);
        struct dt_ids ids = all_triangles(t);
        struct dt_shapes got = measure(t, NULL, NULL), want = recount(t, &ids);
        check_shapes(&got, &want);
        free(ids.v);
        dt_free(t);
    }
}

/* ---- any order, any moment ---- */

TEST(shapes_have_the_same_bytes_in_any_order_and_at_the_moment_of_a_view)
{
    enum { N = 20000 };
    static struct dt_point p[N];
    for (uint32_t i = 0; i < N; i++)
        p[i] = (struct dt_point){(double)test_below(3000) / 8, (double)test_below(3000)};
    struct dt *t = set_of(p, N), *other = set_of_each(p, N);
    struct dt_shapes now = measure(t, NULL, NULL), again = measure(other, NULL, NULL), then;
    struct dt_view *view = dt_view_begin(t, true);
    struct dt_measure *m;
    bool done = false;
    uint32_t gone = 7, deleted, missing;
    struct dt_added added;
    CHECK(now.triangles > 10000 && memcmp(&now, &again, sizeof now) == 0);
    CHECK(view != NULL && dt_measure_begin(t, view, &m) == DT_OK);
    CHECK(dt_measure_read(t, m, &done) == DT_OK && !done);
    CHECK(dt_add(t, &(struct dt_point){-5000, 11}, 1, &added) == DT_OK);
    CHECK(dt_delete(t, &gone, 1, &deleted, &missing) == DT_OK);
    while (!done)
        CHECK(dt_measure_read(t, m, &done) == DT_OK);
    dt_measure_end(m, &then);
    CHECK(memcmp(&now, &then, sizeof now) == 0);
    again = measure(t, NULL, NULL);
    CHECK(again.area > now.area);
    dt_measure_free(m);
    dt_view_end(view);
    dt_free(t);
    dt_free(other);
}

TEST(sets_without_triangles_have_no_angles)
{
    static const struct dt_point p[] = {{0, 0}, {1, 1}, {2, 2}};
    for (uint32_t n = 0; n <= 3; n++) {
        struct dt *t = set_of(p, n);
        struct dt_shapes r = measure(t, NULL, NULL);
        CHECK(r.triangles == 0 && r.area == 0 && isnan(r.least) && isnan(r.longest));
        dt_free(t);
    }
}

TEST(shapes_inside_a_border_are_those_of_its_triangles)
{
    static const struct dt_point p[] = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {2, 2}, {6, 2}, {4, 5}};
    static const struct dt_constraint side[] = {{4, 5, true, 3}, {5, 6, true, 3}, {4, 6, true, 3}};
    struct dt *t = set_of(p, 7);
    struct dt_measure *m;
    struct dt_ids ids = {0};
    size_t added;
    uint32_t deleted, missing, number = 3;
    bool done;
    CHECK(dt_constrain(t, side, 3, NULL, &added, &missing) == DT_OK && added == 3);
    CHECK(dt_survey(t, NULL) == DT_OK);
    CHECK(dt_inside(t, 3, DT_TRIANGLES, false, NULL, &ids) == DT_OK);
    struct dt_shapes got = measure(t, NULL, &number), want = recount(t, &ids);
    check_shapes(&got, &want);
    CHECK(got.triangles == 1 && got.area == 6);
    CHECK(dt_measure_begin(t, NULL, &m) == DT_OK);
    CHECK(dt_measure_inside(m, t, 4) == DT_NOREGION);
    dt_measure_free(m);
    struct dt_view *view = dt_view_begin(t, true);
    CHECK(dt_measure_begin(t, view, &m) == DT_OK && dt_measure_inside(m, t, 3) == DT_OK);
    CHECK(dt_delete(t, &number, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_measure_read(t, m, &done) == DT_UNSURVEYED && !done);
    dt_measure_free(m);
    dt_view_end(view);
    free(ids.v);
    dt_free(t);
}

TEST(shapes_of_a_set_that_is_not_triangulated_cannot_be_measured)
{
    struct dt *t = dt_new(0);
    struct dt_measure *m;
    CHECK(dt_measure_begin(t, NULL, &m) == DT_UNTRIANGULATED && m == NULL);
    dt_free(t);
}
