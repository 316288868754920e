/* arrays_test.c - whole arrays, against brute force on every family: rows, twins, tables, places, neighbours. */
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_arrays.h"
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MOST = 60, PLACES = 100 };

struct made {
    struct dt_arrays *a;
    uint32_t triangle[6 * MOST];
    struct {
        uint32_t points, coincident, triangles, edges, hull;
    } sum;
};

static void make(struct made *m, const struct dt_point *p, uint32_t n, unsigned workers)
{
    CHECK(dt_arrays_new(p, n, NULL, workers, m->triangle, &m->a) == DT_OK);
    uint32_t counts[5];
    dt_arrays_counts(m->a, counts);
    memcpy(&m->sum, counts, sizeof counts);
}

/* Calls test for sets of every family without deleted points. */
static void for_each_set(void (*test)(struct made *m, const struct brute *b))
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 5, 7, 12, 25, MOST};
    struct dt_point p[MOST];
    for (const struct family *f = families; f->name != NULL; f++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            struct made m;
            family_points(f, p, sizes[i], test_random());
            struct brute *b = brute_new(p, NULL, sizes[i]);
            make(&m, p, sizes[i], 1 + (unsigned)test_below(3));
            test(&m, b);
            dt_arrays_free(m.a);
            brute_free(b);
        }
}

static void check_table(struct made *m, const struct brute *b, enum dt_table table, size_t width,
                        size_t rows)
{
    uint32_t got[6 * MOST];
    struct dt_ids want = {0};
    brute_table(b, table, false, &want);
    CHECK(dt_arrays_table(m->a, table, got) == DT_OK);
    check_equal_ids(table_names[table], &(struct dt_ids){got, width * rows, 0}, &want);
    free(want.v);
}

static void check_tables(struct made *m, const struct brute *b)
{
    struct dt_ids want = {0};
    brute_table(b, DT_TRIANGLES, false, &want);
    check_equal_ids("rows", &(struct dt_ids){m->triangle, 3 * (size_t)m->sum.triangles, 0}, &want);
    free(want.v);
    check_table(m, b, DT_EDGES, 2, m->sum.edges);
    check_table(m, b, DT_HULL, 1, m->sum.hull);
    check_table(m, b, DT_COINCIDENT, 2, m->sum.coincident);
    CHECK(dt_arrays_table(m->a, DT_LISTS, NULL) == DT_RANGE);
}

TEST_TIMEOUT(arrays_have_the_rows_and_tables_of_brute_force_on_every_family, 60)
{
    for_each_set(check_tables);
}

static void check_twins(struct made *m, const struct brute *b)
{
    uint32_t twin[6 * MOST], n = 3 * m->sum.triangles;
    dt_arrays_twins(m->a, twin);
    for (uint32_t e = 0; e < n; e++) {
        uint32_t from = m->triangle[e], to = m->triangle[e - e % 3 + (e + 1) % 3];
        if (twin[e] == DT_NONE) {
            CHECK(b->apex[to * b->n + from] == DT_NONE);
            continue;
        }
        CHECK(twin[e] < n && twin[twin[e]] == e);
        CHECK(m->triangle[twin[e]] == to);
        CHECK(m->triangle[twin[e] - twin[e] % 3 + (twin[e] + 1) % 3] == from);
    }
}

TEST_TIMEOUT(twins_are_the_same_side_the_other_way_and_missing_on_the_hull, 60)
{
    for_each_set(check_twins);
}

/* ---- places ---- */

static uint32_t first_row(const struct made *m, const struct brute *b, struct dt_point q)
{
    for (uint32_t i = 0; i < m->sum.triangles; i++) {
        const uint32_t *id = m->triangle + 3 * i;
        if (dt_orient2d(b->p[id[0]], b->p[id[1]], q) >= 0 &&
            dt_orient2d(b->p[id[1]], b->p[id[2]], q) >= 0 &&
            dt_orient2d(b->p[id[2]], b->p[id[0]], q) >= 0)
            return i;
    }
    return DT_NONE;
}

static void check_rows(struct made *m, const struct brute *b)
{
    struct dt_point q[PLACES];
    uint32_t got[PLACES], want[PLACES];
    for (unsigned i = 0; i < PLACES; i++) {
        q[i] = random_place(b);
        want[i] = first_row(m, b, q[i]);
    }
    q[7] = (struct dt_point){(double)NAN, 0};
    q[8] = (struct dt_point){0, -(double)INFINITY};
    want[7] = want[8] = DT_NONE;
    CHECK(dt_arrays_locate(m->a, q, PLACES, 0, 2, got) == DT_OK);
    check_equal_ids("rows of places", &(struct dt_ids){got, PLACES, 0},
                    &(struct dt_ids){want, PLACES, 0});
}

TEST_TIMEOUT(places_have_the_first_row_that_contains_them_on_every_family, 60)
{
    for_each_set(check_rows);
}

/* Brute force's k nearest representatives, each followed by its aliases. */
static void nearest_with_aliases(const struct brute *b, struct dt_point q, uint32_t k,
                                 struct dt_ids *out)
{
    struct dt_ids found = {0};
    brute_nearest(b, q, k, &found);
    for (size_t i = 0; i < found.n; i++) {
        append_ids(out, &found.v[i], 1);
        for (uint32_t id = 0; id < b->n; id++)
            if (id != found.v[i] && b->rep[id] == found.v[i])
                append_ids(out, &id, 1);
    }
    free(found.v);
    out->n = out->n < k ? out->n : k;
}

static void check_nearest(struct made *m, const struct brute *b)
{
    enum { K = 9 };
    struct dt_point q[PLACES];
    uint32_t got[K * PLACES];
    double distance[K * PLACES];
    for (unsigned i = 0; i < PLACES; i++)
        q[i] = random_place(b);
    CHECK(dt_arrays_nearest(m->a, q, PLACES, K, 2, got, distance) == DT_OK);
    for (unsigned i = 0; i < PLACES; i++) {
        struct dt_ids want = {0};
        nearest_with_aliases(b, q[i], K, &want);
        for (size_t j = 0; j < K; j++) {
            double d = HUGE_VAL;
            if (j < want.n)
                d = hypot(b->p[want.v[j]].x - q[i].x, b->p[want.v[j]].y - q[i].y);
            CHECK(distance[K * i + j] == d);
        }
        while (want.n < K)
            append_ids(&want, &(uint32_t){DT_NONE}, 1);
        check_equal_ids("nearest", &(struct dt_ids){got + (size_t)K * i, K, 0}, &want);
        free(want.v);
    }
}

TEST_TIMEOUT(the_nearest_points_include_aliases_on_every_family, 60)
{
    for_each_set(check_nearest);
}

static int compare_ids(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static void check_within(struct made *m, const struct brute *b)
{
    struct dt_point q[PLACES];
    double r[PLACES];
    size_t end[PLACES];
    struct dt_ids got = {0};
    for (unsigned i = 0; i < PLACES; i++) {
        struct dt_point p = random_place(b);
        q[i] = random_place(b);
        r[i] = hypot(p.x - q[i].x, p.y - q[i].y);
        r[i] = i == 5 ? HUGE_VAL : dt_coordinate_ok(r[i]) ? r[i] : 1;
    }
    CHECK(dt_arrays_within(m->a, q, r, PLACES, 2, &got, end) == DT_OK);
    for (unsigned i = 0; i < PLACES; i++) {
        struct dt_ids want = {0};
        size_t from = i == 0 ? 0 : end[i - 1];
        if (r[i] == HUGE_VAL)
            brute_table(b, DT_POINTS, false, &want);
        else
            brute_within_disc(b, q[i], r[i], &want);
        size_t representatives = r[i] == HUGE_VAL ? 0 : want.n;
        for (size_t j = 0; j < representatives; j++)
            for (uint32_t id = 0; id < b->n; id++)
                if (id != want.v[j] && b->rep[id] == want.v[j])
                    append_ids(&want, &id, 1);
        if (want.n > 0)
            qsort(want.v, want.n, sizeof *want.v, compare_ids);
        size_t n = end[i] - from;
        check_equal_ids("within", &(struct dt_ids){n == 0 ? NULL : got.v + from, n, 0}, &want);
        free(want.v);
    }
    dt_arrays_release(got.v);
}

TEST_TIMEOUT(points_within_a_distance_include_aliases_on_every_family, 60)
{
    for_each_set(check_within);
}

TEST(places_and_distances_that_are_not_numbers_are_refused)
{
    static const struct dt_point square[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    struct dt_point nowhere = {(double)NAN, 0}, here = {1, 1};
    struct made m;
    uint32_t id[1];
    double distance[1], bad[] = {-1, (double)NAN, 1e300};
    size_t end[1];
    struct dt_ids out = {0};
    make(&m, square, 4, 1);
    CHECK(dt_arrays_nearest(m.a, &nowhere, 1, 1, 1, id, distance) == DT_RANGE);
    CHECK(dt_arrays_within(m.a, &nowhere, &(double){1}, 1, 1, &out, end) == DT_RANGE);
    for (size_t i = 0; i < 3; i++)
        CHECK(dt_arrays_within(m.a, &here, &bad[i], 1, 1, &out, end) == DT_RANGE);
    CHECK(dt_arrays_values(m.a, distance, DT_LINEAR, -1, &here, 1, 0, 0, 1, distance) == DT_RANGE);
    dt_arrays_free(m.a);
    CHECK(dt_arrays_new(&nowhere, 1, NULL, 1, m.triangle, &m.a) == DT_RANGE && m.a == NULL);
}

TEST_TIMEOUT(arrays_that_find_no_memory_leave_none_behind, 60)
{
    struct dt_point p[MOST];
    uint32_t triangle[6 * MOST], id[2 * MOST];
    size_t end[MOST];
    double r[MOST];
    family_points(family_find("small_lattice"), p, MOST, 1);
    for (unsigned i = 0; i < MOST; i++)
        r[i] = 1;
    size_t before = test_alloc_in_use();
    bool failed = true;
    for (long k = 1; failed; k++) {
        struct dt_arrays *a;
        struct dt_ids found = {0};
        test_fail_alloc(k);
        enum dt_status s = dt_arrays_new(p, MOST, NULL, 1, triangle, &a);
        if (s == DT_OK)
            s = dt_arrays_nearest(a, p, MOST, 2, 1, id, (double[2 * MOST]){0});
        if (s == DT_OK)
            s = dt_arrays_within(a, p, r, MOST, 1, &found, end);
        if (s == DT_OK)
            s = dt_arrays_values(a, r, DT_NATURAL, HUGE_VAL, p, MOST, 0, 0, 1, (double[MOST]){0});
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(failed ? s == DT_OK || s == DT_NOMEM : s == DT_OK);
        dt_arrays_release(found.v);
        dt_arrays_free(a);
        CHECK(test_alloc_in_use() == before);
    }
}

/* ---- threads, rounding ---- */

TEST_TIMEOUT(the_number_of_workers_changes_no_answer, 60)
{
    enum { N = 20000 };
    struct dt_point *p = malloc(2 * N * sizeof *p), *q = p + N;
    uint32_t *triangle = malloc(2 * 6 * N * sizeof *triangle), *other = triangle + 6 * N;
    uint32_t *row = malloc(2 * N * sizeof *row);
    struct dt_arrays *one, *four;
    uint32_t counts[5];
    family_points(family_find("uniform"), p, 2 * N, test_random());
    CHECK(dt_arrays_new(p, N, NULL, 0, triangle, &one) == DT_OK);
    CHECK(dt_arrays_new(p, N, NULL, 4, other, &four) == DT_OK);
    dt_arrays_counts(one, counts);
    CHECK(memcmp(triangle, other, 12 * (size_t)counts[2]) == 0);
    CHECK(dt_arrays_locate(one, q, N, 0, 1, row) == DT_OK);
    CHECK(dt_arrays_locate(four, q, N, 0, 400, row + N) == DT_OK);
    CHECK(memcmp(row, row + N, N * sizeof *row) == 0);
    dt_arrays_free(one);
    dt_arrays_free(four);
    free(row);
    free(triangle);
    free(p);
}

TEST_TIMEOUT(the_rounding_mode_of_the_caller_changes_nothing_and_stays, 60)
{
    static const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    for (const struct family *f = families; f->name != NULL; f++)
        for (size_t i = 0; i < 3; i++) {
            struct dt_point p[2 * MOST];
            struct made usual, rounded;
            uint32_t row[2][MOST];
            double z[MOST], radius[MOST], value[2][MOST], distance[2][2 * MOST];
            uint32_t near[2][2 * MOST];
            size_t end[2][MOST];
            struct dt_ids within[2] = {{0}, {0}};
            family_points(f, p, 2 * MOST, test_random());
            for (unsigned k = 0; k < MOST; k++) {
                z[k] = k / 7.0;
                radius[k] = fabs(p[k].x);
            }
            for (unsigned k = 0; k < 2; k++) {
                struct made *m = k == 0 ? &usual : &rounded;
                fesetround(k == 0 ? FE_TONEAREST : modes[i]);
                make(m, p, MOST, 2);
                CHECK(dt_arrays_locate(m->a, p + MOST, MOST, 0x1p-45, 1, row[k]) == DT_OK);
                CHECK(dt_arrays_values(m->a, z, DT_NATURAL, HUGE_VAL, p + MOST, MOST, 0, -1, 1,
                                       value[k]) == DT_OK);
                CHECK(dt_arrays_nearest(m->a, p + MOST, MOST, 2, 1, near[k], distance[k]) == DT_OK);
                CHECK(dt_arrays_within(m->a, p + MOST, radius, MOST, 1, &within[k], end[k]) ==
                      DT_OK);
                CHECK(fegetround() == (k == 0 ? FE_TONEAREST : modes[i]));
                fesetround(FE_TONEAREST);
            }
            CHECK(memcmp(usual.triangle, rounded.triangle, 12 * (size_t)usual.sum.triangles) == 0);
            CHECK(memcmp(row[0], row[1], sizeof row[0]) == 0);
            CHECK(memcmp(value[0], value[1], sizeof value[0]) == 0);
            CHECK(memcmp(near[0], near[1], sizeof near[0]) == 0);
            CHECK(memcmp(distance[0], distance[1], sizeof distance[0]) == 0);
            CHECK(memcmp(end[0], end[1], sizeof end[0]) == 0);
            CHECK(within[0].n == 0 ||
                  memcmp(within[0].v, within[1].v, within[0].n * sizeof *within[0].v) == 0);
            dt_arrays_release(within[0].v);
            dt_arrays_release(within[1].v);
            dt_arrays_free(usual.a);
            dt_arrays_free(rounded.a);
        }
}
