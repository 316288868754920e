/* cancel_test.c - long operations poll until they end: whichever poll sees the flag, the call ends,
 * and the set is unchanged. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/sort.h"
#include "core/set/set.h"
#include "tests/core/polls.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static uint32_t points(void)
{
    return test_is_sanitized() ? 100000 : 250000;
}

static uint64_t trials(void)
{
    return test_is_sanitized() ? 4 : 12;
}

static atomic_bool flag; /* never set: polls_cancel_at is */

static struct dt *set_of(const char *family, size_t n, bool live)
{
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(p != NULL && t != NULL);
    family_points(family_find(family), p, n, 1);
    CHECK(dt_add(t, p, n, &added) == DT_OK);
    CHECK(!live || dt_triangulate(t, NULL) == DT_OK);
    free(p);
    return t;
}

/* A number that differs if the vertices, their ids or the triangulation do. */
static uint64_t sum_of(const struct dt *t)
{
    uint64_t sum = t->current;
    for (uint32_t v = 0; v < t->points.end; v++) {
        sum = (sum ^ t->points.id[v]) * 0x9E3779B97F4A7C15u;
        uint64_t place[2];
        memcpy(place, &t->points.xy[v], sizeof place);
        sum = (sum ^ place[0]) * 0x9E3779B97F4A7C15u + place[1];
        sum += dt_points_vertex(&t->points, t->points.id[v]) ^ v;
    }
    for (uint32_t i = 0; i < t->mesh.tri_end; i++)
        for (uint32_t k = 0; k < 3; k++)
            sum = (sum ^ t->mesh.half[8 * i + k]) * 0x9E3779B97F4A7C15u;
    return sum;
}

/* An operation that may be cancelled. DT_CANCELLED: it has no result. */
typedef enum dt_status work(struct dt *t, const struct dt_options *opt);

static uint64_t count_polls(struct dt *t, work *run, const struct dt_options *opt)
{
    polls_begin();
    CHECK(run(t, opt) == DT_OK);
    return polls_count();
}

/* Cancels the operation at trials() of its polls, then lets it finish. */
static void cancel_at_some(struct dt *t, work *run, const struct dt_options *opt, uint64_t polls)
{
    uint64_t before = sum_of(t);
    CHECK_MSG(polls >= trials(), "it polls %llu times", (unsigned long long)polls);
    for (uint64_t i = 0; i < trials(); i++) {
        uint64_t nth = 1 + i * (polls - 1) / (trials() - 1);
        polls_cancel_at(nth);
        enum dt_status status = run(t, opt);
        polls_cancel_at(0);
        CHECK_MSG(status == DT_CANCELLED, "poll %llu of %llu: status %d", (unsigned long long)nth,
                  (unsigned long long)polls, status);
        CHECK(sum_of(t) == before);
    }
    CHECK(run(t, opt) == DT_OK && (!t->current || dt_check(t, NULL, NULL) == DT_OK));
}

/* The same; returns the number of polls, which is that of a copy. */
static uint64_t cancel_everywhere(struct dt *t, work *run, const struct dt_options *opt)
{
    struct dt *copy;
    CHECK(dt_clone(t, &copy) == DT_OK);
    uint64_t polls = count_polls(copy, run, opt);
    dt_free(copy);
    cancel_at_some(t, run, opt, polls);
    return polls;
}

static enum dt_status prepare(struct dt *t, const struct dt_options *opt)
{
    enum dt_status status = dt_prepare(t, opt);
    CHECK((status == DT_OK) == (t->hints.grids > 0));
    CHECK((t->hinted == 0) == (status != DT_OK));
    return status;
}

static enum dt_status renew(struct dt *t, const struct dt_options *opt)
{
    struct dt_renewal *r;
    enum dt_status status = dt_renew(t, opt, &r);
    CHECK((r != NULL) == (status == DT_OK));
    dt_renewal_free(r);
    return status;
}

static enum dt_status triangulate(struct dt *t, const struct dt_options *opt)
{
    return dt_triangulate(t, opt);
}

TEST_TIMEOUT(a_grid_for_searches_can_be_cancelled_at_every_poll, 60)
{
    static const char *const names[] = {"uniform", "kuzmin", "line_axis", "thin_line"};
    struct dt_pool pool = threads_pool(2);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct dt *t = set_of(names[i], points(), true);
        struct dt_options opt = {.cancel = &flag, .pool = i % 2 == 0 ? NULL : &pool};
        uint64_t polls = count_polls(
            t, renew, &opt); /* those of a copy, whose mesh is laid out otherwise, differ */
        cancel_at_some(t, prepare, &opt, polls);
        cancel_at_some(t, renew, &opt, polls);
        dt_free(t);
    }
}

/* Maximum number of points between two polls, on average over a pass: a build has at least
 * three passes over all, a grid two over the cells and one over the points. */
TEST_TIMEOUT(polls_grow_with_the_points, 60)
{
    enum { BETWEEN = 1 << 16 };
    for (size_t n = points(); n <= (size_t)4 * points(); n *= 4) {
        struct dt *t = set_of("uniform", n, false);
        struct dt_options opt = {.cancel = &flag};
        polls_begin();
        CHECK(dt_triangulate(t, &opt) == DT_OK);
        CHECK(polls_count() >= 3 * n / BETWEEN);
        polls_begin();
        CHECK(dt_prepare(t, &opt) == DT_OK);
        CHECK(polls_count() >= 3 * n / BETWEEN);
        dt_free(t);
    }
}

/* The seams of a cross are as long as its arms. On uniform points they are short. */
TEST_TIMEOUT(long_merges_poll_and_can_be_cancelled, 60)
{
    uint64_t polls[2];
    static const char *const names[2] = {"uniform", "cross"};
    struct dt_pool pool = threads_pool(2);
    for (int i = 0; i < 2; i++) {
        struct dt *t = set_of(names[i], points(), false);
        struct dt_options opt = {.cancel = &flag};
        polls[i] = cancel_everywhere(t, triangulate, &opt);
        dt_free(t);
        t = set_of(names[i], points(), false);
        opt.pool = &pool;
        cancel_everywhere(t, triangulate, &opt);
        dt_free(t);
    }
    CHECK_MSG(polls[1] > polls[0] + points() / 1024, "%llu and %llu polls",
              (unsigned long long)polls[0], (unsigned long long)polls[1]);
}

/* Loads points into an empty set. */
static enum dt_status load_points(struct dt *t, const struct dt_point *p, uint32_t n,
                                  const struct dt_options *opt)
{
    struct dt_added added;
    enum dt_status status = dt_add_many(t, p, n, opt, &added);
    CHECK(dt_next_id(t) == (status == DT_OK ? n : 0));
    return status;
}

static enum dt_status load(struct dt *t, const struct dt_options *opt)
{
    uint32_t n = points();
    struct dt_point *p = malloc(n * sizeof *p);
    CHECK(p != NULL);
    family_points(family_find("duplicates"), p, n, 1);
    enum dt_status status = load_points(t, p, n, opt);
    free(p);
    return status;
}

static enum dt_status load_one_place(struct dt *t, const struct dt_options *opt)
{
    uint32_t n = 250000; /* some polls of each pass */
    struct dt_point *p = calloc(n, sizeof *p);
    CHECK(p != NULL);
    enum dt_status status = load_points(t, p, n, opt);
    free(p);
    return status;
}

TEST_TIMEOUT(a_load_can_be_cancelled_at_every_poll, 60)
{
    struct dt_pool pool = threads_pool(2);
    for (int i = 0; i < 2; i++) {
        struct dt *t = dt_new(0);
        struct dt_options opt = {.cancel = &flag, .pool = i == 0 ? NULL : &pool};
        CHECK(t != NULL && cancel_everywhere(t, load, &opt) > points() / DT_POLL_MISSES);
        dt_free(t);
    }
}

/* Names that were never written must not be used. */
TEST_TIMEOUT(a_load_of_points_at_one_place_can_be_cancelled_at_its_first_polls, 60)
{
    polls_begin();
    for (uint64_t nth = 1; nth <= 24; nth++) {
        struct dt *t = dt_new(0);
        polls_cancel_at(nth);
        CHECK(t != NULL &&
              load_one_place(t, &(struct dt_options){.cancel = &flag}) == DT_CANCELLED);
        polls_cancel_at(0);
        dt_free(t);
    }
}

static enum dt_status clone_points(struct dt *t, const struct dt_options *opt)
{
    struct dt *copy = NULL;
    enum dt_status status = dt_clone_points(t, opt, &copy);
    CHECK((copy != NULL) == (status == DT_OK));
    dt_free(copy);
    return status;
}

TEST_TIMEOUT(a_copy_can_be_cancelled_at_every_poll, 60)
{
    struct dt *t = set_of("duplicates", points(), true);
    cancel_everywhere(t, clone_points, &(struct dt_options){.cancel = &flag});
    dt_free(t);
}

/* Every other id of a set, the last one first, so that they have to be sorted. */
static enum dt_status delete_half(struct dt *t, const struct dt_options *opt)
{
    uint32_t n = dt_next_id(t) / 2, deleted, missing, *ids = malloc(n * sizeof *ids);
    CHECK(ids != NULL);
    for (uint32_t i = 0; i < n; i++)
        ids[i] = 2 * (n - 1 - i);
    enum dt_status status = dt_delete_many(t, ids, n, opt, &deleted, &missing);
    CHECK(status != DT_OK || deleted == n);
    free(ids);
    return status;
}

TEST_TIMEOUT(a_deletion_of_many_can_be_cancelled_until_it_begins, 60)
{
    struct dt *t = set_of("duplicates", points(), true);
    cancel_everywhere(t, delete_half, &(struct dt_options){.cancel = &flag});
    dt_free(t);
}

/* A set of so many vertices that they are renumbered in parts, with gaps and families. */
static struct dt *set_with_gaps(void)
{
    enum { N = (1 << 21) + 100000, EVERY = 50 };
    struct dt *t = set_of("uniform", N, false);
    struct dt_added added;
    static struct dt_point again[N / EVERY];
    static uint32_t ids[N / EVERY];
    uint32_t deleted, missing;
    for (uint32_t i = 0; i < N / EVERY; i++) {
        ids[i] = i * EVERY;
        CHECK(dt_get(t, ids[i] + 1, &again[i]) == DT_OK);
    }
    CHECK(dt_add(t, again, N / EVERY, &added) == DT_OK && added.coincident == N / EVERY);
    CHECK(dt_delete(t, ids, N / EVERY, &deleted, &missing) == DT_OK && deleted == N / EVERY);
    return t;
}

/* Cancels a build at its last polls, and some before. */
static void cancel_at_the_end(struct dt *t, const struct dt_options *opt, bool disposable)
{
    enum { LAST = 40, STEP = 30 };
    struct dt_options now = *opt;
    uint64_t before = sum_of(t);
    struct dt *whole;
    CHECK(dt_clone(t, &whole) == DT_OK);
    now.disposable = disposable;
    polls_begin();
    CHECK(dt_triangulate(whole, &now) == DT_OK);
    uint64_t polls = polls_count();
    dt_free(whole);
    for (uint64_t i = 0; i < LAST; i += STEP) {
        struct dt *copy = t;
        CHECK(!disposable || dt_clone(t, &copy) == DT_OK);
        polls_cancel_at(polls - i);
        enum dt_status status = dt_triangulate(copy, &now);
        polls_cancel_at(0);
        CHECK(status == DT_CANCELLED);
        if (disposable)
            dt_free(copy);
        else
            CHECK(sum_of(t) == before);
    }
}

TEST_TIMEOUT(a_build_can_be_cancelled_until_it_changes_the_set_and_of_a_disposable_set_to_the_end,
             120)
{
    struct dt_pool pool = threads_pool(2);
    struct dt_options opt = {.cancel = &flag, .pool = &pool};
    struct dt *t = set_with_gaps();
    cancel_at_the_end(t, &opt, false);
    cancel_at_the_end(t, &opt, true);
    CHECK(dt_triangulate(t, &opt) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}

TEST_TIMEOUT(a_disposable_set_is_deleted_from_with_polls, 60)
{
    struct dt *t = set_of("duplicates", points(), true), *copy;
    struct dt_options opt = {.cancel = &flag}, disposable = {.cancel = &flag, .disposable = true};
    uint64_t polls[2];
    for (int i = 0; i < 2; i++) {
        CHECK(dt_clone(t, &copy) == DT_OK);
        polls_begin();
        CHECK(delete_half(copy, i == 0 ? &opt : &disposable) == DT_OK);
        polls[i] = polls_count();
        dt_free(copy);
    }
    CHECK(polls[1] > polls[0] + points() / 2 / DT_POLL_MISSES);
    for (uint64_t nth = polls[0]; nth <= polls[1]; nth += 5) {
        CHECK(dt_clone(t, &copy) == DT_OK);
        polls_cancel_at(nth);
        CHECK(delete_half(copy, &disposable) == DT_CANCELLED);
        polls_cancel_at(0);
        dt_free(copy);
    }
    dt_free(t);
}

/* Makes a fresh set from the content of the set. */
static enum dt_status restore(struct dt *t, const struct dt_options *opt)
{
    uint32_t n = dt_next_id(t), *ids = malloc(n * sizeof *ids), *rep = malloc(n * sizeof *rep);
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt *fresh = dt_new(0);
    CHECK(ids != NULL && rep != NULL && p != NULL && fresh != NULL);
    for (uint32_t i = 0; i < n; i++) {
        ids[i] = i;
        CHECK(dt_get(t, i, &p[i]) == DT_OK && dt_representative(t, i, &rep[i]) == DT_OK);
    }
    enum dt_status status = dt_restore(fresh, ids, p, rep, n, n, opt);
    CHECK(dt_next_id(fresh) == (status == DT_OK ? n : 0));
    dt_free(fresh);
    free(ids);
    free(rep);
    free(p);
    return status;
}

TEST_TIMEOUT(a_restoration_can_be_cancelled_at_every_poll, 60)
{
    struct dt *t = set_of("duplicates", points(), false);
    cancel_everywhere(t, restore, &(struct dt_options){.cancel = &flag});
    dt_free(t);
}

TEST(ids_in_any_order_are_sorted)
{
    enum { N = 200000 };
    uint32_t *ids = malloc(N * sizeof *ids), mask[] = {UINT32_MAX, 1, 0x7ff, 0x3ff800, 0xffc00000};
    struct dt_stop stop = dt_stop_of(NULL);
    uint64_t random = test_random() | 1;
    for (size_t k = 0; k < sizeof mask / sizeof mask[0]; k++)
        for (size_t n = 0; n <= N; n = n * 7 + 1) {
            uint32_t sum = 0;
            for (size_t i = 0; i < n; i++) {
                random = random * 6364136223846793005u + 1442695040888963407u;
                ids[i] = (uint32_t)(random >> 32) & mask[k];
                sum += ids[i];
            }
            dt_sort_ids(ids, n, NULL, &stop);
            for (size_t i = 0; i < n; i++) {
                CHECK(i == 0 || ids[i - 1] <= ids[i]);
                sum -= ids[i];
            }
            CHECK(sum == 0);
        }
    free(ids);
}
