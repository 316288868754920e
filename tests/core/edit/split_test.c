/* split_test.c - constraints that cross get points in common: the plan, in any order, and what is there when it has been
 * carried out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"
#include "tests/test.h"

static uint32_t below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

static struct dt *set_of(const struct dt_point *p, size_t n, double tol)
{
    struct dt *t = dt_new(tol);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static void declare(struct dt *t, struct dt_constraint c)
{
    size_t added;
    uint32_t missing;
    CHECK(dt_constrain(t, &c, 1, NULL, &added, &missing) == DT_OK && added == 1);
}

static enum dt_status plan(struct dt *t, const struct dt_constraint *c, size_t n,
                           struct dt_split *out)
{
    uint32_t missing;
    return dt_plan_split(t, c, n, SIZE_MAX, NULL, out, &missing);
}

static void carry_out(struct dt *t, const struct dt_split *s)
{
    struct dt_added added;
    size_t released, declared, at;
    uint32_t missing, first = dt_next_id(t);
    const char *fault = NULL;
    if (s->n_points > 0)
        CHECK(dt_add(t, s->point, s->n_points, &added) == DT_OK && added.first == first &&
              added.coincident == 0);
    CHECK(dt_release(t, s->released, s->n_released, NULL, &released, &at) == DT_OK &&
          released == s->n_released);
    CHECK(dt_constrain(t, s->added, s->n_added, NULL, &declared, &missing) == DT_OK &&
          declared == s->n_added);
    enum dt_status status = dt_check(t, NULL, &fault);
    if (status != DT_OK && status != DT_UNTRIANGULATED)
        CHECK_MSG(false, "%s", fault);
}

static bool are_same(const struct dt_constraint *a, const struct dt_constraint *b, size_t n)
{
    bool same = true;
    for (size_t i = 0; i < n && same; i++)
        same = a[i].a == b[i].a && a[i].b == b[i].b && a[i].border == b[i].border &&
               a[i].number == b[i].number;
    return same;
}

static bool are_equal(const struct dt_split *a, const struct dt_split *b)
{
    return a->n_points == b->n_points && a->n_added == b->n_added &&
           a->n_released == b->n_released && a->split == b->split && a->deviation == b->deviation &&
           memcmp(a->point, b->point, a->n_points * sizeof *a->point) == 0 &&
           are_same(a->added, b->added, a->n_added) &&
           are_same(a->released, b->released, a->n_released);
}

static bool is(const struct dt_constraint *c, uint32_t a, uint32_t b, bool border, uint32_t number)
{
    return c->a == a && c->b == b && c->border == border && c->number == number;
}

TEST(two_that_cross_are_replaced_by_their_parts)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {10, 10}, {0, 10}, {10, 0}}, 4, 0);
    struct dt_constraint c = {3, 2, true, 7};
    struct dt_split s;
    declare(t, (struct dt_constraint){0, 1, false, 5});
    CHECK(plan(t, &c, 1, &s) == DT_OK && dt_constraints_count(t) == 1 && dt_next_id(t) == 4);
    CHECK(s.n_points == 1 && s.point[0].x == 5 && s.point[0].y == 5 && s.deviation == 0);
    CHECK(s.split == 2 && s.n_released == 1 && is(&s.released[0], 0, 1, false, 5));
    CHECK(s.n_added == 4 && is(&s.added[0], 0, 4, false, 5) && is(&s.added[1], 1, 4, false, 5) &&
          is(&s.added[2], 2, 4, true, 7) && is(&s.added[3], 3, 4, true, 7));
    carry_out(t, &s);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(what_does_not_cross_is_declared_as_it_is_and_what_is_there_is_not_declared_again)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {4, 4}, {0, 4}, {4, 0}, {2, 2}}, 5, 0);
    struct dt_constraint c[] = {
        {1, 0, false, 0}, {2, 3, false, 0}, {3, 2, false, 0}, {0, 3, true, 1}};
    struct dt_split s;
    declare(t, c[0]);
    CHECK(plan(t, c, 4, &s) == DT_OK && s.n_points == 0 && s.n_released == 0 && s.split == 0);
    CHECK(s.n_added == 2 && is(&s.added[0], 0, 3, true, 1) && is(&s.added[1], 2, 3, false, 0));
    carry_out(t, &s);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(three_through_one_place_share_one_point)
{
    struct dt *t =
        set_of((struct dt_point[]){{0, 0}, {6, 6}, {0, 6}, {6, 0}, {0, 3}, {6, 3}}, 6, 0);
    struct dt_constraint c[] = {{0, 1, false, 0}, {2, 3, false, 0}, {4, 5, false, 0}};
    struct dt_split s;
    CHECK(plan(t, c, 3, &s) == DT_OK && s.n_points == 1 && s.n_added == 6 && s.split == 3);
    carry_out(t, &s);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(parts_keep_the_ids_of_aliases_and_a_point_near_a_crossing_is_used)
{
    struct dt *t =
        set_of((struct dt_point[]){{0, 0}, {9, 9}, {0, 9}, {9, 0}, {0, 0}, {4.5, 4.25}}, 6, 0.5);
    struct dt_constraint c[] = {{4, 1, false, 0}, {2, 3, false, 0}};
    struct dt_split s;
    CHECK(plan(t, c, 2, &s) == DT_OK && s.n_points == 0 && s.n_added == 4);
    CHECK(is(&s.added[0], 1, 5, false, 0) && is(&s.added[1], 2, 5, false, 0) &&
          is(&s.added[2], 3, 5, false, 0) && is(&s.added[3], 4, 5, false, 0));
    CHECK(fabs(s.deviation - 0.25 / sqrt(2)) < 1e-15);
    carry_out(t, &s);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(bad_requests_to_split_have_no_plan)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_split s;
    struct dt_constraint c = {0, 1, false, 0}, same = {1, 1, false, 0}, none = {0, 9, false, 0};
    CHECK(dt_add(t, (struct dt_point[]){{0, 0}, {1, 1}, {2, 0}}, 3, &added) == DT_OK);
    CHECK(plan(t, &same, 1, &s) == DT_NOEDGE && plan(t, &none, 1, &s) == DT_NOPOINT);
    CHECK(s.point == NULL);
    CHECK(plan(t, &c, 0, &s) == DT_OK && s.n_added == 0);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(a_crossing_is_rounded_once_to_the_nearest_place)
{
    for (int round = 0; round < 300; round++) {
        struct dt_point p[4];
        for (int i = 0; i < 4; i++)
            p[i] = (struct dt_point){below(1000), below(1000)};
        double dx = p[1].x - p[0].x, dy = p[1].y - p[0].y, ex = p[3].x - p[2].x,
               ey = p[3].y - p[2].y, fx = p[2].x - p[0].x, fy = p[2].y - p[0].y;
        double den = dx * ey - dy * ex, num = fx * ey - fy * ex, other = fx * dy - fy * dx;
        struct dt *t = set_of(p, 4, 0);
        struct dt_split s;
        struct dt_constraint c[] = {{0, 1, false, 0}, {2, 3, false, 0}};
        bool crosses = den != 0 && num / den > 0 && num / den < 1 && other / den > 0 &&
                       other / den < 1; /* of integers: no rounding decides */
        CHECK(plan(t, c, 2, &s) == DT_OK && s.n_points == crosses);
        if (crosses) /* integers below 2^53, so a quotient is rounded once */
            CHECK(s.point[0].x == (p[0].x * den + dx * num) / den &&
                  s.point[0].y == (p[0].y * den + dy * num) / den);
        dt_split_clear(&s);
        dt_free(t);
    }
}

TEST(constraints_split_alike_before_and_after_triangulation)
{
    static const struct dt_point p[] = {{0, 0}, {9, 7}, {0, 9}, {9, 0}, {4, 0}, {5, 9}, {2, 2}};
    struct dt_constraint c[] = {{0, 1, false, 0}, {2, 3, true, 1}, {4, 5, false, 2}};
    struct dt *live = set_of(p, 7, 0.1), *other = dt_new(0.1);
    struct dt_added added;
    struct dt_split s, o;
    CHECK(dt_add(other, p, 7, &added) == DT_OK);
    CHECK(plan(live, c, 3, &s) == DT_OK && plan(other, c, 3, &o) == DT_OK && are_equal(&s, &o));
    carry_out(other, &o);
    CHECK(dt_triangulate(other, NULL) == DT_OK);
    dt_split_clear(&s);
    dt_split_clear(&o);
    dt_free(live);
    dt_free(other);
}

TEST(recorded_constraints_that_cross_each_other_are_split_too)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_split s;
    CHECK(dt_add(t, (struct dt_point[]){{0, 0}, {2, 2}, {0, 2}, {2, 0}}, 4, &added) == DT_OK);
    declare(t, (struct dt_constraint){0, 1, false, 0});
    declare(t, (struct dt_constraint){2, 3, false, 0});
    CHECK(dt_triangulate(t, NULL) == DT_CROSSES);
    CHECK(plan(t, NULL, 0, &s) == DT_OK && s.n_points == 1 && s.n_released == 2 && s.split == 2);
    carry_out(t, &s);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(new_points_have_the_mean_of_what_the_constraints_through_them_say)
{
    struct dt *t =
        set_of((struct dt_point[]){{0, 0}, {8, 8}, {0, 8}, {8, 0}, {0, 1}, {8, 2}}, 6, 0);
    struct dt_constraint c[] = {{0, 1, false, 0}, {2, 3, false, 0}, {4, 5, false, 0}};
    const double z[] = {0, 8, 16, 32}, nan[] = {(double)NAN};
    uint32_t missing;
    struct dt_split s;
    CHECK(dt_field_set_run(t, "z", 1, 0, z, 4, NULL, &missing) == DT_OK);
    CHECK(dt_field_set_run(t, "none", 4, 0, nan, 1, NULL, &missing) == DT_OK);
    CHECK(plan(t, c, 3, &s) == DT_OK && s.n_points == 3 && s.columns == 1);
    CHECK(s.column[0].len == 1 && s.column[0].name[0] == 'z');
    CHECK(s.point[1].x == 4 && s.column[0].values[1] == (4 + 24) / 2.0);
    CHECK(fabs(s.column[0].values[0] - s.point[0].x) < 1e-14);            /* on the first alone, */
    CHECK(fabs(s.column[0].values[2] - (16 + 2 * s.point[2].x)) < 1e-14); /* and on the second */
    dt_split_clear(&s);
    dt_free(t);
}

TEST(a_level_plane_stays_level_where_constraints_cross)
{
    struct dt_point p[40];
    struct dt_constraint c[20];
    double z[40];
    uint32_t missing;
    for (uint32_t i = 0; i < 40; i++) {
        p[i] = (struct dt_point){below(100), below(100)};
        z[i] = 0.1;
        c[i / 2] = (struct dt_constraint){i - i % 2, i - i % 2 + 1, false, 0};
    }
    struct dt *t = set_of(p, 40, 0);
    struct dt_split s;
    CHECK(dt_field_set_run(t, "z", 1, 0, z, 40, NULL, &missing) == DT_OK);
    CHECK(plan(t, c, 20, &s) == DT_OK && (s.n_points == 0 || s.columns == 1));
    for (size_t i = 0; i < s.n_points; i++)
        CHECK(s.column[0].values[i] == 0.1);
    dt_split_clear(&s);
    dt_free(t);
}

TEST(plan_with_more_crossings_than_allowed_fails)
{
    enum { N = 20 };
    struct dt_point p[4 * N];
    struct dt_constraint c[2 * N];
    uint32_t missing;
    for (uint32_t i = 0; i < N; i++) {
        p[4 * i] = (struct dt_point){i + 1, 0};
        p[4 * i + 1] = (struct dt_point){i + 1, N + 1};
        p[4 * i + 2] = (struct dt_point){0, i + 1};
        p[4 * i + 3] = (struct dt_point){N + 1, i + 1};
        c[2 * i] = (struct dt_constraint){4 * i, 4 * i + 1, false, 0};
        c[2 * i + 1] = (struct dt_constraint){4 * i + 2, 4 * i + 3, false, 0};
    }
    struct dt *t = set_of(p, 4 * N, 0);
    struct dt_split s;
    CHECK(dt_plan_split(t, c, 2 * N, N * N - 1, NULL, &s, &missing) == DT_NOMEM);
    CHECK(s.point == NULL && dt_plan_split(t, c, 2 * N, 4 * N * N, NULL, &s, &missing) == DT_OK);
    dt_split_clear(&s);
    dt_free(t);
}

/* ---- points that are taken back ---- */

/* Whether both sets have the same points, constraints and edges. */
static bool are_same_sets(const struct dt *a, const struct dt *b)
{
    struct dt_summary one, other;
    struct dt_ids edges = {0}, more = {0};
    dt_summary(a, &one);
    dt_summary(b, &other);
    bool same = dt_next_id(a) == dt_next_id(b) && one.points == other.points &&
                one.coincident == other.coincident && one.triangles == other.triangles &&
                one.edges == other.edges && one.hull == other.hull;
    CHECK(dt_constrained_edges(a, &edges) == DT_OK && dt_constrained_edges(b, &more) == DT_OK);
    same = same && edges.n == more.n &&
           (edges.n == 0 || memcmp(edges.v, more.v, edges.n * sizeof *edges.v) == 0);
    free(edges.v);
    free(more.v);
    return same;
}

TEST(points_that_are_taken_back_leave_nothing)
{
    for (int round = 0; round < 60; round++) {
        struct dt_point p[90];
        double z[90];
        const uint32_t old = 4 + below(30), n = below(50);
        const double tol = round % 2 == 0 ? 0 : 1.5;
        for (uint32_t i = 0; i < 90; i++) {
            p[i] = (struct dt_point){below(20), below(20)};
            z[i] = i;
        }
        struct dt *t = set_of(p, old, tol), *same = set_of(p, old, tol);
        struct dt_values_of column = {"z", 1, z};
        struct dt_added added;
        struct dt_constraint c = {0, 1, false, 0};
        const char *fault;
        declare(t, c);
        declare(same, c);
        for (int again = 0; again < 2; again++) {
            CHECK(dt_add_values(t, p + old, n, &column, 1, NULL, &added) == DT_OK);
            if (again == 1) /* many points may have put the triangulation off */
                CHECK(dt_refresh(t, NULL) == DT_OK);
            dt_take_back(t, n);
            CHECK(dt_refresh(t, NULL) == DT_OK && dt_check(t, NULL, &fault) == DT_OK);
            CHECK(are_same_sets(t, same));
        }
        struct dt_field_summary sum;
        dt_field_summary(dt_field_find(t, "z", 1), &sum);
        CHECK(sum.values == 0);
        CHECK(dt_add(t, p + old, n, &added) == DT_OK && dt_add(same, p + old, n, &added) == DT_OK);
        CHECK(dt_refresh(t, NULL) == DT_OK && dt_refresh(same, NULL) == DT_OK);
        CHECK(are_same_sets(t, same));
        dt_free(t);
        dt_free(same);
    }
}

/* ---- many ---- */

/* Shuffles constraints, and the ends of each. */
static void shuffle(struct dt_constraint *c, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        size_t k = i + below((uint32_t)(n - i));
        struct dt_constraint swap = c[i];
        c[i] = c[k];
        c[k] = swap;
        if (below(2) == 0)
            c[i] = (struct dt_constraint){c[i].b, c[i].a, c[i].border, c[i].number};
    }
}

/* Plans c[n] in two orders, and carries it out. */
static void split_all(struct dt *t, struct dt_constraint *c, size_t n, struct dt_split *s)
{
    struct dt_split other;
    CHECK(plan(t, c, n, s) == DT_OK);
    shuffle(c, n);
    CHECK(plan(t, c, n, &other) == DT_OK && are_equal(s, &other));
    dt_split_clear(&other);
    carry_out(t, s);
    CHECK(plan(t, NULL, 0, &other) == DT_OK && other.n_points == 0 && other.n_added == 0);
    dt_split_clear(&other);
}

/* On a lattice of doubles `far` away from 0, where only integers are: every crossing is rounded to one. */
static void split_random(uint32_t side, uint32_t points, size_t n, double far)
{
    struct dt_point *p = malloc(points * sizeof *p);
    struct dt_constraint c[64];
    size_t k = 0;
    for (uint32_t i = 0; i < points; i++)
        p[i] = (struct dt_point){far + below(side), far + below(side)};
    struct dt *t = set_of(p, points, 0);
    struct dt_split s;
    for (int batch = 0; batch < 2; batch++) { /* the second one crosses declared parts */
        for (k = 0; k < n;) {
            c[k] = (struct dt_constraint){below(points), below(points), below(2) == 0, below(3)};
            k += c[k].a != c[k].b;
        }
        split_all(t, c, k, &s);
        dt_split_clear(&s);
    }
    dt_free(t);
    free(p);
}

TEST(random_constraints_split_alike_in_any_order)
{
    for (int round = 0; round < 60; round++)
        split_random(4 + below(20), 4 + below(40), 2 + below(40), 0);
}

TEST(constraints_split_alike_where_places_are_as_coarse_as_the_lattice)
{
    for (int round = 0; round < 60; round++)
        split_random(4 + below(20), 4 + below(30), 2 + below(20), 0x1p52);
}

TEST(a_grid_of_lines_gets_a_point_at_every_crossing)
{
    enum { N = 60 };
    struct dt_point p[4 * N];
    struct dt_constraint c[2 * N];
    for (uint32_t i = 0; i < N; i++) {
        p[4 * i] = (struct dt_point){i + 1, 0};
        p[4 * i + 1] = (struct dt_point){i + 1, N + 1};
        p[4 * i + 2] = (struct dt_point){0, i + 1};
        p[4 * i + 3] = (struct dt_point){N + 1, i + 1};
        c[2 * i] = (struct dt_constraint){4 * i, 4 * i + 1, false, i};
        c[2 * i + 1] = (struct dt_constraint){4 * i + 2, 4 * i + 3, false, i};
    }
    struct dt *t = set_of(p, 4 * N, 0);
    struct dt_split s;
    split_all(t, c, 2 * N, &s);
    CHECK(s.n_points == N * N && s.n_added == 2 * N * (N + 1) && s.deviation == 0);
    dt_split_clear(&s);
    dt_free(t);
}

/* Segments in a tiny part of the box around all of them: the work must not be that of all pairs. */
TEST(crossings_of_a_cluster_far_from_others_are_found_without_looking_at_all_pairs)
{
    enum { N = 20000, MOST = 10000000 };
    struct dt_point *p = malloc((2 * N + 2) * sizeof *p);
    struct dt_constraint *c = malloc((N + 1) * sizeof *c);
    const struct dt_options few = {.steps = MOST};
    uint32_t missing;
    struct dt_split s;
    CHECK(p != NULL && c != NULL);
    for (uint32_t i = 0; i < N; i++) {
        double x = (i % 100) * 1e-6, y = (double)(i / 100) * 1e-6, step = i == 5050 ? 2e-6 : 0.5e-6;
        p[2 * i] = (struct dt_point){x, y};
        p[2 * i + 1] = (struct dt_point){x + 0.2e-6, y + step};
        c[i] = (struct dt_constraint){2 * i, 2 * i + 1, i % 2 == 0, i};
    }
    p[2 * N] = (struct dt_point){1e6, 1e6};
    p[2 * N + 1] = (struct dt_point){1e6, 2e6};
    c[N] = (struct dt_constraint){2 * N, 2 * N + 1, false, 0};
    struct dt *t = set_of(p, 2 * N + 2, 0);
    CHECK(dt_plan_split(t, c, N + 1, SIZE_MAX, &few, &s, &missing) == DT_OK && s.n_points == 1 &&
          s.n_added == N + 3);
    dt_split_clear(&s);
    dt_free(t);
    free(p);
    free(c);
}

TEST(nearly_parallel_lines_and_lines_through_nearly_one_place_are_split)
{
    enum { N = 40 };
    for (int kind = 0; kind < 2; kind++) {
        struct dt_point p[2 * N];
        struct dt_constraint c[N];
        for (uint32_t i = 0; i < N; i++) {
            double a = i * (kind == 0 ? 1e-9 : 0.07), r = kind == 0 ? 1 : 5;
            p[2 * i] = (struct dt_point){-r * cos(a), -r * sin(a) + i * 1e-12};
            p[2 * i + 1] = (struct dt_point){r * cos(a), r * sin(a) - i * 1e-12};
            c[i] = (struct dt_constraint){2 * i, 2 * i + 1, false, i};
        }
        struct dt *t = set_of(p, 2 * N, 0);
        struct dt_split s;
        split_all(t, c, N, &s);
        CHECK(s.n_points > 0 && s.deviation < 1e-14);
        dt_split_clear(&s);
        dt_free(t);
    }
}

TEST(split_regions_that_were_closed_stay_closed)
{
    for (int round = 0; round < 40; round++) {
        struct dt_point p[24];
        struct dt_constraint c[24];
        for (uint32_t i = 0; i < 24; i++)
            p[i] = (struct dt_point){0x1p50 + below(60), 0x1p50 + below(60)};
        struct dt *t = set_of(p, 24, 0);
        size_t n = 0;
        for (uint32_t i = 0; i < 24; i++) { /* four rings of six */
            struct dt_constraint side = {i, i % 6 == 5 ? i - 5 : i + 1, true, i / 6};
            c[n++] = side;
        }
        struct dt_split s;
        struct dt_region *row, all;
        split_all(t, c, n, &s);
        CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &n, &all) == DT_OK);
        for (size_t i = 0; i < n; i++)
            CHECK(row[i].closed);
        free(row);
        dt_split_clear(&s);
        dt_free(t);
    }
}
