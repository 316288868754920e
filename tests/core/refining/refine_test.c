/* refine_test.c - refinement: what is left is counted, the same set gives the same plan, and the set is sound when it has been carried
 * out. Every family is refined; sharp corners, overlapping constraints and extreme coordinates have tests of their own. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"
#include "core/delaunay_surface.h"
#include "core/refining/angles.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

static struct dt *set_of(const struct dt_point *p, size_t n, double tol)
{
    struct dt *t = dt_new(tol);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static void declare(struct dt *t, const struct dt_constraint *c, size_t n)
{
    size_t added;
    uint32_t missing;
    CHECK(dt_constrain(t, c, n, NULL, &added, &missing) == DT_OK);
}

static void ring(struct dt *t, uint32_t first, uint32_t n, uint32_t number)
{
    for (uint32_t i = 0; i < n; i++)
        declare(t, &(struct dt_constraint){first + i, first + (i + 1) % n, true, number}, 1);
}

static struct dt_quality limits(double angle)
{
    return (struct dt_quality){.angle = angle, .number = DT_NONE, .most = 100000};
}

/* Triangles inside that are not as wanted, and the least angle. */
static size_t recount(const struct dt *t, const struct dt_quality *q, double *angle)
{
    struct dt_ids v = {0};
    struct dt_wanted w;
    struct dt_angles angles = {0};
    size_t broken = 0;
    dt_wanted_of(q, &w);
    CHECK(dt_inside(t, q->number, DT_TRIANGLES, false, NULL, &v) == DT_OK);
    for (size_t i = 0; i < v.n; i += 3) {
        struct dt_point p[3];
        struct dt_shape s;
        for (size_t k = 0; k < 3; k++)
            CHECK(dt_get(t, v.v[i + k], &p[k]) == DT_OK);
        dt_shape_of(p[0], p[1], p[2], &s);
        broken += dt_shape_breaks(&w, &s) != 0;
        dt_angles_add(&angles, &s);
    }
    *angle = v.n == 0 ? (double)NAN : dt_degrees(angles.least);
    free(v.v);
    return broken;
}

/* Carries the plan out; the set is sound then, and the plan's counts are right. */
static void carry_out(struct dt *t, const struct dt_quality *q, const struct dt_refined *r)
{
    const struct dt_split *s = &r->change;
    struct dt_added added;
    size_t n, at;
    uint32_t missing, first = dt_next_id(t);
    const char *fault = NULL;
    double angle;
    CHECK(dt_add_values(t, s->point, s->n_points, s->column, s->columns, NULL, &added) == DT_OK);
    CHECK(added.first == first && added.added == s->n_points && added.coincident == 0);
    CHECK(dt_release(t, s->released, s->n_released, NULL, &n, &at) == DT_OK && n == s->n_released);
    CHECK(dt_constrain(t, s->added, s->n_added, NULL, &n, &missing) == DT_OK && n == s->n_added);
    CHECK(dt_refresh(t, NULL) == DT_OK);
    if (dt_check(t, NULL, &fault) != DT_OK)
        CHECK_MSG(false, "%s", fault);
    CHECK(dt_survey(t, NULL) == DT_OK);
    if (!dt_has_borders(t))
        return;
    size_t left = recount(t, q, &angle);
    CHECK_MSG(left == r->unrefined, "%zu are left, not %zu", left, r->unrefined);
    CHECK(angle == r->angle || (isnan(angle) && isnan(r->angle)));
}

static void refine(struct dt *t, const struct dt_quality *q, struct dt_refined *r)
{
    uint32_t next = dt_next_id(t), constraints = dt_constraints_count(t);
    CHECK(dt_plan_refine(t, q, NULL, r) == DT_OK);
    CHECK(dt_next_id(t) == next && dt_constraints_count(t) == constraints);
    carry_out(t, q, r);
}

/* The same, of which nothing else is needed. */
static size_t refined(struct dt *t, const struct dt_quality *q)
{
    struct dt_refined r;
    refine(t, q, &r);
    dt_split_clear(&r.change);
    return r.unrefined;
}

static bool are_equal(const struct dt_refined *a, const struct dt_refined *b)
{
    const struct dt_split *p = &a->change, *q = &b->change;
    bool same = p->n_points == q->n_points && p->n_added == q->n_added &&
                p->n_released == q->n_released && p->split == q->split && a->hull == b->hull &&
                a->unrefined == b->unrefined && memcmp(&a->angle, &b->angle, sizeof a->angle) == 0;
    for (size_t i = 0; same && i < p->n_points; i++)
        same = p->point[i].x == q->point[i].x && p->point[i].y == q->point[i].y;
    for (size_t i = 0; same && i < p->n_added; i++)
        same = dt_constraint_compare(&p->added[i], &q->added[i]) == 0;
    for (size_t i = 0; same && i < p->n_released; i++)
        same = dt_constraint_compare(&p->released[i], &q->released[i]) == 0;
    return same;
}

TEST(a_thin_rectangle_without_borders_gets_its_hull_and_points_on_it)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {8, 0}, {8, 1}, {0, 1}}, 4, 0);
    struct dt_quality q = limits(25);
    struct dt_refined r;
    refine(t, &q, &r);
    CHECK(r.hull == 4 && r.unrefined == 0 && r.angle >= 25 && r.change.n_points > 0);
    CHECK(r.change.n_released == 0 && dt_constraints_count(t) == 4 + r.change.n_points);
    dt_split_clear(&r.change);
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_OK); /* nothing is left to be done */
    CHECK(r.hull == 0 && r.change.n_points == 0 && r.change.n_added == 0 && r.change.split == 0);
    dt_split_clear(&r.change);
    dt_free(t);
}

TEST(a_sharp_corner_is_left_and_counted)
{
    for (int i = 1; i <= 4; i++) {
        struct dt_point p[] = {{0, 0}, {100, 0}, {100, 100 * ldexp(0.1, -i)}, {50, -20}};
        struct dt *t = set_of(p, 4, 0);
        struct dt_quality q = limits(30);
        ring(t, 0, 3, 7);
        size_t left = refined(t, &q);
        CHECK_MSG(left > 0 && left < 10 && dt_next_id(t) < 500, "%zu, %u", left, dt_next_id(t));
        dt_free(t);
    }
}

TEST(a_fan_of_lines_with_small_angles_ends)
{
    struct dt_point p[41] = {{0, 0}};
    for (int i = 0; i < 40; i++)
        p[i + 1] = (struct dt_point){cos(i * 0.04) * (1 + 0.1 * (i % 3)),
                                     sin(i * 0.04) * (1 + 0.1 * (i % 3))};
    struct dt *t = set_of(p, 41, 0);
    struct dt_quality q = limits(30);
    for (uint32_t i = 1; i <= 40; i++)
        declare(t, &(struct dt_constraint){0, i, false, i}, 1);
    size_t left = refined(t, &q);
    CHECK_MSG(left >= 39 && left < 400 && dt_next_id(t) < 20000, "%zu, %u", left, dt_next_id(t));
    dt_free(t);
}

TEST(area_and_length_are_limits_on_their_own_and_equality_is_enough)
{
    struct dt_point p[25];
    for (int i = 0; i < 25; i++)
        p[i] = (struct dt_point){i % 5, i / 5};
    struct dt_quality q = limits(45);
    q.area = 0.5;
    q.length = sqrt(2) * (1 + 0x1p-52);
    struct dt *t = set_of(p, 25, 0);
    CHECK(refined(t, &q) == 0 && dt_next_id(t) == 25);
    q = limits(0);
    q.area = 0.5 * (1 - 0x1p-52);
    CHECK(refined(t, &q) == 0 && dt_next_id(t) > 25);
    uint32_t before = dt_next_id(t);
    q = limits(0);
    q.length = 0.25;
    CHECK(refined(t, &q) == 0 && dt_next_id(t) > before);
    dt_free(t);
}

/* A regular polygon whose sides are divided many times, at places that rounding moves to either side of them. */
static size_t refine_polygon(uint32_t corners, double angle, double length)
{
    struct dt_point p[256];
    const double turn = 6.283185307179586 / corners;
    for (uint32_t i = 0; i < corners; i++)
        p[i] = (struct dt_point){cos(turn * i), sin(turn * i)};
    struct dt *t = set_of(p, corners, 0);
    ring(t, 0, corners, 0);
    struct dt_quality q = limits(angle);
    struct dt_refined plan;
    q.length = length;
    CHECK(dt_plan_refine(t, &q, NULL, &plan) == DT_OK);
    CHECK_MSG(plan.unrefined == 0, "%u corners, length %g: %zu triangles are not refined", corners,
              length, plan.unrefined);
    size_t n = plan.change.n_points;
    dt_split_clear(&plan.change);
    dt_free(t);
    return n;
}

TEST(straight_sides_are_divided_however_rounding_moves_their_points)
{
    for (uint32_t corners = 4; corners <= 60; corners++)
        for (double length = 0.4; length > 0.05; length /= 1.9)
            CHECK(refine_polygon(corners, 25, length) > 0);
}

/* An equilateral triangle of that side has an area of 0.433, half of that of a point. */
TEST(edges_of_a_limited_length_take_few_more_points_than_equilateral_triangles)
{
    const double length = 0.03, area = 3.14159, of_point = 0.866 * length * length;
    CHECK((double)refine_polygon(200, 25, length) < 1.63 * area / of_point);
    CHECK((double)refine_polygon(200, 0, length) < 1.63 * area / of_point);
}

TEST(only_one_region_is_refined_and_what_is_outside_stays)
{
    struct dt_point p[] = {{0, 0}, {4, 0}, {4, 1}, {0, 1}, {10, 0}, {14, 0}, {14, 1}, {10, 1}};
    struct dt *t = set_of(p, 8, 0);
    struct dt_quality q = limits(30);
    struct dt_refined r;
    ring(t, 0, 4, 1);
    ring(t, 4, 4, 2);
    q.number = 2;
    refine(t, &q, &r);
    CHECK(r.unrefined == 0 && r.change.n_points > 0 && r.hull == 0);
    for (size_t i = 0; i < r.change.n_points; i++)
        CHECK(r.change.point[i].x >= 10);
    dt_split_clear(&r.change);
    dt_free(t);
}

TEST(what_cannot_be_refined_is_an_error)
{
    struct dt *t = set_of((struct dt_point[]){{0, 0}, {4, 0}, {4, 1}, {0, 1}}, 4, 0);
    struct dt *bare = dt_new(0);
    struct dt_quality q = limits(30);
    struct dt_refined r;
    CHECK(dt_plan_refine(bare, &q, NULL, &r) == DT_UNTRIANGULATED);
    q.number = 1;
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_NOREGION);
    declare(t, &(struct dt_constraint){0, 1, true, 1}, 1);
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_OPEN);
    q.number = 2;
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_NOREGION);
    q.number = DT_NONE;
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_OPEN);
    const double bad[] = {-1, 60, (double)NAN, HUGE_VAL};
    for (int i = 0; i < 4; i++) {
        q = limits(bad[i]);
        CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_RANGE && r.change.point == NULL);
    }
    dt_free(bare);
    dt_free(t);
}

TEST(sets_without_triangles_are_as_wanted)
{
    struct dt_point p[] = {{0, 0}, {1, 1}, {3, 3}, {7, 7}};
    struct dt_quality q = limits(30);
    for (uint32_t n = 0; n <= 4; n++) {
        struct dt *t = set_of(p, n, 0);
        struct dt_refined r;
        refine(t, &q, &r);
        CHECK(r.change.n_points == 0 && r.hull == 0 && r.unrefined == 0 && isnan(r.angle));
        dt_split_clear(&r.change);
        dt_free(t);
    }
}

TEST(with_keep_constraints_stay_whole)
{
    struct dt_point p[] = {{0, 0}, {8, 0}, {8, 1}, {0, 1}, {3, 0.5}, {5, 0.5}};
    struct dt *t = set_of(p, 6, 0);
    struct dt_quality q = limits(20);
    struct dt_refined r;
    ring(t, 0, 4, 3);
    q.keep = true;
    q.length = 0.5;
    refine(t, &q, &r);
    CHECK(r.change.split == 0 && r.change.n_added == 0 && r.change.n_released == 0);
    CHECK(dt_constraints_count(t) == 4 && r.unrefined > 0 && r.change.n_points < 2000);
    dt_split_clear(&r.change);
    dt_free(t);
}

/* A constraint through vertices, one of a part of it, both kinds, aliases as ends. */
TEST(every_constraint_over_a_divided_edge_is_replaced_by_its_parts)
{
    struct dt_point p[] = {{0, 0}, {8, 0}, {8, 1}, {0, 1}, {4, 0}, {0, 0}, {8, 0}};
    struct dt *t = set_of(p, 7, 0);
    struct dt_constraint c[] = {
        {5, 6, false, 9}, {0, 4, false, 9}, {4, 1, true, 1}, {0, 4, true, 1}, {1, 2, true, 1},
        {2, 3, true, 1},  {3, 0, true, 1},  {5, 1, true, 2}, {0, 4, true, 2}, {4, 6, true, 2}};
    struct dt_quality q = limits(30);
    struct dt_refined r;
    declare(t, c, 10);
    refine(t, &q, &r);
    CHECK(r.unrefined == 0 && r.change.split == 8 && r.change.n_released == 8);
    struct dt_region *rows, inside;
    size_t n;
    CHECK(dt_regions(t, &rows, &n, &inside) == DT_OK && inside.area == 8);
    CHECK(n >= 1 && rows[0].number == 1 && rows[0].closed && rows[0].area == 8);
    free(rows);
    dt_split_clear(&r.change);
    dt_free(t);
}

/* Two borders of number 7 lie on one another where the first one is not divided: there they are none. */
TEST(a_part_that_would_be_a_border_twice_becomes_a_line)
{
    struct dt_point p[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {1, 0}};
    struct dt *t = set_of(p, 5, 0);
    struct dt_constraint c[] = {{0, 1, true, 7}, {0, 4, true, 7}}, row[20];
    struct dt_quality q = {.length = 8, .number = DT_NONE, .most = 100};
    struct dt_refined r;
    size_t sevens = 0, lines = 0;
    ring(t, 0, 4, 8);
    declare(t, c, 2);
    refine(t, &q, &r);
    CHECK(r.change.split == 5 && r.change.n_added < 20);
    for (size_t i = 0; i < r.change.n_added; i++) {
        row[sevens] = r.change.added[i];
        lines += !row[sevens].border;
        sevens += row[sevens].number == 7;
    }
    CHECK(sevens == 3 && lines == 1);
    CHECK(row[0].a == 0 && row[0].b == 4 && !row[0].border);
    CHECK(row[1].border && row[2].border && row[1].b == row[2].b && row[1].a + row[2].a == 5);
    CHECK(dt_constraints_count(t) == 12);
    dt_split_clear(&r.change);
    dt_free(t);
}

TEST(with_a_tolerance_points_keep_their_distance)
{
    struct dt_point p[] = {{0, 0}, {8, 0}, {8, 1}, {0, 1}, {4, 0.4}};
    struct dt *t = set_of(p, 5, 0.3);
    struct dt_quality q = limits(33);
    struct dt_refined r;
    refine(t, &q, &r);
    CHECK(r.change.n_points > 0 && r.change.n_points < 500);
    dt_split_clear(&r.change);
    dt_free(t);
}

TEST(the_limit_of_points_is_kept_and_the_rest_is_counted)
{
    struct dt_point p[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (size_t most = 0; most < 40; most++) {
        struct dt *t = set_of(p, 4, 0);
        struct dt_quality q = limits(30);
        struct dt_refined r;
        q.length = 0.1;
        q.most = most;
        refine(t, &q, &r);
        CHECK(r.change.n_points <= most && r.unrefined > 0);
        dt_split_clear(&r.change);
        dt_free(t);
    }
}

TEST(new_points_have_the_values_of_the_surface)
{
    struct dt_point p[] = {{0, 0}, {8, 0}, {8, 1}, {0, 1}, {3, 0.5}};
    uint32_t ids[] = {0, 1, 2, 3, 4}, missing;
    double z[5], w[] = {1, 2, 3, 4, (double)NAN};
    for (int i = 0; i < 5; i++)
        z[i] = 3 + 2 * p[i].x - p[i].y;
    struct dt *t = set_of(p, 5, 0);
    CHECK(dt_field_set(t, "z", 1, ids, z, 5, NULL, &missing) == DT_OK);
    CHECK(dt_field_set(t, "w", 1, ids, w, 5, NULL, &missing) == DT_OK);
    struct dt_quality q = limits(28);
    refined(t, &q);
    uint32_t end = dt_next_id(t), known = 0;
    CHECK(end > 10);
    for (uint32_t id = 5; id < end; id++) {
        struct dt_point at;
        double v;
        CHECK(dt_get(t, id, &at) == DT_OK);
        dt_field_values(dt_field_find(t, "z", 1), NULL, &id, 1, &v);
        CHECK(fabs(v - (3 + 2 * at.x - at.y)) < 1e-13);
        dt_field_values(dt_field_find(t, "w", 1), NULL, &id, 1, &v);
        bool on_hull = at.x == 0 || at.x == 8 || at.y == 0 || at.y == 1;
        CHECK(!on_hull || !isnan(v));
        known += isnan(v) ? 0 : 1;
    }
    CHECK(known > 0 && known < end - 5);
    dt_free(t);
}

/* The same ids at the same places, after other edits. */
static struct dt *with_history(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < n; i++) {
        struct dt_point away = {(double)(i * 7 % 31), (double)(i * 11 % 37)};
        CHECK(dt_add(t, i % 3 == 0 ? &away : &p[i], 1, &added) == DT_OK);
    }
    for (uint32_t i = n; i-- > 0;)
        CHECK(dt_move(t, i, p[i]) == DT_OK);
    return t;
}

TEST(the_plan_depends_on_the_set_alone)
{
    enum { N = 120 };
    struct dt_point p[N];
    for (uint32_t i = 0; i < 8; i++)
        p[i] = (struct dt_point){round(1000 * cos(i * 0.785)), round(1000 * sin(i * 0.785))};
    for (uint32_t i = 8; i < N; i++)
        p[i] = (struct dt_point){(double)(test_random() % 30 * 40) - 600,
                                 (double)(test_random() % 30 * 40) - 600};
    struct dt *t = set_of(p, N, 0), *other = with_history(p, N);
    struct dt_quality q = limits(28);
    struct dt_refined r, s;
    ring(t, 0, 8, 1);
    for (uint32_t i = 8; i-- > 0;)
        declare(other, &(struct dt_constraint){(i + 1) % 8, i, true, 1}, 1);
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_OK && dt_plan_refine(other, &q, NULL, &s) == DT_OK);
    CHECK(r.change.n_points > 100 && are_equal(&r, &s));
    dt_split_clear(&s.change);
    carry_out(t, &q, &r);
    dt_split_clear(&r.change);
    dt_free(t);
    dt_free(other);
}

static enum dt_status refuse(void *ctx, size_t bytes)
{
    size_t *calls = ctx;
    (void)bytes;
    return (*calls)-- == 0 ? DT_NOMEM : DT_OK;
}

TEST(memory_is_asked_for_piece_by_piece_and_a_refusal_ends_the_plan)
{
    struct dt_point p[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    struct dt *t = set_of(p, 4, 0);
    struct dt_quality q = limits(30), free_of_limits = q;
    struct dt_refined r, s;
    size_t calls;
    q.length = free_of_limits.length = 0.02;
    q.reserve = refuse;
    q.ctx = &calls;
    for (size_t i = 0; i < 2; i++) {
        calls = i;
        CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_NOMEM && r.change.point == NULL);
    }
    calls = 100;
    CHECK(dt_plan_refine(t, &q, NULL, &r) == DT_OK && calls <= 98);
    CHECK(dt_plan_refine(t, &free_of_limits, NULL, &s) == DT_OK && are_equal(&r, &s));
    dt_split_clear(&r.change);
    dt_split_clear(&s.change);
    dt_free(t);
}

TEST(a_plan_can_be_cancelled)
{
    struct dt_point p[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    struct dt *t = set_of(p, 4, 0);
    struct dt_quality q = limits(30);
    struct dt_refined r;
    atomic_bool cancel = true;
    struct dt_options opt = {.cancel = &cancel};
    q.length = 0.001;
    CHECK(dt_plan_refine(t, &q, &opt, &r) == DT_CANCELLED && r.change.point == NULL);
    dt_free(t);
}

TEST(coordinates_may_be_huge_tiny_and_far_away)
{
    const double scale[] = {0x1p198, 0x1p-136, 1};
    const double away[] = {0, 0, 0x1p45};
    for (int k = 0; k < 3; k++) {
        struct dt_point p[] = {{0, 0}, {8, 0}, {8, 1}, {0, 1}, {3.7, 0.25}};
        for (int i = 0; i < 5; i++)
            p[i] = (struct dt_point){p[i].x * scale[k] + away[k], p[i].y * scale[k] + away[k]};
        struct dt *t = set_of(p, 5, 0);
        struct dt_quality q = limits(30);
        q.most = 2000;
        refined(t, &q);
        dt_free(t);
    }
}

/* All families: with the hull as border, at 30 degrees; and half of the points inside a triangle of them. */
static void refine_family(const struct family *f, uint32_t n, uint64_t seed)
{
    struct dt_point *p = malloc((n + 1) * sizeof *p);
    struct dt_refined r;
    family_points(f, p, n, seed);
    struct dt *t = set_of(p, n, 0);
    struct dt_quality q = limits(30);
    q.most = 16 * n;
    refine(t, &q, &r);
    dt_split_clear(&r.change);
    dt_free(t);
    free(p);
}

TEST(thirty_degrees_end_on_every_family)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 3; n <= 200; n = 3 * n + 1)
            refine_family(f, n, n);
}
