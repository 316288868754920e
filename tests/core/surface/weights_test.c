/* weights_test.c - the weights at places between points, against their definition. */
#include "core/delaunay_surface.h"
#include "core/exact/double2.h"
#include "tests/core/sets.h"
#include "tests/oracle/voronoi.h"
#include "tests/test.h"

#include <math.h>
#include <stdlib.h>

static const enum dt_interpolation all[] = {DT_LINEAR, DT_NATURAL, DT_LAPLACE};

struct weights {
    struct dt_weight *w;
    size_t n;
};

static enum dt_status try_weights(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                  const struct dt_options *opt, struct weights *r)
{
    struct dt_weigher *w;
    *r = (struct weights){NULL, 0};
    enum dt_status s = dt_weights_begin(t, q, how, opt, &w);
    if (s == DT_OK)
        s = dt_weights_end(w, opt, &r->w, &r->n);
    dt_weights_free(w);
    return s;
}

static struct weights weights_at(const struct dt *t, struct dt_point q, enum dt_interpolation how)
{
    struct weights r;
    CHECK(try_weights(t, q, how, NULL, &r) == DT_OK);
    return r;
}

static struct dt_point point_of(const struct dt *t, uint32_t id)
{
    struct dt_point p;
    CHECK(dt_get(t, id, &p) == DT_OK);
    return p;
}

/* They are at least 0, have the sum 1, and q is the mean of the points: within the stated error. */
static void check_mean(const struct dt *t, struct dt_point q, const struct weights *w)
{
    double sum = 0, far = 0;
    struct dt_double2 x = {0, 0}, y = {0, 0};
    for (size_t i = 0; i < w->n; i++) {
        struct dt_point p = point_of(t, w->w[i].id);
        struct dt_double2 weight = {w->w[i].weight, 0};
        CHECK(w->w[i].weight >= 0 && (i == 0 || w->w[i - 1].id < w->w[i].id));
        sum += w->w[i].weight;
        far = fmax(far, hypot(p.x - q.x, p.y - q.y));
        x = dt_double2_add(x, dt_double2_multiply(weight, dt_double2_difference(p.x, q.x)));
        y = dt_double2_add(y, dt_double2_multiply(weight, dt_double2_difference(p.y, q.y)));
    }
    CHECK_MSG(fabs(sum - 1) <= DT_WEIGHTS_ERROR, "sum %.17g", sum);
    CHECK_MSG(hypot(x.hi, y.hi) <= DT_WEIGHTS_ERROR * far, "off by %g of %g", hypot(x.hi, y.hi),
              far);
}

static void check_place(const struct dt *t, struct dt_point q)
{
    struct dt_location at;
    CHECK(dt_locate(t, q, &at) == DT_OK);
    for (int i = 0; i < 3; i++) {
        struct weights w = weights_at(t, q, all[i]);
        if (at.where == DT_OUTSIDE)
            CHECK(w.n == 0);
        else if (at.where == DT_ON_VERTEX)
            CHECK(w.n == 1 && w.w[0].id == at.id[0] && w.w[0].weight == 1);
        else
            check_mean(t, q, &w);
        free(w.w);
    }
}

static void check_means(const struct pair *pair)
{
    for (int i = 0; i < 30; i++)
        check_place(pair->t, random_place(pair->b));
}

TEST_TIMEOUT(weights_are_those_of_a_mean_on_every_family, 120)
{
    for_each_pair(check_means);
}

/* The representatives of a set. */
static uint32_t sites_of(const struct dt *t, struct dt_point *p, uint32_t *id)
{
    uint32_t n = 0, rep;
    for (uint32_t i = 0; i < dt_next_id(t); i++) {
        if (dt_representative(t, i, &rep) != DT_OK || rep != i)
            continue;
        p[n] = point_of(t, i);
        id[n++] = i;
    }
    return n;
}

/* Compares with the definition, for a place strictly inside the hull. */
static void check_definition(const struct dt *t, struct dt_point q, enum dt_interpolation how)
{
    uint32_t room = dt_next_id(t) + 1;
    struct dt_point *p = malloc(room * sizeof *p);
    uint32_t *id = malloc(room * sizeof *id);
    double *want = malloc(room * sizeof *want), error = 0;
    CHECK(p != NULL && id != NULL && want != NULL);
    uint32_t n = sites_of(t, p, id);
    voronoi_weights(p, n, q, how, want);
    struct weights w = weights_at(t, q, how);
    size_t at = 0;
    for (uint32_t i = 0; i < n; i++) {
        bool listed = at < w.n && w.w[at].id == id[i];
        CHECK_MSG(listed || want[i] == 0, "point %u with the weight %g", id[i], want[i]);
        error += fabs((listed ? w.w[at].weight : 0) - want[i]);
        at += listed;
    }
    CHECK(at == w.n);
    CHECK_MSG(error <= DT_WEIGHTS_ERROR, "errors of %g", error);
    free(w.w);
    free(want);
    free(id);
    free(p);
}

static void check_definitions(const struct pair *pair)
{
    struct dt_summary sum;
    dt_summary(pair->t, &sum);
    if (sum.points > 80)
        return;
    for (int i = 0; i < (test_is_sanitized() ? 1 : 4); i++) { /* the definition takes long */
        struct dt_point q = random_place(pair->b);
        struct dt_location at;
        CHECK(dt_locate(pair->t, q, &at) == DT_OK);
        if (at.where != DT_INSIDE)
            continue;
        check_definition(pair->t, q, DT_NATURAL);
        check_definition(pair->t, q, DT_LAPLACE);
    }
}

TEST_TIMEOUT(weights_of_natural_neighbours_equal_their_definition_on_every_family, 240)
{
    for_each_pair(check_definitions);
}

TEST(weights_beside_a_flat_hull_triangle_need_more_than_doubles)
{
    /* The lower side of the hull bends by 2^-40; its cell reaches far below it. */
    static const struct dt_point p[] = {{0, 0}, {1, -0x1p-40}, {2, 0}, {1, 1}};
    struct dt *t = set_of(p, 4);
    static const struct dt_point q[] = {
        {1, -0x1p-41}, {1, -0x1p-42}, {0.5, -0x1p-43}, {1.25, 0x1p-60}};
    for (int i = 0; i < 4; i++) {
        check_place(t, q[i]);
        check_definition(t, q[i], DT_NATURAL);
        check_definition(t, q[i], DT_LAPLACE);
    }
    dt_free(t);
}

TEST(weights_of_the_widest_exponents)
{
    static const struct dt_point p[] = {
        {-0x1p200, 0}, {0x1p200, 0x1p-140}, {0, 0x1p200}, {0x1p-142, -0x1p-100}, {1, 1}};
    struct dt *t = set_of(p, 5);
    static const struct dt_point q[] = {{0x1p-141, 0}, {1, 0.5}, {0x1p100, 0x1p90}, {0, 0x1p-142}};
    for (int i = 0; i < 4; i++) {
        check_place(t, q[i]);
        check_definition(t, q[i], DT_NATURAL);
        check_definition(t, q[i], DT_LAPLACE);
    }
    dt_free(t);
}

/* (8, 6) is on the circle around the square beside its own: the far corners of that one do not count. */
TEST(weights_do_not_list_points_of_a_circle_through_the_place)
{
    struct dt_point p[16];
    for (int i = 0; i < 16; i++)
        p[i] = (struct dt_point){10 * (i % 4), 10 * (i / 4)};
    struct dt *t = set_of(p, 16);
    for (int x = 0; x < 4; x++) {
        for (int y = 0; y < 4; y++) {
            static const struct dt_point corner[] = {{8, 6}, {6, 8}, {2, 4}, {4, 2}};
            struct dt_point q = {corner[x].x + 10, corner[y].y + 10};
            struct weights natural = weights_at(t, q, DT_NATURAL),
                           laplace = weights_at(t, q, DT_LAPLACE);
            CHECK(natural.n == laplace.n && natural.n >= 4);
            for (size_t i = 0; i < natural.n; i++)
                CHECK(natural.w[i].weight > 1e-3 && laplace.w[i].weight > 1e-3);
            check_definition(t, q, DT_NATURAL);
            free(natural.w);
            free(laplace.w);
        }
    }
    dt_free(t);
}

TEST(weights_in_the_middle_of_a_square_are_a_quarter)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    struct dt *t = set_of(p, 4);
    for (int how = 1; how < 3; how++) {
        struct weights w = weights_at(t, (struct dt_point){1, 1}, all[how]);
        CHECK(w.n == 4);
        for (uint32_t i = 0; i < 4; i++)
            CHECK(w.w[i].id == i && w.w[i].weight == 0.25);
        free(w.w);
    }
    dt_free(t);
}

TEST(weights_on_an_edge_of_the_hull_are_linear_along_it)
{
    static const struct dt_point p[] = {{0, 0}, {4, 0}, {2, 0.125}, {2, 5}};
    struct dt *t = set_of(p, 4);
    for (int i = 0; i < 3; i++) {
        struct weights w = weights_at(t, (struct dt_point){1, 0}, all[i]);
        CHECK(w.n == 2 && w.w[0].id == 0 && w.w[0].weight == 0.75 && w.w[1].weight == 0.25);
        free(w.w);
    }
    dt_free(t);
}

TEST(weights_of_points_on_a_line_and_of_one_point)
{
    static const struct dt_point p[] = {{0, 0}, {4, 4}, {2, 2}};
    struct dt *line = set_of(p, 3), *one = set_of(p, 1), *none = set_of(p, 0);
    for (int i = 0; i < 3; i++) {
        struct weights on = weights_at(line, (struct dt_point){3, 3}, all[i]);
        struct weights beside = weights_at(line, (struct dt_point){3, 2}, all[i]);
        struct weights at = weights_at(one, p[0], all[i]), off = weights_at(one, p[1], all[i]);
        CHECK(on.n == 2 && on.w[0].id == 1 && on.w[0].weight == 0.5 && on.w[1].id == 2);
        struct weights empty = weights_at(none, p[0], all[i]);
        CHECK(beside.n == 0 && off.n == 0 && empty.n == 0);
        CHECK(at.n == 1 && at.w[0].id == 0 && at.w[0].weight == 1);
        free(on.w);
        free(beside.w);
        free(at.w);
        free(off.w);
        free(empty.w);
    }
    dt_free(line);
    dt_free(one);
    dt_free(none);
}

/* A place among n points of a circle has them all for natural neighbours. */
TEST(weights_take_no_more_steps_than_they_may)
{
    enum { N = 5000 };
    struct dt_point *p = malloc(N * sizeof *p);
    CHECK(p != NULL);
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){cos(i * 2 * M_PI / N), sin(i * 2 * M_PI / N)};
    struct dt *t = set_of(p, N);
    struct weights w;
    struct dt_options few = {.steps = 1000};
    CHECK(try_weights(t, (struct dt_point){0.1, 0.2}, DT_NATURAL, &few, &w) == DT_TOOLONG);
    CHECK(w.w == NULL && w.n == 0);
    check_place(t, (struct dt_point){0.1, 0.2});
    dt_free(t);
    free(p);
}

TEST(weights_survive_without_memory)
{
    static const struct dt_point p[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    struct dt *t = set_of(p, 4);
    for (int how = 0; how < 3; how++) {
        enum dt_status s = DT_NOMEM;
        struct weights w;
        for (long n = 1; s == DT_NOMEM; n++) {
            test_fail_alloc(n);
            s = try_weights(t, (struct dt_point){0.5, 1}, all[how], NULL, &w);
            CHECK(test_alloc_failed() == (s == DT_NOMEM));
            CHECK(s == DT_OK || (w.w == NULL && w.n == 0));
        }
        test_fail_alloc(0);
        CHECK(s == DT_OK);
        free(w.w);
    }
    dt_free(t);
}

TEST(weights_are_the_same_after_other_histories)
{
    enum { N = 300 };
    struct dt_point p[N];
    for (int i = 0; i < N; i++)
        p[i] = (struct dt_point){test_below(30), test_below(30)};
    struct dt *at_once = set_of(p, N), *one_by_one = set_of_each(p, N);
    for (int i = 0; i < 1000; i++) {
        struct dt_point q = {0.5 * test_below(60), 0.25 * test_below(120)};
        enum dt_interpolation how = all[test_below(3)];
        struct weights a = weights_at(at_once, q, how), b = weights_at(one_by_one, q, how);
        CHECK(a.n == b.n);
        for (size_t k = 0; k < a.n; k++)
            CHECK(a.w[k].id == b.w[k].id && a.w[k].weight == b.w[k].weight);
        free(a.w);
        free(b.w);
    }
    dt_free(at_once);
    dt_free(one_by_one);
}
