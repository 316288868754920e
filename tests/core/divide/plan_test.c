/* plan_test.c - points of one large batch are sorted for the build; an edit discards that. */
#include <stdlib.h>
#include <string.h>

#include "core/set/set.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static struct dt *loaded(const char *family, size_t n, uint64_t seed, const struct dt_options *opt)
{
    struct dt *t = dt_new(0);
    struct dt_point *p = malloc(n * sizeof *p);
    struct dt_added added;
    family_points(family_find(family), p, n, seed);
    CHECK(t != NULL && dt_add_many(t, p, n, opt, &added) == DT_OK);
    free(p);
    return t;
}

static void check_built(struct dt *t, const char *family)
{
    const char *fault = "";
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK_MSG(dt_check(t, NULL, &fault) == DT_OK, "%s: %s", family, fault);
}

/* Checks that both agree about every vertex. */
static void check_same(const struct dt *a, const struct dt *b, const char *family)
{
    size_t n = a->points.end;
    CHECK_MSG(n == b->points.end && a->mesh.tri_end == b->mesh.tri_end, "%s", family);
    CHECK(memcmp(a->points.xy, b->points.xy, n * sizeof *a->points.xy) == 0);
    CHECK(memcmp(a->points.id, b->points.id, n * sizeof *a->points.id) == 0);
    for (uint32_t h = 0; h < 8 * a->mesh.tri_end; h++)
        CHECK_MSG(h % 4 == 3 || a->mesh.half[h] == b->mesh.half[h], "%s", family);
}

TEST_TIMEOUT(points_of_every_family_are_sorted_for_their_build_on_any_number_of_threads, 60)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (size_t n = 64; n <= 20000; n = 7 * n + 13) {
            uint64_t seed = test_random();
            struct dt *one = loaded(f->name, n, seed, NULL);
            CHECK_MSG(one->points.plan != NULL, "%s", f->name);
            check_built(one, f->name);
            CHECK(one->points.plan == NULL); /* nobody needs it again */
            for (unsigned threads = 2; threads <= 7; threads += 5) {
                struct dt_pool pool = threads_pool(threads);
                struct dt_options opt = {.pool = &pool};
                struct dt *t = loaded(f->name, n, seed, &opt);
                CHECK(dt_triangulate(t, &opt) == DT_OK);
                check_same(one, t, f->name);
                dt_free(t);
            }
            dt_free(one);
        }
}

TEST_TIMEOUT(tiles_are_sorted_for_their_build_on_any_number_of_threads, 180)
{
    static const char *const names[] = {"uniform", "clusters", "exponents", "duplicates"};
    enum { MANY = 300000 };
    struct dt_pool pool = threads_pool(3);
    struct dt_options opt = {.pool = &pool};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        uint64_t seed = test_random();
        struct dt *one = loaded(names[i], MANY, seed, NULL);
        struct dt *three = loaded(names[i], MANY, seed, &opt);
        check_built(one, names[i]);
        CHECK(dt_triangulate(three, &opt) == DT_OK);
        check_same(one, three, names[i]);
        dt_free(one);
        dt_free(three);
    }
}

static void add_one(struct dt *t)
{
    struct dt_added added;
    CHECK(dt_add(t, &(struct dt_point){-1, -2}, 1, &added) == DT_OK);
}

static void add_many(struct dt *t)
{
    enum { MANY = 5000 };
    struct dt_added added;
    struct dt_point *p = malloc(MANY * sizeof *p);
    for (size_t i = 0; i < MANY; i++)
        p[i] = (struct dt_point){(double)i, -1 - (double)(i * i % 97)};
    CHECK(dt_add(t, p, MANY, &added) == DT_OK);
    free(p);
}

static void delete_some(struct dt *t)
{
    uint32_t deleted, missing;
    CHECK(dt_delete(t, (uint32_t[]){3, 77}, 2, &deleted, &missing) == DT_OK);
}

static void move_one(struct dt *t)
{
    CHECK(dt_move(t, 50, (struct dt_point){5, 5}) == DT_OK);
}

TEST(an_edit_before_the_build_ends_the_plan)
{
    void (*const edits[])(struct dt *) = {add_one, delete_some, move_one};
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        struct dt *t = loaded("uniform", 1000, test_random(), NULL);
        CHECK(t->points.plan != NULL);
        edits[i](t);
        CHECK(t->points.plan == NULL);
        check_built(t, "uniform");
        dt_free(t);
    }
}

TEST(many_points_added_before_the_build_get_a_plan_with_the_others)
{
    struct dt *t = loaded("uniform", 1000, test_random(), NULL);
    add_many(t);
    CHECK(t->points.plan != NULL);
    check_built(t, "uniform");
    dt_free(t);
}

TEST(a_clone_is_built_by_the_same_plan)
{
    struct dt *t = loaded("clusters", 3000, test_random(), NULL), *copy;
    CHECK(dt_clone_points(t, NULL, &copy) == DT_OK && copy->points.plan != NULL);
    check_built(t, "clusters");
    check_built(copy, "a clone of clusters");
    check_same(t, copy, "clusters");
    dt_free(t);
    dt_free(copy);
}

TEST(a_build_by_a_plan_that_runs_out_of_memory_can_be_tried_again)
{
    struct dt_pool pool = threads_pool(2);
    for (int threads = 1; threads <= 2; threads++) {
        struct dt_options opt = {.pool = threads > 1 ? &pool : NULL};
        struct dt *t = loaded("uniform", 5000, 1, NULL);
        enum dt_status status = DT_NOMEM;
        for (long nth = 1; status != DT_OK; nth++) {
            test_fail_alloc(nth);
            status = dt_triangulate(t, &opt);
            test_fail_alloc(0);
            CHECK(status == DT_OK || status == DT_NOMEM);
        }
        check_built(t, "uniform");
        dt_free(t);
    }
}

static void one_after_the_other(void *ctx, unsigned n, void (*job)(void *arg, unsigned i),
                                void *arg)
{
    (void)ctx;
    for (unsigned i = 0; i < n; i++)
        job(arg, i);
}

TEST(a_build_by_a_plan_reports_its_progress_to_the_end_on_any_number_of_threads)
{
    for (unsigned threads = 1; threads <= 4; threads++) {
        struct dt_pool pool = {.threads = threads, .run = one_after_the_other};
        atomic_uint progress = 0;
        struct dt_options opt = {.pool = &pool, .progress = &progress};
        struct dt *t = loaded("uniform", 20000, 1, NULL);
        CHECK(dt_triangulate(t, &opt) == DT_OK);
        CHECK_MSG(progress == 99, "%u on %u threads", progress, threads);
        dt_free(t);
    }
}

TEST(a_restored_set_is_sorted_for_its_build)
{
    enum { N = 500 };
    static struct dt_point p[N];
    static uint32_t id[N];
    family_points(family_find("uniform"), p, N, 3);
    for (uint32_t i = 0; i < N; i++)
        id[i] = 3 * i + 1;
    struct dt *t = dt_new(0);
    CHECK(dt_restore(t, id, p, id, N, 3 * N + 1, NULL) == DT_OK && t->points.plan != NULL);
    check_built(t, "restored");
    for (uint32_t i = 0; i < N; i++) {
        struct dt_point q;
        CHECK(dt_get(t, id[i], &q) == DT_OK && q.x == p[i].x && q.y == p[i].y);
    }
    dt_free(t);
}
