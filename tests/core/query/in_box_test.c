/* in_box_test.c - the triangles that meet a box, and the rows of tables in one: by searches and by sweeps. */
#include "core/exact/predicates.h"
#include "tests/core/sets.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

static bool is_in(struct dt_point p, struct dt_point lo, struct dt_point hi)
{
    return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y;
}

/* Whether a line along a side of the triangle or of the box separates them. */
static bool are_apart(const struct dt_point p[3], struct dt_point lo, struct dt_point hi)
{
    const struct dt_point box[4] = {lo, {hi.x, lo.y}, hi, {lo.x, hi.y}};
    for (int i = 0; i < 3; i++) {
        int right = 0;
        for (int k = 0; k < 4; k++)
            right += dt_orient2d(p[i], p[(i + 1) % 3], box[k]) < 0;
        if (right == 4)
            return true;
    }
    return fmax(fmax(p[0].x, p[1].x), p[2].x) < lo.x || fmax(fmax(p[0].y, p[1].y), p[2].y) < lo.y ||
           fmin(fmin(p[0].x, p[1].x), p[2].x) > hi.x || fmin(fmin(p[0].y, p[1].y), p[2].y) > hi.y;
}

static void want_triangles(const struct brute *b, bool cw, struct dt_point lo, struct dt_point hi,
                           struct dt_ids *want)
{
    struct dt_ids all = {0};
    brute_table(b, DT_TRIANGLES, cw, &all);
    for (size_t i = 0; i < all.n; i += 3) {
        const uint32_t *v = all.v + i;
        struct dt_point p[3] = {b->p[v[0]], b->p[v[cw ? 2 : 1]], b->p[v[cw ? 1 : 2]]};
        if (!are_apart(p, lo, hi))
            append_ids(want, v, 3);
    }
    free(all.v);
}

static void want_lists(const struct brute *b, bool cw, struct dt_point lo, struct dt_point hi,
                       struct dt_ids *want, size_t *interior, uint64_t *words)
{
    struct dt_ids all = {0};
    brute_table(b, DT_LISTS, cw, &all);
    *interior = *words = 0;
    for (size_t i = 0; i < all.n; i += 2 + all.v[i + 1]) {
        if (!is_in(b->p[all.v[i]], lo, hi))
            continue;
        append_ids(want, &all.v[i], 1);
        *interior += !brute_on_hull(b, all.v[i]);
        *words += 2 + all.v[i + 1];
    }
    free(all.v);
}

/* By a look at every row. */
static struct dt_sift sift(const struct dt *t, enum dt_table table, bool cw, struct dt_point lo,
                           struct dt_point hi, struct dt_ids *out)
{
    struct dt_sift s = {.lo = lo, .hi = hi};
    bool done = false;
    CHECK(dt_table_begin(t, NULL, table, cw, &s.cursor) == DT_OK);
    while (!done)
        CHECK(dt_sift_read(t, &s, 1 + test_random() % 7, out, &done) == DT_OK);
    return s;
}

static void check_box(const struct pair *pair, bool cw, struct dt_point lo, struct dt_point hi)
{
    struct dt_ids want = {0}, found = {0}, sifted = {0};
    size_t interior;
    uint64_t words;
    want_triangles(pair->b, cw, lo, hi, &want);
    CHECK(dt_within_triangles(pair->t, lo, hi, cw, NULL, &found) == DT_OK);
    check_equal_ids("triangles", &found, &want);
    CHECK(sift(pair->t, DT_TRIANGLES, cw, lo, hi, &sifted).words == want.n);
    check_equal_ids("triangles, one after the other", &sifted, &want);
    want.n = sifted.n = 0;
    want_lists(pair->b, cw, lo, hi, &want, &interior, &words);
    struct dt_sift s = sift(pair->t, DT_LISTS, cw, lo, hi, &sifted);
    check_equal_ids("points", &sifted, &want);
    CHECK(s.words == words && (pair->b->line != NULL || s.interior == interior));
    free(want.v);
    free(found.v);
    free(sifted.v);
}

static void check_boxes(const struct pair *pair)
{
    for (int i = 0; i < 12; i++) {
        struct dt_point a = random_place(pair->b), b = i % 4 == 0 ? a : random_place(pair->b);
        struct dt_point lo = {fmin(a.x, b.x), fmin(a.y, b.y)},
                        hi = {fmax(a.x, b.x), fmax(a.y, b.y)};
        check_box(pair, i % 2 == 0, lo, hi);
    }
    check_box(pair, false, (struct dt_point){-0x1p200, -0x1p200},
              (struct dt_point){0x1p200, 0x1p200});
}

TEST_TIMEOUT(triangles_that_meet_a_box_are_those_that_no_line_separates_from_it, 120)
{
    for_each_pair(check_boxes);
}

TEST(a_small_box_takes_few_steps_to_find_its_triangles)
{
    enum { N = 20000 };
    struct dt_point *p = malloc(N * sizeof *p);
    CHECK(p != NULL);
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_uniform(), test_uniform()};
    struct dt *t = set_of(p, N);
    CHECK(dt_prepare(t, NULL) == DT_OK);
    struct dt_ids out = {0};
    struct dt_options few = {.steps = 500};
    struct dt_point lo = {0.5, 0.5}, hi = {0.52, 0.52}, far = {0.9, 0.9};
    CHECK(dt_within_triangles(t, lo, hi, false, &few, &out) == DT_OK && out.n > 20);
    out.n = 0;
    CHECK(dt_within_triangles(t, lo, far, false, &few, &out) == DT_TOOLONG && out.n == 0);
    free(out.v);
    dt_free(t);
    free(p);
}
