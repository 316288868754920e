/* pointlist_test.c - rings of single points and the order of the point list. */
#include <stdlib.h>
#include <string.h>

#include "tests/core/sets.h"
#include "tests/test.h"

static void check_rings(const struct pair *pair)
{
    for (uint32_t id = 0; id < pair->b->n; id++) {
        for (int cw = 0; cw < 2; cw++) {
            uint32_t rep = pair->b->rep[id], got_rep = DT_NONE;
            bool boundary = false;
            struct dt_ids got = {0}, want = {0};
            enum dt_status s = dt_ring(pair->t, id, cw, &got, &got_rep, &boundary);
            CHECK(s == (rep == DT_NONE ? DT_NOPOINT : DT_OK));
            if (rep == DT_NONE)
                continue;
            brute_ring(pair->b, rep, cw, &want);
            CHECK(got_rep == rep && boundary == brute_on_hull(pair->b, rep));
            check_equal_ids("ring", &got, &want);
            free(got.v);
            free(want.v);
        }
    }
}

TEST(rings_equal_brute_force_on_every_family)
{
    for_each_pair(check_rings);
}

/* Some ids, again and again and in any order, must come out as the point list has them. */
static void check_order(const struct pair *pair)
{
    uint32_t ids[40], n = 0;
    bool asked[256] = {false};
    struct dt_ids rows = {0}, want = {0};
    bool cw = test_below(2) == 1;
    size_t kept = 0, interior = 0, want_interior = 0;
    for (int i = 0; pair->b->n > 0 && i < 40; i++) {
        uint32_t id = test_below(pair->b->n);
        if (pair->b->rep[id] == DT_NONE || test_below(3) == 0)
            continue;
        ids[n++] = id;
        asked[pair->b->rep[id]] = true;
    }
    brute_table(pair->b, DT_LISTS, cw, &rows);
    for (size_t i = 0; i < rows.n; i += 2 + rows.v[i + 1]) {
        if (!asked[rows.v[i]])
            continue;
        rows.v[want.n++] = rows.v[i];
        want_interior += !brute_on_hull(pair->b, rows.v[want.n - 1]);
    }
    want.v = rows.v;
    CHECK(dt_lists_order(pair->t, cw, ids, n, NULL, &kept, &interior) == DT_OK);
    struct dt_ids got = {.v = ids, .n = kept};
    check_equal_ids("order of lists", &got, &want);
    CHECK(interior == want_interior);
    free(rows.v);
}

TEST(some_points_come_in_the_order_of_the_point_list)
{
    for (int i = 0; i < 5; i++)
        for_each_pair(check_order);
}

/* The sanitizer of undefined behaviour watches. */
TEST(order_of_no_points_needs_no_array)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}};
    size_t kept = 1, interior = 1;
    struct dt *t = set_of(p, 3);
    CHECK(dt_lists_order(t, false, NULL, 0, NULL, &kept, &interior) == DT_OK);
    CHECK(kept == 0 && interior == 0);
    dt_free(t);
}

TEST(order_of_lists_with_a_missing_id_changes_nothing)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}};
    uint32_t ids[] = {2, 1, 7};
    size_t kept, interior;
    struct dt *t = set_of(p, 3);
    CHECK(dt_lists_order(t, false, ids, 3, NULL, &kept, &interior) == DT_NOPOINT);
    CHECK(ids[0] == 2 && ids[1] == 1 && ids[2] == 7);
    test_fail_alloc(1);
    CHECK(dt_lists_order(t, false, ids, 2, NULL, &kept, &interior) == DT_NOMEM);
    CHECK(ids[0] == 2 && ids[1] == 1);
    dt_free(t);
}

TEST(rings_are_appended_and_left_alone_when_out_of_memory)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    struct dt *t = set_of(p, 5);
    struct dt_ids ring = {0};
    uint32_t rep;
    bool boundary;
    test_fail_alloc(1);
    CHECK(dt_ring(t, 4, false, &ring, &rep, &boundary) == DT_NOMEM && ring.n == 0 &&
          ring.v == NULL);
    CHECK(dt_ring(t, 4, false, &ring, &rep, &boundary) == DT_OK && ring.n == 4 && !boundary);
    CHECK(dt_ring(t, 0, false, &ring, &rep, &boundary) == DT_OK && ring.n == 7 && boundary);
    CHECK(ring.v[0] == 0 && ring.v[3] == 3 && ring.v[4] == 1 && ring.v[5] == 4 && ring.v[6] == 3);
    free(ring.v);
    dt_free(t);
}
