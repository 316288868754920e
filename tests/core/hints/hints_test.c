/* hints_test.c - the grid of hints: hints near every place and a small grid for every distribution; and walks
 * from anywhere. */
#include "core/hints/hints.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/query/locate.h"
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

/* Returns how many vertices a search that always goes to the nearest neighbour passes from the hint to
 * q. */
static uint32_t steps_to(const struct dt *t, struct dt_point q)
{
    uint32_t v = DT_NONE, best = dt_origin(&t->mesh, dt_hint(&t->hints, q)), steps = 0;
    double d = hypot(t->points.xy[best].x - q.x, t->points.xy[best].y - q.y);
    for (; best != v; steps++) {
        v = best;
        uint32_t h = t->mesh.leaving[v];
        do {
            uint32_t w = dt_dest(&t->mesh, h);
            double dw = w == DT_NONE ? (double)INFINITY
                                     : hypot(t->points.xy[w].x - q.x, t->points.xy[w].y - q.y);
            best = dw < d ? w : best;
            d = dw < d ? dw : d;
            h = dt_turn_ccw(&t->mesh, h);
        } while (h != t->mesh.leaving[v]);
    }
    return steps;
}

/* Within an exact circle all its points are about as near: there is no nearest one to be close
 * to. */
static bool has_near_hints(const struct family *f)
{
    return strcmp(f->name, "circle_exact") != 0 && strcmp(f->name, "wheel") != 0;
}

/* Bytes a point: 6 make 98 with all else that a set holds. On hundreds of scales, grids within grids take
 * more. */
static size_t most_bytes(const struct family *f)
{
    return strcmp(f->name, "exponents") == 0 ? 16 : 6;
}

TEST_TIMEOUT(hints_are_near_and_small_on_every_family, 60)
{
    const uint32_t n = 20000;
    struct dt_point *p = malloc(n * sizeof *p);
    for (const struct family *f = families; f->name != NULL; f++) {
        family_points(f, p, n, 1);
        struct dt *t = set_of(p, n);
        uint64_t steps = 0;
        for (uint32_t i = 0; i < 2000 && t->mesh.vertices > 1; i++) {
            struct dt_point q = p[test_below(n)], r = p[test_below(n)];
            double u = test_below(8) == 0 ? test_uniform() : 1e-3;
            steps += steps_to(t, (struct dt_point){q.x + (r.x - q.x) * u, q.y + (r.y - q.y) * u});
        }
        CHECK_MSG(!has_near_hints(f) || steps <= 2000 * 8, "%s: %.1f steps a search", f->name,
                  (double)steps / 2000);
        CHECK_MSG(dt_hints_memory(&t->hints) <= most_bytes(f) * n, "%s: %zu bytes", f->name,
                  dt_hints_memory(&t->hints) / n);
        dt_free(t);
    }
    free(p);
}

/* The sum of the steps of searches for n places. */
static uint32_t sum_of_steps(const struct dt *t, const struct dt_point *q, uint32_t n)
{
    uint32_t sum = 0, h, steps;
    for (uint32_t i = 0; i < n; i++) {
        dt_find_counting(t, q[i], &h, &steps);
        sum += steps;
    }
    return sum;
}

/* 0.80 here; 0.98 if the first triangle in a cell kept it, two if the hints were triangles at any vertex of a cell. */
TEST(a_search_by_a_new_grid_takes_one_step)
{
    enum { N = 20000, SEARCHES = 5000 };
    static struct dt_point p[N], q[SEARCHES];
    family_points(family_find("uniform"), p, N, 1);
    family_points(family_find("uniform"), q, SEARCHES, 2);
    struct dt *t = set_of(p, N);
    uint32_t sum = sum_of_steps(t, q, SEARCHES);
    CHECK_MSG(sum < 0.9 * SEARCHES, "%.2f steps a search", (double)sum / SEARCHES);
    dt_free(t);
}

/* The hint of this place is beyond a hull edge 80 cells long. Thin triangles fan out from both its ends: a walk that does
 * not begin with the hull edge went round the far end and took more than 64 steps. */
TEST(a_search_from_a_long_hull_edge_is_short)
{
    enum { N = 20000 };
    static struct dt_point p[N];
    const struct dt_point q = {0.577, 0.996};
    family_points(family_find("uniform"), p, N, 1);
    struct dt *t = set_of(p, N);
    CHECK(dt_is_ghost(&t->mesh, dt_hint(&t->hints, q)));
    uint32_t steps = sum_of_steps(t, &q, 1);
    CHECK_MSG(steps < 16, "%u steps", steps);
    dt_free(t);
}

/* In a small set every vertex is a sample, so that a cell of a coarse grid has 8: they are no crowd. */
TEST(evenly_spread_points_have_one_grid_of_about_as_many_cells)
{
    struct dt_point p[1200];
    for (uint32_t n = 16; n <= 1200; n += n / 8) {
        family_points(family_find("uniform"), p, n, 1);
        struct dt *t = set_of(p, n);
        uint32_t cells = t->hints.grid[0].nx * t->hints.grid[0].ny;
        CHECK_MSG(cells >= n / 2 && cells <= 2 * n, "%u points: %u cells", n, cells);
        dt_free(t);
    }
}

/* Walks to a place end at the same half edge from every start. */
static void check_walks(const struct pair *pair)
{
    const struct dt *t = pair->t;
    for (int i = 0; i < 20 && t->mesh.vertices > 1; i++) {
        struct dt_point q = random_place(pair->b);
        uint32_t h, from = 8 * test_below(t->mesh.tri_end) + test_below(3);
        if (dt_is_dead(&t->mesh, from))
            continue;
        enum dt_where where = dt_walk(&t->mesh, t->points.xy, from, q, &h);
        CHECK(where == brute_locate(pair->b, q).where);
        CHECK((where == DT_OUTSIDE) <= dt_is_ghost(&t->mesh, h));
    }
}

TEST(walks_from_anywhere_arrive)
{
    for_each_pair(check_walks);
}

static bool same_location(struct dt_location a, struct dt_location b)
{
    return a.where == b.where && memcmp(a.id, b.id, sizeof a.id) == 0;
}

/* A set that has no grid yet answers as one that has. */
static void check_unprepared(const struct pair *pair)
{
    struct dt *bare;
    struct dt_ids with = {0}, without = {0};
    const struct dt_options rebuild = {.rebuild = true};
    struct dt_summary sum;
    CHECK(dt_clone(pair->t, &bare) == DT_OK && dt_triangulate(bare, &rebuild) == DT_OK);
    dt_summary(bare, &sum);
    CHECK(sum.searchable == (bare->mesh.vertices < 2));
    for (int i = 0; i < 5 && sum.points > 0; i++) {
        struct dt_point q = random_place(pair->b), r = random_place(pair->b);
        struct dt_point lo = {fmin(q.x, r.x), fmin(q.y, r.y)},
                        hi = {fmax(q.x, r.x), fmax(q.y, r.y)};
        struct dt_location a = {0}, b = {0};
        CHECK(dt_locate(pair->t, q, &a) == DT_OK && dt_locate(bare, q, &b) == DT_OK);
        CHECK(same_location(a, b));
        with.n = without.n = 0;
        CHECK(dt_nearest(pair->t, q, 3, &with) == DT_OK &&
              dt_nearest(bare, q, 3, &without) == DT_OK);
        CHECK(dt_within_box(pair->t, lo, hi, NULL, &with) == DT_OK &&
              dt_within_box(bare, lo, hi, NULL, &without) == DT_OK);
        CHECK(with.n == without.n && memcmp(with.v, without.v, with.n * sizeof *with.v) == 0);
    }
    CHECK(dt_prepare(bare, NULL) == DT_OK);
    dt_summary(bare, &sum);
    CHECK(sum.searchable);
    dt_free(bare);
    free(with.v);
    free(without.v);
}

TEST(sets_without_a_grid_answer_as_those_with_one)
{
    for_each_pair(check_unprepared);
}

TEST(edits_make_the_grid_that_is_missing)
{
    struct dt_point p[900];
    struct dt_added added;
    uint32_t deleted, missing, id = 3;
    family_points(family_find("uniform"), p, 900, 1);
    for (int edit = 0; edit < 3; edit++) {
        struct dt *t = dt_new(0);
        CHECK(t != NULL && dt_add(t, p, 800, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
        CHECK(t->hints.grids == 0);
        CHECK((edit == 0   ? dt_add(t, p + 800, 50, &added)
               : edit == 1 ? dt_move(t, 7, p[850])
                           : dt_delete(t, &id, 1, &deleted, &missing)) == DT_OK);
        CHECK(t->hints.grids > 0 && dt_check(t, NULL, NULL) == DT_OK);
        dt_free(t);
    }
}

TEST(searches_and_edits_go_on_without_memory_for_a_grid)
{
    struct dt_point p[900];
    struct dt_added added;
    struct dt_summary sum;
    struct dt_location at;
    family_points(family_find("uniform"), p, 900, 1);
    struct dt *t = dt_new(0);
    CHECK(t != NULL && dt_add(t, p, 800, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    test_fail_alloc(1);
    CHECK(dt_prepare(t, NULL) == DT_NOMEM);
    test_fail_alloc(0);
    dt_summary(t, &sum);
    CHECK(sum.searchable && t->hints.grids == 0); /* nobody asks for one again in vain */
    CHECK(dt_locate(t, p[5], &at) == DT_OK && at.where == DT_ON_VERTEX && at.id[0] == 5);
    for (uint32_t i = 800; i < 900; i++)
        CHECK(dt_add(t, p + i, 1, &added) == DT_OK);
    CHECK(t->hints.grids > 0 && dt_check(t, NULL, NULL) == DT_OK); /* when walks had cost as much */
    dt_free(t);
}

TEST(hints_out_of_memory_leave_nothing)
{
    struct dt_point p[2000];
    family_points(family_find("clusters"), p, 2000, 1);
    struct dt *t = set_of(p, 2000);
    for (long n = 1;; n++) {
        test_fail_alloc(n);
        enum dt_status s = dt_hints_build(&t->hints, &t->mesh, t->points.xy, NULL);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        /* Shrinking at the end may fail without harm. */
        CHECK(s == DT_OK ||
              (failed && s == DT_NOMEM && t->hints.cell == NULL && t->hints.grid == NULL));
        if (!failed) {
            CHECK(n > 6);
            break;
        }
    }
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}
