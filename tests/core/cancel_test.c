/* cancel_test.c - long work on a set polls all the way: whichever poll sees the flag, the call ends, and the
 * set is as before. */
#include <math.h>
#include <stdlib.h>

#include "core/set.h"
#include "tests/core/polls.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MANY = 250000, TRIALS = 12 };

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
        sum += (uint64_t)(t->points.xy[v].x * 0x1p40) ^ (uint64_t)(t->points.xy[v].y * 0x1p40);
        sum += dt_points_vertex(&t->points, t->points.id[v]) ^ v;
    }
    for (uint32_t i = 0; i < t->mesh.tri_end; i++)
        for (uint32_t k = 0; k < 3; k++)
            sum = (sum ^ t->mesh.half[8 * i + k]) * 0x9E3779B97F4A7C15u;
    return sum;
}

/* Work that may be given up. DT_CANCELLED: what it was for is not there. */
typedef enum dt_status work(struct dt *t, const struct dt_options *opt);

/* Lets the work be cancelled at TRIALS of its polls, and then end; returns how often it polls. */
static uint64_t cancel_everywhere(struct dt *t, work *run, const struct dt_options *opt)
{
    uint64_t before = sum_of(t);
    struct dt *whole;
    CHECK(dt_clone(t, &whole) == DT_OK);
    polls_begin();
    CHECK(run(whole, opt) == DT_OK);
    uint64_t polls = polls_count();
    dt_free(whole);
    CHECK_MSG(polls >= TRIALS, "it polls %llu times", (unsigned long long)polls);
    for (uint64_t i = 0; i < TRIALS; i++) {
        uint64_t nth = 1 + i * (polls - 1) / (TRIALS - 1);
        polls_cancel_at(nth);
        enum dt_status status = run(t, opt);
        polls_cancel_at(0);
        CHECK_MSG(status == DT_CANCELLED, "poll %llu of %llu: status %d", (unsigned long long)nth,
                  (unsigned long long)polls, status);
        CHECK(sum_of(t) == before);
    }
    CHECK(run(t, opt) == DT_OK && (!t->current || dt_check(t, NULL, NULL) == DT_OK));
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

TEST_TIMEOUT(a_grid_for_searches_is_given_up_at_every_poll, 60)
{
    static const char *const names[] = {"uniform", "kuzmin", "line_axis", "thin_line"};
    struct dt_pool pool = threads_pool(2);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct dt *t = set_of(names[i], MANY, true);
        struct dt_options opt = {.cancel = &flag, .pool = i % 2 == 0 ? NULL : &pool};
        cancel_everywhere(t, prepare, &opt);
        cancel_everywhere(t, renew, &opt);
        dt_free(t);
    }
}

/* Between two polls at most so many points are looked at, on average of a pass: a build has at least
 * three passes over all, a grid two over the cells and one over the points. */
TEST_TIMEOUT(polls_grow_with_the_points, 60)
{
    enum { BETWEEN = 1 << 16 };
    for (size_t n = MANY; n <= 4 * MANY; n *= 4) {
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
TEST_TIMEOUT(long_merges_poll_and_are_given_up, 60)
{
    uint64_t polls[2];
    static const char *const names[2] = {"uniform", "cross"};
    struct dt_pool pool = threads_pool(2);
    for (int i = 0; i < 2; i++) {
        struct dt *t = set_of(names[i], MANY, false);
        struct dt_options opt = {.cancel = &flag};
        polls[i] = cancel_everywhere(t, triangulate, &opt);
        dt_free(t);
        t = set_of(names[i], MANY, false);
        opt.pool = &pool;
        cancel_everywhere(t, triangulate, &opt);
        dt_free(t);
    }
    CHECK_MSG(polls[1] > polls[0] + MANY / 1024, "%llu and %llu polls",
              (unsigned long long)polls[0], (unsigned long long)polls[1]);
}
