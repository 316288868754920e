/* prefetch_test.c - prefetching accepts any set, place and id and changes nothing; no hint, good or
 * bad, changes a result. */
#include "core/delaunay.h"
#include "core/exact/predicates.h"
#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

#include <stdlib.h>

/* The set's replies about places and ids, as one number. */
static uint64_t digest(const struct dt *t, const struct dt_place *p, const uint32_t *id, size_t n)
{
    uint64_t sum = 1;
    struct dt_ids ids = {0};
    for (size_t i = 0; i < n; i++) {
        uint32_t rep;
        bool boundary;
        struct dt_location at = {0};
        ids.n = 0;
        sum = sum * 31 + dt_nearest_place(t, &p[i], 1 + (uint32_t)i % 2, NULL, &ids);
        sum = sum * 31 + dt_locate_place(t, &p[i], &at);
        sum = sum * 31 + dt_ring(t, id[i], false, &ids, &rep, &boundary);
        for (size_t k = 0; k < ids.n; k++)
            sum = sum * 31 + ids.v[k];
        sum = sum * 31 + (uint64_t)at.where + at.id[0];
    }
    free(ids.v);
    return sum;
}

/* Queries, prefetches, and queries again. */
static void fetch(const struct dt *t)
{
    struct dt_place p[DT_AHEAD];
    uint32_t id[DT_AHEAD];
    for (int round = 0; round < 4; round++) {
        for (size_t i = 0; i < DT_AHEAD; i++) {
            p[i].near = UINT32_MAX;
            p[i].at.x = (test_uniform() - 0.5) * (i % 8 == 0 ? 0x1p200 : 40);
            p[i].at.y = (test_uniform() - 0.5) * (i % 8 == 1 ? 0x1p200 : 40);
            id[i] = i % 8 == 0 ? (uint32_t)test_random() : test_below(dt_next_id(t) + 2);
        }
        id[3] = UINT32_MAX;
        size_t n = test_below(DT_AHEAD + 1);
        uint64_t before = digest(t, p, id, n);
        dt_fetch_places(t, p, n);
        dt_fetch_ids(t, id, n);
        dt_fetch_edits(t, id, n);
        dt_fetch_points(t, id, n);
        dt_fetch_places(t, p, DT_AHEAD + 1); /* more than it takes: nothing is done */
        dt_fetch_ids(t, id, DT_AHEAD + 1);
        dt_fetch_edits(t, id, DT_AHEAD + 1);
        dt_fetch_points(t, id, DT_AHEAD + 1);
        CHECK(digest(t, p, id, n) == before);
        for (size_t i = 0; i < n; i++) /* hints of other places, of other times, of nothing */
            p[i].near = i % 3 == 0 ? (uint32_t)test_random() : test_below(64 + 16 * dt_next_id(t));
        CHECK(digest(t, p, id, n) == before);
    }
}

static void fetch_pair(const struct pair *pair)
{
    fetch(pair->t);
}

TEST(prefetching_accepts_every_family)
{
    for_each_pair(fetch_pair);
}

TEST(prefetching_accepts_sets_without_triangles)
{
    static const struct dt_point line[] = {{0, 0}, {1, 1}, {2, 2}, {5, 5}, {3, 3}};
    struct dt *bare = dt_new(0);
    fetch(bare);
    dt_free(bare);
    for (uint32_t n = 0; n <= 5; n++) {
        struct dt *t = set_of(line, n);
        fetch(t);
        dt_free(t);
    }
}

TEST(prefetching_accepts_a_set_that_is_edited)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(t != NULL);
    for (int round = 0; round < 40; round++) {
        struct dt_point p[60];
        uint32_t deleted, missing;
        for (int i = 0; i < 60; i++)
            p[i] = (struct dt_point){test_below(40) - 20.0, test_below(40) - 20.0};
        CHECK(dt_add(t, p, 60, &added) == DT_OK);
        if (round == 3)
            CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (int i = 0; i < 55; i++) { /* dead triangles, recycled ones, deleted ids */
            uint32_t id = test_below(dt_next_id(t));
            dt_delete(t, &id, 1, &deleted, &missing);
        }
        CHECK(round < 3 || (dt_refresh(t, NULL) == DT_OK && dt_prepare(t, NULL) == DT_OK));
        fetch(t);
    }
    dt_free(t);
}

/* Whether p is in the closed triangle of the half edge p->near. */
static bool is_around(const struct dt *t, const struct dt_place *p)
{
    const uint32_t *corner = &t->mesh.half[dt_base(p->near)];
    struct dt_point a = t->points.xy[corner[0]], b = t->points.xy[corner[1]],
                    c = t->points.xy[corner[2]];
    return dt_orient2d(a, b, p->at) >= 0 && dt_orient2d(b, c, p->at) >= 0 &&
           dt_orient2d(c, a, p->at) >= 0;
}

TEST(walks_side_by_side_end_in_the_triangles_of_their_places)
{
    enum { POINTS = 3000 };
    static struct dt_point p[POINTS];
    family_points(family_find("uniform"), p, POINTS, 1);
    struct dt *t = set_of(p, POINTS);
    uint32_t found = 0;
    CHECK(dt_prepare(t, NULL) == DT_OK);
    for (int round = 0; round < 100; round++) {
        struct dt_place place[DT_AHEAD];
        for (uint32_t i = 0; i < DT_AHEAD; i++) {
            struct dt_point a = p[test_below(POINTS)], b = p[test_below(POINTS)];
            place[i].at = (struct dt_point){(a.x + b.x) / 2, (a.y + b.y) / 2};
        }
        dt_fetch_places(t, place, DT_AHEAD);
        for (uint32_t i = 0; i < DT_AHEAD; i++)
            found += place[i].near != DT_NONE && is_around(t, &place[i]);
    }
    CHECK_MSG(found > 95 * DT_AHEAD, "%u of %d", found, 100 * DT_AHEAD);
    dt_free(t);
}
