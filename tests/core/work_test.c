/* work_test.c - calls that the caller ends: by a flag, or by a limit of steps. */
#include "core/work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/set.h"
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

TEST(a_search_takes_the_steps_it_is_allowed_or_says_that_it_takes_more)
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
