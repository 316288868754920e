/* nearest_test.c - nearest points, points within boxes and discs, against linear scans. */
#include <math.h>
#include <stdlib.h>

#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static void check_nearest(const struct pair *pair)
{
    const uint32_t ks[] = {0, 1, 2, 5, 1 + test_below(70), UINT32_MAX};
    for (int i = 0; i < 30; i++) {
        struct dt_point q = random_place(pair->b);
        for (int j = 0; j < 6; j++) {
            struct dt_ids got = {0}, want = {0};
            brute_nearest(pair->b, q, ks[j], &want);
            CHECK(dt_nearest(pair->t, q, ks[j], &got) == DT_OK);
            check_equal_ids("nearest", &got, &want);
            free(got.v);
            free(want.v);
        }
    }
}

TEST_TIMEOUT(nearest_points_equal_brute_force_on_every_family, 60)
{
    for_each_pair(check_nearest);
}

static void check_box(const struct pair *pair)
{
    for (int i = 0; i < 60; i++) {
        struct dt_point a = random_place(pair->b), b = random_place(pair->b);
        struct dt_point lo = {fmin(a.x, b.x), fmin(a.y, b.y)},
                        hi = {fmax(a.x, b.x), fmax(a.y, b.y)};
        if (test_below(4) == 0) /* thin */
            hi.x = lo.x;
        if (test_below(4) == 0)
            hi.y = lo.y;
        struct dt_ids got = {0}, want = {0};
        brute_within_box(pair->b, lo, hi, &want);
        CHECK(dt_within_box(pair->t, lo, hi, NULL, &got) == DT_OK);
        check_equal_ids("within a box", &got, &want);
        free(got.v);
        free(want.v);
    }
}

TEST_TIMEOUT(points_within_boxes_equal_brute_force_on_every_family, 60)
{
    for_each_pair(check_box);
}

static void check_disc(const struct pair *pair)
{
    for (int i = 0; i < 60; i++) {
        struct dt_point c = random_place(pair->b), p = random_place(pair->b);
        double r = i % 8 == 0
                       ? 0
                       : hypot(p.x - c.x, p.y - c.y); /* often nearly through a point, or exactly */
        if (!dt_coordinate_ok(r))
            continue;
        struct dt_ids got = {0}, want = {0};
        brute_within_disc(pair->b, c, r, &want);
        CHECK(dt_within_disc(pair->t, c, r, NULL, &got) == DT_OK);
        check_equal_ids("within a disc", &got, &want);
        free(got.v);
        free(want.v);
    }
}

TEST_TIMEOUT(points_within_discs_equal_brute_force_on_every_family, 60)
{
    for_each_pair(check_disc);
}

TEST(box_whose_corners_are_all_outside_still_finds_what_crosses_it)
{
    /* A slanted sliver passes through the left and the upper side of the box; its one point there
     * is found. */
    const struct dt_point p[] = {{-10, -10}, {10, 11}, {-1, 0.5}, {10, 10.5}};
    struct pair pair = pair_of(p, 4);
    struct dt_ids got = {0};
    CHECK(dt_within_box(pair.t, (struct dt_point){-2, 0}, (struct dt_point){0, 2}, NULL, &got) ==
          DT_OK);
    CHECK(got.n == 1 && got.v[0] == 2);
    CHECK(dt_within_box(pair.t, (struct dt_point){1, 0}, (struct dt_point){0, 2}, NULL, &got) ==
              DT_OK &&
          got.n == 1);
    free(got.v);
    pair_free(&pair);
}

static double unit(void)
{
    return test_below(1u << 30) * 0x1p-30;
}

/* The live points of p[0 .. n - 1] that dt_get finds in the box or, with r > 0, in the disc. */
static void scan_set(const struct dt *t, uint32_t n, struct dt_point lo, struct dt_point hi,
                     double r, struct dt_ids *out)
{
    for (uint32_t id = 0; id < n; id++) {
        struct dt_point q;
        if (dt_get(t, id, &q) == DT_OK &&
            (r > 0 ? hypot(q.x - lo.x, q.y - lo.y) <= r
                   : lo.x <= q.x && q.x <= hi.x && lo.y <= q.y && q.y <= hi.y)) {
            CHECK(dt_ids_append(out, id) == DT_OK);
        }
    }
}

/* Results of every size, from a few points by the flood to all of them by a scan. */
TEST(parts_of_a_large_edited_set_equal_a_linear_scan)
{
    enum { N = 30000 };
    struct dt_point *p = malloc(N * sizeof *p);
    for (uint32_t i = 0; i < N; i++)
        p[i] = (struct dt_point){unit(), unit()};
    struct dt *t = set_of(p, N);
    for (uint32_t id = 0, k; id < N; id += 3)
        CHECK(dt_delete(t, &id, 1, &k, NULL) == DT_OK); /* leaves free vertices */
    for (double side = 0.01; side < 2.5; side *= 1.4) {
        struct dt_point lo = {unit() - side / 2, unit() - side / 2},
                        hi = {lo.x + side, lo.y + side};
        struct dt_ids box = {0}, disc = {0}, in_box = {0}, in_disc = {0};
        scan_set(t, N, lo, hi, 0, &in_box);
        scan_set(t, N, lo, hi, side, &in_disc);
        CHECK(dt_within_box(t, lo, hi, NULL, &box) == DT_OK);
        CHECK(dt_within_disc(t, lo, side, NULL, &disc) == DT_OK);
        check_equal_ids("within a box", &box, &in_box);
        check_equal_ids("within a disc", &disc, &in_disc);
        free(box.v);
        free(disc.v);
        free(in_box.v);
        free(in_disc.v);
    }
    dt_free(t);
    free(p);
}

/* Every allocation of a query fails, one after the other: the array it appends to stays as it was. */
TEST(searches_out_of_memory_append_nothing)
{
    struct dt_point p[300];
    family_points(family_find("small_lattice"), p, 300, 1);
    struct dt *t = set_of(p, 300);
    const struct dt_point lo = {-1e6, -1e6}, hi = {1e6, 1e6};
    for (int query = 0; query < 3; query++) {
        for (long n = 1;; n++) {
            struct dt_ids out = {.v = malloc(sizeof *out.v), .n = 1, .cap = 1};
            out.v[0] = 77;
            test_fail_alloc(n);
            enum dt_status s = query == 0   ? dt_nearest(t, p[0], 200, &out)
                               : query == 1 ? dt_within_box(t, lo, hi, NULL, &out)
                                            : dt_within_disc(t, p[0], 1e6, NULL, &out);
            bool failed = test_alloc_failed();
            test_fail_alloc(0);
            CHECK(s == (failed ? DT_NOMEM : DT_OK));
            CHECK(out.v[0] == 77 && (failed ? out.n == 1 : out.n > 20));
            free(out.v);
            if (!failed) {
                CHECK(n > 3);
                break;
            }
        }
    }
    dt_free(t);
}
