/* lookup_test.c - the triangles and the nearest points of many places at once, against brute force.
 * At the moment of a view: view_tables_test.c. */
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

enum { PLACES = 3 * DT_AHEAD + 1 };

static bool contains(const struct brute *b, const uint32_t *id, struct dt_point q)
{
    return dt_orient2d(b->p[id[0]], b->p[id[1]], q) >= 0 &&
           dt_orient2d(b->p[id[1]], b->p[id[2]], q) >= 0 &&
           dt_orient2d(b->p[id[2]], b->p[id[0]], q) >= 0;
}

/* The first triangle of the table that contains q. */
static void first_triangle(const struct brute *b, const struct dt_ids *triangles, struct dt_point q,
                           uint32_t *out)
{
    out[0] = out[1] = out[2] = DT_NONE;
    for (size_t i = 0; i < triangles->n; i += 3) {
        const uint32_t *id = triangles->v + i;
        if (!contains(b, id, q))
            continue;
        for (unsigned k = 0; k < 3; k++)
            out[k] = id[k];
        return;
    }
}

static void random_places(const struct brute *b, struct dt_point *p)
{
    for (unsigned i = 0; i < PLACES; i++)
        p[i] = random_place(b);
}

static void check_triangles(const struct pair *pair)
{
    struct dt_point p[PLACES];
    uint32_t got[3 * PLACES], want[3 * PLACES];
    struct dt_ids triangles = {0};
    size_t done;
    brute_table(pair->b, DT_TRIANGLES, false, &triangles);
    random_places(pair->b, p);
    CHECK(dt_locate_many(pair->t, NULL, p, PLACES, NULL, got, &done) == DT_OK && done == PLACES);
    for (unsigned i = 0; i < PLACES; i++)
        first_triangle(pair->b, &triangles, p[i], want + 3 * i);
    check_equal_ids("triangles", &(struct dt_ids){got, 3 * PLACES, 0},
                    &(struct dt_ids){want, 3 * PLACES, 0});
    free(triangles.v);
}

TEST_TIMEOUT(many_places_have_the_first_triangle_that_contains_them_on_every_family, 60)
{
    for_each_pair(check_triangles);
}

static void check_nearest(const struct pair *pair)
{
    enum { MOST = 20 };
    static const uint32_t ks[] = {0, 1, 2, 7, MOST};
    struct dt_point p[PLACES];
    uint32_t got[MOST * PLACES];
    size_t done;
    random_places(pair->b, p);
    for (unsigned j = 0; j < 5; j++) {
        uint32_t k = ks[j];
        CHECK(dt_nearest_many(pair->t, NULL, p, PLACES, k, NULL, got, &done) == DT_OK);
        CHECK(done == PLACES);
        for (unsigned i = 0; i < PLACES; i++) {
            struct dt_ids want = {0};
            brute_nearest(pair->b, p[i], k, &want);
            while (want.n < k)
                append_ids(&want, &(uint32_t){DT_NONE}, 1);
            check_equal_ids("nearest", &(struct dt_ids){got + (size_t)k * i, k, 0}, &want);
            free(want.v);
        }
    }
}

TEST_TIMEOUT(many_places_have_their_nearest_points_on_every_family, 60)
{
    for_each_pair(check_nearest);
}

TEST(many_places_are_refused_before_the_set_is_triangulated)
{
    struct dt *t = dt_new(0);
    struct dt_point p = {0, 0};
    uint32_t out[3];
    size_t done = 7;
    CHECK(dt_locate_many(t, NULL, &p, 1, NULL, out, &done) == DT_UNTRIANGULATED && done == 0);
    CHECK(dt_nearest_many(t, NULL, &p, 1, 1, NULL, out, &done) == DT_UNTRIANGULATED);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_locate_many(t, NULL, &p, 1, NULL, out, &done) == DT_OK && done == 1);
    CHECK(out[0] == DT_NONE && out[1] == DT_NONE && out[2] == DT_NONE);
    CHECK(dt_nearest_many(t, NULL, &p, 1, 2, NULL, out, &done) == DT_OK && done == 1);
    CHECK(out[0] == DT_NONE && out[1] == DT_NONE);
    dt_free(t);
}

/* A call that reaches its limit of steps has answered a part; the next call continues after that part. */
TEST(many_places_are_answered_in_parts_by_calls_that_may_take_few_steps)
{
    struct dt_point hub[201], p[PLACES];
    uint32_t whole[3 * PLACES], parts[3 * PLACES];
    size_t done, at = 0, calls = 0;
    for (unsigned i = 0; i < 200; i++)
        hub[i] = (struct dt_point){cos(i * 0.0314), sin(i * 0.0314)};
    hub[200] = (struct dt_point){0, 0};
    struct dt *t = set_of(hub, 201);
    for (unsigned i = 0; i < PLACES; i++)
        p[i] = i % 8 == 0 ? hub[200] : (struct dt_point){test_uniform() / 2, test_uniform() / 2};
    CHECK(dt_locate_many(t, NULL, p, PLACES, NULL, whole, &done) == DT_OK);
    for (enum dt_status st = DT_TOOLONG; st != DT_OK; at += done, calls++) {
        st = dt_locate_many(t, NULL, p + at, PLACES - at, &(struct dt_options){.steps = 20},
                            parts + 3 * at, &done);
        CHECK(st == DT_OK || (st == DT_TOOLONG && done > 0));
    }
    CHECK(calls > 3 && at == PLACES);
    check_equal_ids("triangles", &(struct dt_ids){parts, 3 * PLACES, 0},
                    &(struct dt_ids){whole, 3 * PLACES, 0});
    dt_free(t);
}

TEST(look_ups_of_many_places_stop_when_the_flag_is_set)
{
    struct dt_point p[3] = {{0, 0}, {4, 0}, {0, 4}};
    uint32_t out[9];
    size_t done;
    atomic_bool cancel = true;
    struct dt *t = set_of(p, 3);
    CHECK(dt_locate_many(t, NULL, p, 3, &(struct dt_options){.cancel = &cancel}, out, &done) ==
          DT_CANCELLED);
    CHECK(done == 0);
    dt_free(t);
}

/* The nearest point of a place, now and at the moment of the view. */
static void check_nearest_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                               uint32_t now, uint32_t then)
{
    uint32_t id;
    size_t done;
    CHECK(dt_nearest_many(t, NULL, &q, 1, 1, NULL, &id, &done) == DT_OK && id == now);
    CHECK(dt_nearest_many(t, v, &q, 1, 1, NULL, &id, &done) == DT_OK && id == then);
}

/* A point that moves a little keeps its ring, and its neighbours keep theirs. */
TEST(many_places_remember_a_neighbour_that_has_moved_and_kept_its_ring)
{
    static const struct dt_point p[] = {{0, 0}, {1, 0}, {0.4, 1}, {0.6, -1}, {-1, 0.1}, {2, -0.1}};
    struct dt *t = set_of(p, 6);
    struct dt_view *v = dt_view_begin(t, true);
    CHECK(dt_move(t, 1, (struct dt_point){1.001, 0}) == DT_OK);
    check_nearest_then(t, v, (struct dt_point){0.5001, 0}, 0, 1);
    dt_view_end(v);
    dt_free(t);
}

/* Of the corners of a cell of a lattice, all as near to its middle, two are not joined. */
TEST(many_places_remember_a_point_as_near_as_another_that_it_was_not_joined_to)
{
    enum { SIDE = 4, N = SIDE * SIDE };
    struct dt_point p[N], q = {1.5, 1.5};
    uint32_t first, deleted, missing;
    size_t done;
    for (int round = 0; round < 100; round++) {
        for (uint32_t i = 0; i < N; i++) {
            uint32_t k = test_below(i + 1);
            p[i] = p[k];
            p[k] = (struct dt_point){i % SIDE, i / SIDE};
        }
        struct dt *t = set_of(p, N);
        CHECK(dt_nearest_many(t, NULL, &q, 1, 1, NULL, &first, &done) == DT_OK);
        struct dt_view *v = dt_view_begin(t, true);
        CHECK(dt_delete(t, &first, 1, &deleted, &missing) == DT_OK);
        uint32_t now, then;
        CHECK(dt_nearest_many(t, NULL, &q, 1, 1, NULL, &now, &done) == DT_OK && now != first);
        CHECK(dt_nearest_many(t, v, &q, 1, 1, NULL, &then, &done) == DT_OK && then == first);
        dt_view_end(v);
        dt_free(t);
    }
}
