/* stop_test.c - calls that end early: by a flag, or by a limit of steps. */
#include "core/control/stop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/set/set.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { N = 20000 };

static const double turn = 6.283185307179586;

/* A triangulated set of a hub, which is point 0, and n points on a circle around it. */
static struct dt *wheel(uint32_t n)
{
    struct dt_point *p = malloc((n + (size_t)1) * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    p[0] = (struct dt_point){0, 0};
    for (uint32_t i = 1; i <= n; i++)
        p[i] = (struct dt_point){cos(turn * i / n), sin(turn * i / n)};
    CHECK(dt_add(t, p, n + (size_t)1, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_prepare(t, NULL) == DT_OK);
    free(p);
    return t;
}

static struct dt *family_set(const char *name, uint32_t n)
{
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    family_points(family_find(name), p, n, 7);
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_prepare(t, NULL) == DT_OK);
    free(p);
    return t;
}

/* ---- searches ---- */

enum { NEAREST, BOX, DISC, LISTS, SEARCHES };

static const char *const search_name[] = {"nearest", "within a box", "within a disc", "lists"};

static enum dt_status search(const struct dt *t, int what, const struct dt_options *opt,
                             struct dt_ids *out)
{
    const struct dt_place middle = {{0.5, 0.5}, DT_NONE};
    size_t kept, interior;
    switch (what) {
    case NEAREST:
        return dt_nearest_place(t, &middle, N / 2, opt, out);
    case BOX:
        return dt_within_box(t, (struct dt_point){0.1, 0.1}, (struct dt_point){0.9, 0.8}, opt, out);
    case DISC:
        return dt_within_disc(t, middle.at, 0.4, opt, out);
    default:
        out->v = realloc(out->v, N * sizeof *out->v);
        for (out->n = 0; out->n < N; out->n++)
            out->v[out->n] = N - 1 - (uint32_t)out->n;
        return dt_lists_order(t, false, out->v, N, opt, &kept, &interior);
    }
}

TEST(a_search_whose_flag_is_set_is_cancelled)
{
    struct dt *t = family_set("uniform", N);
    atomic_bool cancel = true;
    const struct dt_options opt = {.cancel = &cancel};
    for (int what = 0; what < SEARCHES; what++) {
        struct dt_ids out = {0};
        CHECK_MSG(search(t, what, &opt, &out) == DT_CANCELLED, "%s", search_name[what]);
        CHECK(out.n == 0 || what == LISTS);
        cancel = false;
        CHECK(search(t, what, &opt, &out) == DT_OK);
        cancel = true;
        free(out.v);
    }
    dt_free(t);
}

TEST(a_search_stays_within_its_limit_or_reports_that_it_needs_more_steps)
{
    struct dt *t = family_set("uniform", N);
    for (int what = 0; what < SEARCHES; what++) {
        struct dt_ids want = {0};
        CHECK(search(t, what, NULL, &want) == DT_OK);
        enum dt_status status = DT_TOOLONG;
        for (uint32_t steps = 1; status == DT_TOOLONG; steps *= 2) {
            struct dt_ids got = {0};
            const struct dt_options opt = {.steps = steps};
            status = search(t, what, &opt, &got);
            CHECK(status == DT_TOOLONG || status == DT_OK);
            CHECK_MSG((status == DT_TOOLONG) == (steps <= N / 4) || steps > N / 4,
                      "%s: %u steps are enough", search_name[what], steps);
            CHECK_MSG(steps < 32 * N, "%s takes more than %u steps", search_name[what], steps);
            if (status == DT_OK)
                CHECK(got.n == want.n && memcmp(got.v, want.v, got.n * sizeof *got.v) == 0);
            else
                CHECK(got.n == 0 || what == LISTS);
            free(got.v);
        }
        free(want.v);
    }
    dt_free(t);
}

/* ---- degrees ---- */

TEST(the_degree_of_a_hub_is_counted_up_to_a_limit)
{
    struct dt *t = wheel(1000), *bare = dt_new(0);
    struct dt_added added;
    uint32_t deleted, missing, gone = 7;
    CHECK(dt_degree_up_to(t, 0, DT_NONE) == 1000 && dt_degree_up_to(t, 0, 1000) == 1000);
    CHECK(dt_degree_up_to(t, 0, 999) == 999 && dt_degree_up_to(t, 0, 1) == 1);
    CHECK(dt_degree_up_to(t, 500, DT_NONE) == 3); /* on the hull: infinity is no neighbour */
    CHECK(dt_add(t, &(struct dt_point){0, 0}, 1, &added) == DT_OK && added.coincident == 1);
    CHECK(dt_degree_up_to(t, added.first, DT_NONE) == 1000); /* an alias */
    CHECK(dt_delete(t, &gone, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_degree_up_to(t, gone, DT_NONE) == 0 && dt_degree_up_to(t, 12345678, 5) == 0);
    CHECK(dt_add(bare, &(struct dt_point){0, 0}, 1, &added) == DT_OK);
    CHECK(dt_degree_up_to(bare, 0, 5) == 0);
    CHECK(dt_triangulate(bare, NULL) == DT_OK && dt_degree_up_to(bare, 0, 5) == 0);
    dt_free(t);
    dt_free(bare);
}

/* ---- edits ---- */

/* Fails unless the sets have the same points and, if both are triangulated, the same
 * triangulation. */
static void check_same(const struct dt *a, const struct dt *b)
{
    static uint32_t wa[1 << 16], wb[1 << 16];
    size_t rows_a, rows_b, words_a, words_b;
    enum dt_table last = b->triangulated ? DT_HULL : DT_COINCIDENT;
    CHECK(a->triangulated == b->triangulated && dt_next_id(a) == dt_next_id(b));
    for (enum dt_table table = DT_POINTS; table <= last; table++) {
        struct dt_cursor ca, cb;
        CHECK(dt_table_begin(a, NULL, table, false, &ca) == DT_OK &&
              dt_table_begin(b, NULL, table, false, &cb) == DT_OK);
        do {
            CHECK(dt_table_read(a, &ca, wa, 1 << 16, 1 << 16, &rows_a, &words_a) == DT_OK);
            CHECK(dt_table_read(b, &cb, wb, 1 << 16, 1 << 16, &rows_b, &words_b) == DT_OK);
            CHECK(rows_a == rows_b && words_a == words_b &&
                  memcmp(wa, wb, words_a * sizeof *wa) == 0);
        } while (rows_a > 0);
    }
    for (uint32_t id = dt_points_next_live(&a->points, 0); id != DT_NONE;
         id = dt_points_next_live(&a->points, id + 1)) {
        struct dt_point p, q;
        CHECK(dt_get(a, id, &p) == DT_OK && dt_get(b, id, &q) == DT_OK);
        CHECK(p.x == q.x && p.y == q.y);
    }
}

static void check_sound(const struct dt *t)
{
    const char *fault = NULL;
    if (t->triangulated)
        CHECK_MSG(t->current && dt_check(t, NULL, &fault) == DT_OK, "%s", fault);
}

enum { BATCH = 150, SOME = 3000 };

/* Edits at random, the same for the same seed. */
struct edits {
    struct dt_point add[BATCH];
    uint32_t remove[BATCH], move;
    struct dt_point to, near; /* where that one moves: anywhere, or near where it is */
};

static struct dt_point near_lattice(double tol)
{
    struct dt_point p = {test_below(60), test_below(60)};
    p.x += tol > 0 ? test_uniform() : 0;
    return p;
}

static struct edits random_edits(const struct dt *t, double tol)
{
    struct edits e;
    for (unsigned i = 0; i < BATCH; i++) {
        e.add[i] = near_lattice(tol);
        e.remove[i] = test_below(dt_next_id(t));
    }
    for (unsigned i = 0; i < BATCH; i++)
        while (dt_points_vertex(&t->points, e.remove[i]) == DT_NONE)
            e.remove[i] = test_below(dt_next_id(t));
    e.move = e.remove[0];
    e.to = near_lattice(tol);
    CHECK(dt_get(t, e.move, &e.near) == DT_OK);
    e.near.x += 0.9 * (test_uniform() - 0.5);
    e.near.y += 0.9 * (test_uniform() - 0.5);
    return e;
}

enum { ADD, DELETE, MOVE, MOVE_NEAR, EDITS };

static const char *const edit_name[] = {"add", "delete", "move", "small move"};

static enum dt_status edit(struct dt *t, int what, const struct edits *e,
                           const struct dt_options *opt)
{
    struct dt_added added;
    uint32_t deleted, missing;
    if (what == ADD)
        return dt_add_many(t, e->add, BATCH, opt, &added);
    if (what == DELETE)
        return dt_delete_many(t, e->remove, BATCH, opt, &deleted, &missing);
    return dt_move_to(t, e->move, what == MOVE ? e->to : e->near, opt);
}

/* A set of points many of which coincide. */
static struct dt *crowded_set(double tol, bool live)
{
    static struct dt_point p[SOME];
    struct dt *t = dt_new(tol);
    struct dt_added added;
    for (unsigned i = 0; i < SOME; i++)
        p[i] = near_lattice(tol);
    CHECK(dt_add(t, p, SOME, &added) == DT_OK);
    CHECK(!live || dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static struct dt *copy_of(const struct dt *t)
{
    struct dt *copy;
    CHECK(dt_clone(t, &copy) == DT_OK);
    return copy;
}

TEST(an_edit_whose_flag_is_set_is_cancelled_and_changes_nothing)
{
    atomic_bool cancel = true;
    const struct dt_options opt = {.cancel = &cancel};
    for (unsigned round = 0; round < 4 * EDITS; round++) {
        double tol = round % 2 == 0 ? 0 : 0.3;
        struct dt *t = crowded_set(tol, round % 4 < 2), *before = copy_of(t);
        struct edits e = random_edits(t, tol);
        int what = (int)round / 4;
        CHECK_MSG(edit(t, what, &e, &opt) == DT_CANCELLED, "%s", edit_name[what]);
        check_same(t, before);
        check_sound(t);
        dt_free(t);
        dt_free(before);
    }
}

/* Wherever the edit is interrupted, the set is unchanged; once it succeeds, the result is as
 * without a limit. */
TEST(an_edit_beyond_its_limit_is_undone)
{
    for (unsigned round = 0; round < 8; round++) {
        double tol = round % 4 < 2 ? 0 : 0.3;
        struct dt *t = crowded_set(tol, true);
        for (int what = 0; what < EDITS; what++) {
            struct dt *before = copy_of(t), *after = copy_of(t);
            struct edits e = random_edits(t, tol);
            unsigned tries = 0;
            CHECK(edit(after, what, &e, NULL) == DT_OK);
            for (uint32_t steps = 1;
                 edit(t, what, &e, &(struct dt_options){.steps = steps}) != DT_OK;
                 steps += 1 + steps / 2) {
                check_same(t, before);
                check_sound(t);
                CHECK_MSG(++tries < 100, "%s needs more than %u steps", edit_name[what], steps);
            }
            CHECK(tries > 0 || what >= MOVE);
            check_same(t, after);
            check_sound(t);
            dt_free(before);
            dt_free(after);
        }
        dt_free(t);
    }
}

TEST_TIMEOUT(an_edit_for_which_memory_has_run_out_for_good_leaves_the_set_as_it_was, 60)
{
    unsigned failures = 0;
    for (unsigned round = 0; round < 30; round++) {
        double tol = round % 4 < 2 ? 0 : 0.3;
        struct dt *t = crowded_set(tol, true);
        for (int what = 0; what < EDITS; what++) {
            struct edits e = random_edits(t, tol);
            struct dt *before = copy_of(t);
            enum dt_status status = DT_NOMEM;
            for (long nth = 1; status == DT_NOMEM; nth++) {
                dt_cavity_clear(&t->scratch); /* it would have grown long ago */
                test_fail_alloc_from(nth);
                status = edit(t, what, &e, NULL);
                test_fail_alloc(0);
                failures += status == DT_NOMEM;
                if (!t->current) /* no memory for the rollback either */
                    CHECK(dt_refresh(t, NULL) == DT_OK);
                if (status == DT_NOMEM)
                    check_same(t, before);
                check_sound(t);
            }
            CHECK(status == DT_OK);
            dt_free(before);
        }
        dt_free(t);
    }
    CHECK(failures > 100);
}
