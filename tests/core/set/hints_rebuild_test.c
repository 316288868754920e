/* hints_rebuild_test.c - the grid of an edited set is rebuilt in time, by the set's current user. */
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/test.h"

#include <stdlib.h>

enum { POINTS = 10500, BATCH = 500 };

static void add_points(struct dt *t, uint32_t n)
{
    struct dt_point p[BATCH];
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
    CHECK(dt_add(t, p, n, &added) == DT_OK);
}

static struct dt *uniform_set(void)
{
    struct dt *t = dt_new(0);
    CHECK(t != NULL);
    for (uint32_t n = 0; n < POINTS; n += BATCH)
        add_points(t, BATCH);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static struct dt *aged_set(void)
{
    struct dt *t = uniform_set();
    while (!dt_renew_due(t)) {
        CHECK(t->mesh.vertices <= 2 * POINTS);
        add_points(t, BATCH);
    }
    return t;
}

/* The set's replies about random places, as one number. */
static uint64_t digest(const struct dt *t)
{
    uint64_t sum = 1;
    struct dt_ids ids = {0};
    for (uint32_t i = 0; i < 500; i++) {
        struct dt_point q = {(double)(i % 23) / 22, (double)(i % 29) / 28};
        struct dt_location at;
        ids.n = 0;
        CHECK(dt_nearest(t, q, 1, &ids) == DT_OK && dt_locate(t, q, &at) == DT_OK);
        sum = sum * 31 + ids.v[0] + at.id[0];
    }
    free(ids.v);
    return sum;
}

TEST(large_set_that_has_grown_gets_a_new_grid_from_its_caller)
{
    struct dt *t = aged_set();
    struct dt_renewal *r;
    uint32_t grown = t->hinted;
    uint64_t before = digest(t);
    CHECK(grown < t->mesh.vertices && digest(t) == before);
    CHECK(dt_renew(t, NULL, &r) == DT_OK);
    CHECK(digest(t) == before && dt_renew_due(t)); /* it only reads */
    dt_renewed(t, r);
    CHECK(!dt_renew_due(t) && t->hinted == t->mesh.vertices && !t->mesh.recycled);
    CHECK(digest(t) == before && dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}

TEST(set_rebuilds_its_grid_itself_if_its_caller_does_not)
{
    struct dt *t = uniform_set();
    while (t->mesh.vertices <= 8 * POINTS)
        add_points(t, BATCH);
    CHECK(t->hinted > 7 * POINTS && !dt_renew_due(t));
    dt_free(t);
}

TEST(grid_without_memory_for_a_new_one_serves_on)
{
    struct dt *t = aged_set();
    uint64_t before = digest(t);
    for (long n = 1;; n++) {
        struct dt_renewal *r;
        test_fail_alloc(n);
        enum dt_status status = dt_renew(t, NULL, &r);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK((status == DT_OK) == (r != NULL) && (status == DT_OK || failed));
        dt_renewal_free(r);
        if (!failed)
            break;
    }
    dt_renewed(t, NULL);
    CHECK(!dt_renew_due(t) && digest(t) == before);
    add_points(t, BATCH);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}
