/* sweep_test.c - results found by a scan of every row, against the searches. */
#include "tests/core/sets.h"
#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

/* The result of a whole sweep over the view, `piece` rows at a time. */
static struct dt_ids sweep_all(const struct dt *t, const struct dt_view *v, struct dt_sweep s,
                               size_t piece)
{
    struct dt_ids ids = {0};
    for (bool done = false; !done;) {
        CHECK(dt_sweep_read(t, v, &s, piece) == DT_OK);
        CHECK(dt_sweep_sift(&s, &ids, &done) == DT_OK);
    }
    CHECK(dt_sweep_end(&s, NULL, &ids) == DT_OK);
    dt_sweep_clear(&s);
    return ids;
}

static void check_sweep(const struct dt *t, const struct dt_view *v, struct dt_sweep s)
{
    struct dt_ids got = sweep_all(t, v, s, 1 + test_below(50)), want = {0};
    if (s.kind == DT_SWEEP_BOX)
        CHECK(dt_within_box(t, s.at, s.hi, NULL, &want) == DT_OK);
    else if (s.kind == DT_SWEEP_DISC)
        CHECK(dt_within_disc(t, s.at, s.radius, NULL, &want) == DT_OK);
    else
        CHECK(dt_nearest(t, s.at, s.k, &want) == DT_OK);
    check_equal_ids("a sweep", &got, &want);
    free(got.v);
    free(want.v);
}

static struct dt_point some_place(const struct pair *pair)
{
    struct dt_point p = {test_uniform(), test_uniform()}, q;
    if (pair->b->n == 0 || dt_get(pair->t, test_below(pair->b->n), &q) != DT_OK)
        return p;
    return test_below(2) == 0 ? q : (struct dt_point){q.x + p.x, q.y - p.y};
}

static void check_sweeps(const struct pair *pair)
{
    struct dt_view *v = dt_view_begin(pair->t, false);
    CHECK(v != NULL);
    for (int i = 0; i < 5; i++) {
        struct dt_point a = some_place(pair), b = some_place(pair);
        check_sweep(pair->t, v,
                    (struct dt_sweep){.kind = DT_SWEEP_BOX,
                                      .at = {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y},
                                      .hi = {a.x < b.x ? b.x : a.x, a.y < b.y ? b.y : a.y}});
        double radius = a.x < b.x ? b.x - a.x : a.x - b.x;
        check_sweep(pair->t, v,
                    (struct dt_sweep){.kind = DT_SWEEP_DISC, .at = a, .radius = radius});
        check_sweep(pair->t, v,
                    (struct dt_sweep){.kind = DT_SWEEP_NEAREST, .at = a, .k = test_below(100)});
    }
    dt_view_end(v);
    dt_view_tidy(pair->t);
}

TEST_TIMEOUT(sweeps_find_what_searches_find_on_every_family, 60)
{
    for_each_pair(check_sweeps);
}

TEST(sweep_finds_the_points_of_its_moment_despite_edits_meanwhile)
{
    enum { N = 500 };
    struct dt *t = dt_new(0), *then;
    struct dt_added added;
    for (int i = 0; i < N; i++)
        CHECK(dt_add(t, &(struct dt_point){test_uniform(), test_uniform()}, 1, &added) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK && dt_clone(t, &then) == DT_OK);
    struct dt_view *v = dt_view_begin(t, false);
    struct dt_sweep s = {.kind = DT_SWEEP_NEAREST, .at = {0.5, 0.5}, .k = 200};
    struct dt_ids got = {0}, want = {0};
    for (bool done = false; !done;) {
        uint32_t deleted, missing, id = test_below(N);
        CHECK(dt_sweep_read(t, v, &s, 20) == DT_OK);
        CHECK(dt_sweep_sift(&s, &got, &done) == DT_OK);
        CHECK(dt_add(t, &(struct dt_point){0.5, test_uniform()}, 1, &added) == DT_OK);
        (void)dt_delete(t, &id, 1, &deleted, &missing);
        (void)dt_move(t, test_below(N), (struct dt_point){test_uniform(), 0.5});
    }
    CHECK(dt_sweep_end(&s, NULL, &got) == DT_OK && dt_nearest(then, s.at, s.k, &want) == DT_OK);
    check_equal_ids("a sweep beside edits", &got, &want);
    dt_sweep_clear(&s);
    dt_view_end(v);
    free(got.v);
    free(want.v);
    dt_free(then);
    dt_free(t);
}

TEST(sweep_whose_flag_is_set_ends_before_it_sorts)
{
    enum { N = 5000 };
    struct dt *t = dt_new(0);
    struct dt_added added;
    for (int i = 0; i < N; i++)
        CHECK(dt_add(t, &(struct dt_point){test_uniform(), test_uniform()}, 1, &added) == DT_OK);
    struct dt_view *v = dt_view_begin(t, false);
    struct dt_sweep s = {.kind = DT_SWEEP_NEAREST, .k = N};
    struct dt_ids ids = {0};
    bool done;
    CHECK(dt_sweep_read(t, v, &s, N + 1) == DT_OK && dt_sweep_sift(&s, &ids, &done) == DT_OK);
    atomic_bool flag = true;
    CHECK(done && dt_sweep_end(&s, &(struct dt_options){.cancel = &flag}, &ids) == DT_CANCELLED);
    dt_sweep_clear(&s);
    dt_view_end(v);
    free(ids.v);
    dt_free(t);
}
