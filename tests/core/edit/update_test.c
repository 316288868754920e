/* update_test.c - edits of a live set through the public interface: a set of any history gives the
 * same replies as a new one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/query/locate.h"
#include "core/set/set.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MAX_IDS = 4000 };

/* The content that the set should have. */
struct expected {
    uint32_t ids;
    bool live[MAX_IDS];
    struct dt_point xy[MAX_IDS];
};

/* A fresh set with the same points and ids; dead ids come and go before it is triangulated. */
static struct dt *fresh_set(const struct expected *e)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint32_t deleted, missing;
    for (uint32_t id = 0; id < e->ids; id++) {
        struct dt_point p = e->live[id] ? e->xy[id] : (struct dt_point){1e20 + 1e8 * id, -1e20};
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    }
    for (uint32_t id = 0; id < e->ids; id++)
        CHECK(e->live[id] || dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

/* The next rows of both tables are the same; false at their end. */
static bool same_rows(const struct dt *a, struct dt_cursor *ca, const struct dt *b,
                      struct dt_cursor *cb)
{
    static uint32_t wa[2 * MAX_IDS], wb[2 * MAX_IDS];
    size_t rows_a, rows_b, words_a, words_b;
    CHECK(dt_table_read(a, ca, wa, 2 * MAX_IDS, 200, &rows_a, &words_a) == DT_OK);
    CHECK(dt_table_read(b, cb, wb, 2 * MAX_IDS, 200, &rows_b, &words_b) == DT_OK);
    CHECK(rows_a == rows_b && words_a == words_b && memcmp(wa, wb, words_a * sizeof *wa) == 0);
    return rows_a > 0;
}

static void check_equal(const struct dt *a, const struct dt *b)
{
    for (enum dt_table table = DT_POINTS; table <= DT_HULL; table++) {
        struct dt_cursor ca, cb;
        CHECK(dt_table_begin(a, NULL, table, false, &ca) == DT_OK &&
              dt_table_begin(b, NULL, table, false, &cb) == DT_OK);
        CHECK(ca.rows == cb.rows && ca.interior == cb.interior);
        while (same_rows(a, &ca, b, &cb))
            continue;
    }
}

static void check_current(const struct dt *t, const struct expected *e)
{
    const char *fault = NULL;
    CHECK_MSG(dt_check(t, NULL, &fault) == DT_OK, "%s", fault);
    struct dt *fresh = fresh_set(e);
    check_equal(t, fresh);
    dt_free(fresh);
}

static uint32_t random_live(const struct expected *e)
{
    for (unsigned tries = 0; e->ids > 0 && tries < 200; tries++) {
        uint32_t id = test_below(e->ids);
        if (e->live[id])
            return id;
    }
    return DT_NONE;
}

static void add(struct dt *t, struct expected *e, const struct dt_point *p, uint32_t n)
{
    struct dt_added added;
    if (e->ids + n > MAX_IDS)
        return;
    CHECK(dt_add(t, p, n, &added) == DT_OK && added.first == e->ids && added.added == n);
    for (uint32_t i = 0; i < n; i++) {
        e->live[e->ids] = true;
        e->xy[e->ids++] = p[i];
    }
}

static void delete_id(struct dt *t, struct expected *e, uint32_t id)
{
    uint32_t deleted, missing;
    CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK && deleted == 1);
    e->live[id] = false;
}

static void move(struct dt *t, struct expected *e, uint32_t id, struct dt_point to)
{
    CHECK(dt_move(t, id, to) == DT_OK);
    e->xy[id] = to;
}

TEST_TIMEOUT(edits_of_a_live_set_equal_a_fresh_set_at_every_step, 60)
{
    static struct expected e;
    for (unsigned round = 0; round < 30; round++) {
        struct dt *t = dt_new(0);
        uint32_t side = 1 + test_below(7), height = 1 + test_below(side);
        bool growing = true;
        memset(&e, 0, sizeof e);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (unsigned i = 0; i < 250; i++) {
            growing = test_below(25) == 0 ? !growing : growing;
            struct dt_point p = {test_below(side), test_below(height)};
            uint32_t id = random_live(&e), what = test_below(6);
            if (id == DT_NONE || what < (growing ? 3u : 1u))
                add(t, &e, &p, 1);
            else if (what < 4)
                delete_id(t, &e, id);
            else
                move(t, &e, id, p);
            CHECK(t->current);
            check_current(t, &e);
        }
        dt_free(t);
    }
}

TEST_TIMEOUT(edits_on_every_family_equal_a_fresh_set, 60)
{
    static struct expected e;
    static struct dt_point p[900];
    for (const struct family *f = families; f->name != NULL; f++) {
        struct dt *t = dt_new(0);
        memset(&e, 0, sizeof e);
        family_points(f, p, 900, test_random());
        add(t, &e, p, 400);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (unsigned i = 400; i < 900; i++) {
            uint32_t id = random_live(&e);
            add(t, &e, &p[i], 1);
            if (i % 3 == 0 && id != DT_NONE)
                delete_id(t, &e, id);
            else if (i % 3 == 1 && id != DT_NONE && e.live[id])
                move(t, &e, id, p[test_below(900)]);
        }
        CHECK(t->current);
        check_current(t, &e);
        for (unsigned left = 20; left > 0; left--)
            for (uint32_t id; test_below(100) > 0 && (id = random_live(&e)) != DT_NONE;)
                delete_id(t, &e, id);
        check_current(t, &e);
        dt_free(t);
    }
}

/* Most are within the star of the vertex, some are across the set. */
TEST_TIMEOUT(moves_of_every_size_equal_a_fresh_set_on_every_family, 60)
{
    enum { N = 200, MOVES = 60 };
    static struct expected e;
    static struct dt_point p[N];
    for (const struct family *f = families; f->name != NULL; f++) {
        struct dt *t = dt_new(0);
        memset(&e, 0, sizeof e);
        family_points(f, p, N, test_random());
        add(t, &e, p, N);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (unsigned i = 0; i < MOVES; i++) {
            uint32_t id = test_below(N), there = test_below(N);
            double part = ldexp(1, -(int)test_below(50));
            struct dt_point to = {e.xy[id].x + part * (e.xy[there].x - e.xy[id].x),
                                  e.xy[id].y + part * (e.xy[there].y - e.xy[id].y)};
            if (!dt_coordinate_ok(to.x) || !dt_coordinate_ok(to.y))
                continue;
            move(t, &e, id, to);
            CHECK(t->current);
            if (i % 4 == 0)
                check_current(t, &e);
        }
        check_current(t, &e);
        dt_free(t);
    }
}

TEST(small_moves_equal_a_fresh_set)
{
    static struct expected e;
    static struct dt_point p[1000];
    struct dt *t = dt_new(0);
    memset(&e, 0, sizeof e);
    family_points(family_find("uniform"), p, 1000, 3);
    add(t, &e, p, 1000);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (unsigned i = 0; i < 3000; i++) {
        uint32_t id = test_below(1000);
        struct dt_point to = e.xy[id];
        to.x += (test_uniform() - 0.5) * 0.02;
        to.y += (test_uniform() - 0.5) * 0.02;
        move(t, &e, id, to);
    }
    CHECK(t->current);
    check_current(t, &e);
    dt_free(t);
}

TEST(a_small_move_with_a_tolerance_stays_apart_or_becomes_an_alias)
{
    struct dt_point p[] = {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}, {4, 6}};
    struct dt *t = dt_new(1);
    struct dt_added added;
    struct dt_summary sum;
    uint32_t rep;
    CHECK(dt_add(t, p, 6, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_move(t, 4, (struct dt_point){4, 4.5}) == DT_OK);
    dt_summary(t, &sum);
    CHECK(sum.coincident == 0 && t->mesh.dead == 0);
    CHECK(dt_move(t, 4, (struct dt_point){4, 5.5}) == DT_OK);
    dt_summary(t, &sum);
    CHECK(sum.coincident == 1);
    CHECK(dt_representative(t, 4, &rep) == DT_OK && rep == 5);
    dt_free(t);
}

TEST(batches_on_a_live_set_equal_a_fresh_set)
{
    static struct expected e;
    static struct dt_point p[3000];
    const char *names[] = {"duplicates", "lattice_shuffled", "clusters", "small_lattice", "nested"};
    for (unsigned k = 0; k < 5; k++) {
        struct dt *t = dt_new(0);
        memset(&e, 0, sizeof e);
        family_points(family_find(names[k]), p, 3000, test_random());
        add(t, &e, p, 1000);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (uint32_t at = 1000, n; at < 3000; at += n) {
            n = 1 + test_below(120);
            n = at + n > 3000 ? 3000 - at : n;
            add(t, &e, p + at, n);
        }
        CHECK(dt_refresh(t, NULL) == DT_OK);
        check_current(t, &e);
        dt_free(t);
    }
}

TEST(a_crowd_in_one_corner_keeps_location_short)
{
    enum { N = 20000, CROWD = 100000 };
    struct dt_point *p = malloc(N * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint64_t steps = 0;
    family_points(family_find("uniform"), p, N, 3);
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (unsigned i = 0; i < CROWD; i++) {
        struct dt_point q = {test_uniform() * 1e-3, test_uniform() * 1e-3};
        CHECK(dt_add(t, &q, 1, &added) == DT_OK);
    }
    CHECK(t->current);
    for (unsigned i = 0; i < 1000; i++) {
        uint32_t h, walked;
        struct dt_point q = {test_uniform() * 1e-3, test_uniform() * 1e-3};
        dt_find_counting(t, q, &h, &walked);
        steps += walked;
    }
    CHECK_MSG(steps < 1000 * 12, "%.1f triangles a walk", (double)steps / 1000);
    dt_free(t);
    free(p);
}

/* Freed records are reused far from the empty cells that used them as hints. */
TEST(location_stays_short_when_points_come_and_go_everywhere)
{
    enum { N = 30000 };
    static struct dt_point p[N];
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint32_t deleted, missing;
    uint64_t steps = 0;
    family_points(family_find("uniform"), p, N, 3);
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < N; i++) {
        struct dt_point q = {test_uniform(), test_uniform()};
        CHECK(dt_delete(t, &i, 1, &deleted, &missing) == DT_OK);
        CHECK(dt_add(t, &q, 1, &added) == DT_OK);
    }
    for (unsigned i = 0; i < 5000; i++) {
        uint32_t h, walked;
        struct dt_point q = {test_uniform(), test_uniform()};
        dt_find_counting(t, q, &h, &walked);
        steps += walked;
    }
    CHECK_MSG(steps < 5000 * 4, "%.1f triangles a walk", (double)steps / 5000);
    dt_free(t);
}

TEST(a_set_that_is_edited_for_ever_does_not_grow)
{
    enum { N = 3000 };
    static struct dt_point p[N];
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint32_t deleted, missing;
    struct dt_summary s;
    family_points(family_find("uniform"), p, N, 3);
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < 100000; i++) {
        struct dt_point q = {test_uniform(), test_uniform()};
        CHECK(dt_delete(t, &i, 1, &deleted, &missing) == DT_OK);
        CHECK(dt_add(t, &q, 1, &added) == DT_OK);
    }
    dt_summary(t, &s);
    CHECK_MSG(t->current && s.memory < 1000000, "%zu bytes", s.memory);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}

/* One of two vertices is replaced by its alias, which lies a little away. */
TEST(successor_of_one_of_two_points_moves_to_its_own_place)
{
    const struct dt_point p[] = {{1, 7}, {1.25, 7}, {0, 8}};
    struct dt_added added;
    uint32_t deleted, missing, id = 0;
    for (unsigned moved = 0; moved < 2; moved++) {
        struct dt *t = dt_new(0.5);
        CHECK(dt_triangulate(t, NULL) == DT_OK && dt_add(t, p, 3, &added) == DT_OK);
        CHECK(added.coincident == 1);
        if (moved)
            CHECK(dt_move(t, id, (struct dt_point){5, 3}) == DT_OK);
        else
            CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
        CHECK(t->current && dt_check(t, NULL, NULL) == DT_OK);
        CHECK(t->mesh.vertices == 2 + moved);
        dt_free(t);
    }
}

TEST(live_sets_with_a_tolerance_equal_a_rebuild)
{
    for (unsigned round = 0; round < 20; round++) {
        struct dt *t = dt_new(0.6), *copy;
        struct dt_added added;
        uint32_t deleted, missing, n = 0;
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (unsigned i = 0; i < 150; i++) {
            struct dt_point q = {test_uniform() * 8, test_uniform() * 8};
            uint32_t id = n == 0 ? 0 : test_below(n), what = test_below(5);
            if (what < 3) {
                CHECK(dt_add(t, &q, 1, &added) == DT_OK);
                n++;
            } else if (what == 3) {
                dt_delete(t, &id, 1, &deleted, &missing);
            } else {
                dt_move(t, id, q);
            }
            CHECK(t->current && dt_check(t, NULL, NULL) == DT_OK);
            struct dt_options opt = {.method = DT_DIVIDE};
            CHECK(dt_clone(t, &copy) == DT_OK && dt_triangulate(copy, &opt) == DT_OK);
            check_equal(t, copy);
            dt_free(copy);
        }
        dt_free(t);
    }
}

TEST(a_promoted_alias_gets_its_own_place_in_the_mesh)
{
    struct dt_point p[] = {{0, 0}, {4, 0}, {0, 4}, {0.25, 0.25}, {1, 1}};
    struct dt *t = dt_new(0.5);
    struct dt_added added;
    uint32_t zero = 0, deleted, missing;
    CHECK(dt_add(t, p, 5, &added) == DT_OK && added.coincident == 1);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_delete(t, &zero, 1, &deleted, &missing) == DT_OK);
    CHECK(t->current && t->points.xy[dt_points_vertex(&t->points, 3)].x == 0.25);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}

TEST_TIMEOUT(live_edits_out_of_memory_leave_the_set_as_it_was, 60)
{
    static struct expected e;
    for (unsigned round = 0; round < 150; round++) {
        struct dt *t = dt_new(0);
        struct dt_added added;
        uint32_t deleted, missing;
        memset(&e, 0, sizeof e);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (unsigned i = 0; i < 60; i++) {
            struct dt_point p[20];
            uint32_t id = random_live(&e), n = 1 + test_below(20), what = test_below(4);
            for (unsigned k = 0; k < 20; k++)
                p[k] = (struct dt_point){test_below(9), test_below(9)};
            test_fail_alloc(1 + (long)test_below(6));
            enum dt_status status = DT_NOMEM;
            if (id == DT_NONE || what < 2)
                status = dt_add(t, p, n, &added);
            else if (what == 2)
                status = dt_delete(t, &id, 1, &deleted, &missing);
            else
                status = dt_move(t, id, p[0]);
            test_fail_alloc(0);
            for (uint32_t k = 0; status == DT_OK && (id == DT_NONE || what < 2) && k < n; k++) {
                e.live[e.ids] = true;
                e.xy[e.ids++] = p[k];
            }
            if (status == DT_OK && id != DT_NONE && what == 2)
                e.live[id] = false;
            if (status == DT_OK && id != DT_NONE && what == 3)
                e.xy[id] = p[0];
            CHECK(status == DT_OK || status == DT_NOMEM);
        }
        CHECK(dt_refresh(t, NULL) == DT_OK);
        check_current(t, &e);
        dt_free(t);
    }
}

/* A triangulated set deletes points one by one where it can, another one all at once; then both
 * have the same points, aliases and triangles. */
TEST(edits_leave_the_same_points_whether_or_not_a_set_is_live)
{
    for (unsigned round = 0; round < 60; round++) {
        double tol = round % 3 == 0 ? 0 : 0.6;
        struct dt *live = dt_new(tol), *plain = dt_new(tol);
        struct dt_added added;
        CHECK(dt_triangulate(live, NULL) == DT_OK);
        for (unsigned i = 0; i < 40; i++) {
            struct dt_point p[12];
            uint32_t ids[8], n = 1 + test_below(8), a, b, missing;
            for (unsigned k = 0; k < 12; k++)
                p[k] = (struct dt_point){test_below(9) * 0.25, test_below(9) * 0.25};
            CHECK(dt_add(live, p, n, &added) == DT_OK && dt_add(plain, p, n, &added) == DT_OK);
            for (unsigned k = 0; k < n; k++)
                do
                    ids[k] = test_below(dt_next_id(plain));
                while (dt_points_vertex(&plain->points, ids[k]) == DT_NONE);
            CHECK(dt_move(live, ids[0], p[11]) == DT_OK && dt_move(plain, ids[0], p[11]) == DT_OK);
            CHECK(dt_delete(live, ids, n, &a, &missing) == DT_OK);
            CHECK(dt_delete(plain, ids, n, &b, &missing) == DT_OK && a == b);
            CHECK(live->current && dt_check(live, NULL, NULL) == DT_OK);
            struct dt *copy;
            CHECK(dt_clone(plain, &copy) == DT_OK && dt_triangulate(copy, NULL) == DT_OK);
            check_equal(live, copy);
            dt_free(copy);
        }
        dt_free(live);
        dt_free(plain);
    }
}

/* More than an eighth of the points at once: the set is triangulated again on the next request. */
TEST(bulk_delete_from_a_live_set_equals_a_fresh_set)
{
    static struct expected e;
    static struct dt_point p[1000];
    for (unsigned round = 0; round < 5; round++) {
        struct dt *t = dt_new(0);
        uint32_t ids[300], deleted, missing;
        memset(&e, 0, sizeof e);
        family_points(family_find("uniform"), p, 1000, test_random());
        add(t, &e, p, 1000);
        CHECK(dt_triangulate(t, NULL) == DT_OK);
        for (uint32_t k = 0; k < 300; k++) {
            ids[k] = 3 * k + test_below(3);
            e.live[ids[k]] = false;
        }
        CHECK(dt_delete(t, ids, 300, &deleted, &missing) == DT_OK && deleted == 300);
        CHECK(!t->current && dt_refresh(t, NULL) == DT_OK);
        check_current(t, &e);
        dt_free(t);
    }
}
