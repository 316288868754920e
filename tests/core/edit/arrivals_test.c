/* arrivals_test.c - points added all at once, compared with the same points added one by one. */
#include <stdlib.h>

#include "core/edit/arrivals.h"
#include "core/set/set.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { N = 12000, AT_ONCE = 5000, FEW_AT_ONCE = 700 };

/* Adds q[n] to t, `step` at a time. */
static uint32_t add_in_steps(struct dt *t, const struct dt_point *q, size_t n, size_t step,
                             const struct dt_pool *pool)
{
    const struct dt_options opt = {.pool = pool};
    uint32_t coincident = 0;
    for (size_t at = 0; at < n; at += step) {
        struct dt_added added;
        size_t k = n - at < step ? n - at : step;
        uint32_t first = dt_next_id(t);
        CHECK(dt_add_many(t, q + at, k, &opt, &added) == DT_OK);
        CHECK(added.first == first && added.added == k);
        coincident += added.coincident;
    }
    return coincident;
}

/* Checks that both sets agree about each id. */
static void check_same(const struct dt_points *got, const struct dt_points *want)
{
    CHECK(got->next_id == want->next_id && got->end == want->end);
    CHECK(got->aliases.count == want->aliases.count && got->free_count == want->free_count);
    for (uint32_t id = 0; id < want->next_id; id++) {
        uint32_t v = dt_points_vertex(got, id), w = dt_points_vertex(want, id);
        CHECK((v == DT_NONE) == (w == DT_NONE));
        if (v == DT_NONE)
            continue;
        struct dt_point a = dt_points_xy(got, id), b = dt_points_xy(want, id);
        CHECK(got->id[v] == want->id[w] &&
              dt_points_is_alias(got, id) == dt_points_is_alias(want, id));
        CHECK(a.x == b.x && a.y == b.y && 1 / a.x == 1 / b.x && 1 / a.y == 1 / b.y);
        CHECK(dt_points_heir(got, v, NULL, 0) == NULL ||
              dt_points_heir(got, v, NULL, 0)->id == dt_points_heir(want, w, NULL, 0)->id);
    }
}

/* Makes about one zero in two a negative one. */
static void give_signs(struct dt_point *q, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        q[i].x = q[i].x == 0 && test_below(2) ? -0.0 : q[i].x;
        q[i].y = q[i].y == 0 && test_below(2) ? -0.0 : q[i].y;
    }
}

TEST(points_added_at_once_get_the_ids_and_aliases_of_points_added_in_turn)
{
    static const char *const names[] = {"uniform", "duplicates", "same_place", "lattice",
                                        "small_lattice"};
    struct dt_point *q = malloc(N * sizeof *q);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        CHECK_MSG(family_find(names[i]) != NULL, "%s", names[i]);
        family_points(family_find(names[i]), q, N, test_random());
        give_signs(q, N);
        struct dt *want = dt_new(0);
        uint32_t coincident = add_in_steps(want, q, N, FEW_AT_ONCE, NULL);
        for (unsigned threads = 0; threads < 5; threads += 2) {
            struct dt_pool pool = threads_pool(threads == 0 ? 1 : threads);
            for (size_t step = AT_ONCE; step <= N; step += N - AT_ONCE) {
                struct dt *got = dt_new(0);
                CHECK(add_in_steps(got, q, N, step, threads == 0 ? NULL : &pool) == coincident);
                check_same(&got->points, &want->points);
                dt_free(got);
            }
        }
        dt_free(want);
    }
    free(q);
}

/* Deletes every third of the first n ids. */
static void delete_some(struct dt_points *p, uint32_t n)
{
    for (uint32_t id = 0; id < n; id += 3) {
        CHECK(dt_points_delete_ready(p, &id, 1, NULL) == DT_OK);
        dt_points_delete(p, id);
    }
}

TEST(points_added_at_once_coincide_with_existing_ones)
{
    struct dt_point *q = malloc(N * sizeof *q);
    for (size_t i = 0; i < N; i++)
        q[i] = (struct dt_point){test_below(80), test_below(80)};
    for (int deletes = 0; deletes < 2; deletes++) {
        struct dt *got = dt_new(0), *want = dt_new(0);
        add_in_steps(got, q, 900, FEW_AT_ONCE, NULL);
        add_in_steps(want, q, 900, FEW_AT_ONCE, NULL);
        if (deletes) {
            delete_some(&got->points, 300);
            delete_some(&want->points, 300);
        }
        CHECK(dt_arrivals_suit(&got->points, N) == !deletes &&
              !dt_arrivals_suit(&got->points, 899));
        add_in_steps(got, q, N, N, NULL);
        add_in_steps(want, q, N, FEW_AT_ONCE, NULL);
        check_same(&got->points, &want->points);
        CHECK((got->points.plan != NULL) == !deletes);
        add_in_steps(got, q, 500, 1, NULL); /* and the table of places is there when needed */
        add_in_steps(want, q, 500, 1, NULL);
        check_same(&got->points, &want->points);
        dt_free(got);
        dt_free(want);
    }
    free(q);
}

TEST(points_added_at_once_at_one_place_leave_no_room_for_vertices)
{
    enum { MANY = 1 << 18 };
    struct dt_point *q = malloc(MANY * sizeof *q);
    struct dt_pages *pages = dt_pages_new(SIZE_MAX);
    struct dt_pages_summary sum;
    struct dt_added added;
    for (size_t i = 0; i < MANY; i++)
        q[i] = (struct dt_point){test_below(9), 0};
    struct dt *t = dt_new_in(0, pages);
    CHECK(dt_add(t, q, MANY, &added) == DT_OK && t->points.end == 9);
    dt_pages_summary(pages, &sum);
    size_t in_use = sum.held - sum.kept;
    CHECK_MSG(in_use < dt_aliases_memory(&t->points.aliases) + (5u << 20), "%zu bytes", in_use);
    dt_free(t);
    dt_pages_free(pages);
    free(q);
}

TEST(points_added_at_once_are_all_added_or_none)
{
    enum { MANY = 6000 };
    struct dt_point *q = malloc(MANY * sizeof *q);
    struct dt *before = dt_new(0), *after = dt_new(0);
    struct dt_added added;
    for (size_t i = 0; i < MANY; i++)
        q[i] = (struct dt_point){test_below(60), test_below(60)};
    add_in_steps(before, q, 500, 500, NULL);
    add_in_steps(after, q, 500, 500, NULL);
    add_in_steps(after, q, MANY, FEW_AT_ONCE, NULL);
    bool failed = true;
    for (long nth = 1; failed; nth++) {
        struct dt *got = dt_new(0);
        add_in_steps(got, q, 500, 500, NULL);
        test_fail_alloc(nth);
        enum dt_status status = dt_add(got, q, MANY, &added);
        failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(status == DT_OK || (failed && status == DT_NOMEM));
        check_same(&got->points, status == DT_OK ? &after->points : &before->points);
        dt_free(got);
    }
    dt_free(before);
    dt_free(after);
    free(q);
}

/* A point that was added later has the last vertex, but not the last place. */
TEST(a_large_batch_of_points_that_are_all_there_leaves_a_sound_set)
{
    enum { MANY = 6000 };
    struct dt_point *q = malloc(MANY * sizeof *q);
    struct dt *t = dt_new(0);
    struct dt_added added;
    const char *fault = NULL;
    for (size_t i = 0; i < MANY; i++)
        q[i] = (struct dt_point){test_uniform(), test_uniform()};
    CHECK(dt_add(t, q + 9, MANY - 9, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_add(t, q, 9, &added) == DT_OK && t->points.end == MANY);
    CHECK(dt_add(t, q, MANY, &added) == DT_OK && added.coincident == MANY);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    CHECK_MSG(dt_check(t, NULL, &fault) == DT_OK, "%s", fault);
    dt_free(t);
    free(q);
}
