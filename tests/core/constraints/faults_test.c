/* faults_test.c - inputs on which other libraries fail, as their users report; each is the smallest that we could make. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"
#include "tests/oracle/constrained.h"
#include "tests/test.h"

static void check_mesh(const struct dt *t)
{
    const char *fault = NULL;
    if (dt_check(t, NULL, &fault) != DT_OK || (fault = constrained_fault(t)) != NULL)
        CHECK_MSG(false, "%s", fault);
}

static struct dt *set_of(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static enum dt_status constrain(struct dt *t, uint32_t a, uint32_t b)
{
    size_t added;
    uint32_t missing;
    return dt_constrain(t, &(struct dt_constraint){a, b, false, 0}, 1, NULL, &added, &missing);
}

static enum dt_status release(struct dt *t, uint32_t a, uint32_t b)
{
    size_t released, missing;
    return dt_release(t, &(struct dt_constraint){a, b, false, 0}, 1, NULL, &released, &missing);
}

static bool has_edge(const struct dt *t, uint32_t a, uint32_t b)
{
    struct dt_ids out = {0};
    bool there = dt_triangles_at_edge(t, a, b, false, &out) == DT_OK;
    free(out.v);
    return there;
}

/* The triangles of t, which has few. */
static size_t triangles(const struct dt *t, uint32_t out[600])
{
    struct dt_cursor c;
    size_t rows, words;
    CHECK(dt_table_begin(t, NULL, DT_TRIANGLES, false, &c) == DT_OK && c.rows <= 200);
    CHECK(dt_table_read(t, &c, out, 600, SIZE_MAX, &rows, &words) == DT_OK);
    return words;
}

static void check_equal(const struct dt *a, const struct dt *b)
{
    uint32_t x[600], y[600];
    size_t n = triangles(a, x);
    CHECK(n == triangles(b, y) && memcmp(x, y, n * sizeof *x) == 0);
}

/* CGAL #2999, #3267; CDT #113, #139; Tinfour #16. */
TEST(whether_constraints_cross_does_not_depend_on_their_order)
{
    const struct dt_point p[] = {{0, 0},  {4, 4},  {0, 4}, {4, 0}, {2, 5},
                                 {2, -1}, {-1, 2}, {5, 2}, {2, 2}};
    const uint32_t end[4][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}};
    struct dt *first = NULL;
    for (uint32_t order = 0; order < 4; order++) {
        struct dt *t = set_of(p, 9);
        for (uint32_t i = 0; i < 4; i++)
            CHECK(constrain(t, end[(i + order) % 4][0], end[(i + order) % 4][1]) == DT_OK);
        check_mesh(t);
        if (first != NULL)
            check_equal(first, t);
        dt_free(first);
        first = t;
    }
    dt_free(first);
    for (uint32_t order = 0; order < 4; order++) {
        struct dt *t = set_of(p, 8); /* without the point in the middle */
        CHECK(constrain(t, end[order][0], end[order][1]) == DT_OK);
        for (uint32_t i = 1; i < 4; i++)
            CHECK(constrain(t, end[(i + order) % 4][0], end[(i + order) % 4][1]) == DT_CROSSES);
        CHECK(dt_constraints_count(t) == 1);
        check_mesh(t);
        dt_free(t);
    }
}

/* The same of many at once: every edge of a lattice, and both diagonals of one of its squares. */
TEST(many_constraints_at_once_that_cross_are_refused_like_one_by_one)
{
    enum { WIDTH = 8, EDGES = 2 * WIDTH * (WIDTH - 1) };
    struct dt_point p[WIDTH * WIDTH];
    struct dt_constraint c[EDGES + 2];
    size_t n = 0, added;
    uint32_t missing;
    for (uint32_t i = 0; i < WIDTH * WIDTH; i++) {
        p[i] = (struct dt_point){i % WIDTH, i / WIDTH}; /* NOLINT: whole numbers */
        if (i % WIDTH > 0)
            c[n++] = (struct dt_constraint){i, i - 1, false, i};
        if (i >= WIDTH)
            c[n++] = (struct dt_constraint){i - WIDTH, i, true, 0};
    }
    struct dt *t = set_of(p, WIDTH * WIDTH), *fresh = set_of(p, WIDTH * WIDTH);
    struct dt_crossed crossed;
    c[n] = c[40];
    c[40] = (struct dt_constraint){9, 18, false, 0};
    c[n + 1] = (struct dt_constraint){10, 17, false, 3};
    for (int again = 0; again < 2; again++) {
        CHECK(dt_constrain(t, c, n + 2, NULL, &added, &missing) == DT_CROSSES && added == 0);
        dt_crossed(t, &crossed);
        CHECK(crossed.one.a == 10 && crossed.one.b == 17 && crossed.one.number == 3);
        CHECK(crossed.other.a == 9 && crossed.other.b == 18 && dt_constraints_count(t) == 0);
        check_equal(t, fresh);
    }
    CHECK(dt_constrain(t, c, n + 1, NULL, &added, &missing) == DT_OK && added == n + 1);
    for (size_t i = n + 1; i-- > 0;)
        CHECK(dt_constrain(fresh, &c[i], 1, NULL, &added, &missing) == DT_OK && added == 1);
    check_mesh(t);
    check_equal(t, fresh);
    CHECK(dt_constrain(t, c, n + 2, NULL, &added, &missing) == DT_CROSSES && added == 0);
    CHECK(dt_constraints_count(t) == n + 1);
    check_equal(t, fresh);
    CHECK(dt_constrain(t, c, n + 1, NULL, &added, &missing) == DT_OK && added == 0);
    dt_free(t);
    dt_free(fresh);
}

/* CGAL #4059. */
TEST(constraints_that_overlap_are_released_one_by_one)
{
    const struct dt_point p[] = {{0, 0}, {2, 0}, {4, 0}, {6, 0}, {3, 0.25}, {3, -0.25}};
    struct dt *t = set_of(p, 6), *fresh = set_of(p, 6);
    CHECK(constrain(t, 0, 3) == DT_OK && constrain(t, 0, 2) == DT_OK &&
          constrain(t, 1, 3) == DT_OK);
    check_mesh(t);
    CHECK(release(t, 0, 3) == DT_OK && has_edge(t, 1, 2));
    check_mesh(t);
    CHECK(release(t, 2, 0) == DT_OK && has_edge(t, 1, 2));
    check_mesh(t);
    CHECK(release(t, 1, 3) == DT_OK && !has_edge(t, 1, 2));
    check_equal(t, fresh);
    dt_free(t);
    dt_free(fresh);
}

/* CDT #204, Tinfour #119. */
TEST(a_point_exactly_on_a_constraint_splits_it_however_flat_its_triangles_are)
{
    const struct dt_point p[] = {{0, 0},        {3, 0x1p-60}, {1, 0x1p-60},
                                 {2, -0x1p-60}, {1, 5},       {2, -5}};
    struct dt *t = set_of(p, 6);
    struct dt_added added;
    CHECK(constrain(t, 0, 1) == DT_OK);
    check_mesh(t);
    CHECK(dt_add(t, &(struct dt_point){1.5, 0x1p-61}, 1, &added) == DT_OK);
    CHECK(has_edge(t, 0, 6) && has_edge(t, 6, 1));
    check_mesh(t);
    dt_free(t);
}

/* spade #134: after a deletion there were constraints that no call had declared. */
TEST(a_deletion_beside_a_constraint_constrains_nothing_else)
{
    struct dt_point p[25];
    for (uint32_t i = 0; i < 25; i++)
        p[i] = (struct dt_point){i % 5, i / 5}; /* NOLINT: whole numbers */
    struct dt *t = set_of(p, 25);
    uint32_t deleted, missing;
    CHECK(constrain(t, 0, 24) == DT_OK && constrain(t, 0, 4) == DT_OK);
    for (uint32_t id = 1; id < 24; id++) {
        if (id == 4)
            continue;
        CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
        check_mesh(t);
    }
    CHECK(has_edge(t, 0, 24) && has_edge(t, 0, 4));
    dt_free(t);
}

/* Tinfour #112: a triangulation that is locked once it has constraints. */
TEST(a_set_with_constraints_takes_every_edit)
{
    const struct dt_point p[] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {4, 5}};
    struct dt *t = set_of(p, 5);
    struct dt_added added;
    uint32_t deleted, missing, middle = 4;
    CHECK(constrain(t, 0, 2) == DT_OK);
    CHECK(dt_add(t, &(struct dt_point){2, 7}, 1, &added) == DT_OK);
    CHECK(dt_move(t, 0, (struct dt_point){-3, 1}) == DT_OK);
    CHECK(dt_move(t, middle, (struct dt_point){20, -20}) == DT_OK);
    CHECK(dt_delete(t, &middle, 1, &deleted, &missing) == DT_OK);
    CHECK(constrain(t, 1, 3) == DT_CROSSES && release(t, 0, 2) == DT_OK &&
          constrain(t, 1, 3) == DT_OK);
    check_mesh(t);
    dt_free(t);
}

/* A hub with a spoke to each of n corners, and to those of one half of the circle alone if it is to be on the hull. */
static struct dt *set_of_wheel(uint32_t n, bool half)
{
    struct dt_point p[101] = {{0, 0}};
    for (uint32_t i = 0; i < n / 2; i++) {
        double angle = 2 * M_PI * i / n;
        struct dt_point q = {round(1000 * cos(angle)), round(1000 * sin(angle))};
        p[1 + i] = q;
        p[1 + i + n / 2] = (struct dt_point){-q.x, -q.y};
    }
    return set_of(p, half ? 2 + n / 2 : 1 + n);
}

/* Tinfour #112, of the hub of a wheel. */
TEST(a_hub_goes_whether_constraints_run_through_it_or_around_it)
{
    uint32_t hub = 0, deleted, missing;
    for (uint32_t n = 20; n <= 100; n += 80)
        for (uint32_t way = 0; way < 6; way++) {
            bool half = way >= 3, through = way % 3 > 0;
            struct dt *t = set_of_wheel(n, half);
            struct dt_added added;
            CHECK(constrain(t, 2, 3) == DT_OK && constrain(t, 4, 6) == DT_OK);
            for (uint32_t k = 0; k < way % 3; k++)
                CHECK(constrain(t, 1, 1 + n / 2) == DT_OK && (k > 0 || has_edge(t, 0, 1)));
            CHECK(dt_delete(t, &hub, 1, &deleted, &missing) == DT_OK);
            check_mesh(t);
            CHECK(has_edge(t, 2, 3) && (!through || has_edge(t, 1, 1 + n / 2)));
            CHECK(dt_add(t, &(struct dt_point){0, 0}, 1, &added) == DT_OK);
            check_mesh(t);
            dt_free(t);
        }
}

/* poly2tri, Constrainautor #15: near-collinear points, and coordinates of 1e-18. */
TEST(constraints_among_nearly_collinear_points_are_exact)
{
    struct dt_point p[24];
    for (int scale = 0; scale < 2; scale++) {
        double unit = scale == 0 ? 1 : 1e-18;
        for (uint32_t i = 0; i < 24; i++)
            p[i] = (struct dt_point){(0.1 * i + 0.3) * unit,
                                     (0.1 * i + 0.3) * unit * (1 + (i % 3) * 0x1p-52)};
        struct dt *t = set_of(p, 24);
        for (uint32_t i = 0; i + 7 < 24; i++) {
            enum dt_status want = DT_OK;
            struct dt_constraint *c;
            size_t n;
            CHECK(dt_constraints(t, NULL, DT_NONE, &c, &n) == DT_OK);
            for (size_t k = 0; k < n; k++)
                if (constraints_cross(t, i, i + 7, c[k].a, c[k].b))
                    want = DT_CROSSES;
            free(c);
            CHECK(constrain(t, i, i + 7) == want);
            check_mesh(t);
        }
        dt_free(t);
    }
}

/* CDT #103: other diagonals of squares on another system. */
TEST(the_diagonals_of_squares_beside_constraints_are_canonical)
{
    struct dt_point p[16];
    for (uint32_t i = 0; i < 16; i++)
        p[i] = (struct dt_point){i % 4, i / 4}; /* NOLINT: whole numbers */
    struct dt *t = set_of(p, 16), *late = dt_new(0);
    struct dt_added added;
    CHECK(constrain(t, 0, 7) == DT_OK && constrain(t, 8, 15) == DT_OK);
    CHECK(dt_triangulate(late, NULL) == DT_OK);
    for (uint32_t i = 0; i < 16; i++) {
        CHECK(dt_add(late, &p[i], 1, &added) == DT_OK);
        if (i == 7)
            CHECK(constrain(late, 7, 0) == DT_OK);
    }
    CHECK(constrain(late, 15, 8) == DT_OK);
    check_equal(t, late);
    dt_free(t);
    dt_free(late);
}

/* CDT #211: constraints that never return. */
TEST(thousands_of_constraints_may_share_a_point)
{
    enum { SPOKES = 4000 };
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_point hub = {0, 0};
    CHECK(dt_add(t, &hub, 1, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < SPOKES; i++) {
        struct dt_point p = {(double)i - SPOKES / 2.0, 1000 + (double)(i * 7919 % SPOKES)};
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    }
    uint32_t kept = 0;
    for (uint32_t i = 1; i <= SPOKES; i++) {
        struct dt_options few = {.steps = 100000};
        size_t n;
        uint32_t missing;
        CHECK(dt_constrain(t, &(struct dt_constraint){0, i, false, 0}, 1, &few, &n, &missing) ==
              DT_OK);
        kept += n == 1;
    }
    CHECK(kept == SPOKES && dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
}

/* ---- what outlines enclose ---- */

/* The points of a ring, from id `first` on, become its border. */
static void enclose(struct dt *t, uint32_t first, uint32_t n, uint32_t number)
{
    size_t added;
    uint32_t missing;
    for (uint32_t i = 0; i < n; i++) {
        struct dt_constraint side = {first + i, first + (i + 1) % n, true, number};
        CHECK(dt_constrain(t, &side, 1, NULL, &added, &missing) == DT_OK && added == 1);
    }
}

/* The areas of the borders, which are closed, and of all that is inside. */
static void check_areas(struct dt *t, const double *area, size_t n, double all)
{
    struct dt_region *row, inside;
    size_t rows;
    check_mesh(t);
    CHECK(dt_survey(t, NULL) == DT_OK && dt_regions(t, &row, &rows, &inside) == DT_OK);
    CHECK(rows == n && inside.area == all);
    for (size_t i = 0; i < n; i++)
        CHECK(row[i].closed && row[i].area == area[i]);
    free(row);
}

/* CDT #42, #123: sides that lie partly on one another. */
TEST(outlines_that_overlap_along_a_side_break_nothing_inside)
{
    const struct dt_point p[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {4, 1}, {8, 1}, {8, 6}, {4, 6}};
    for (uint32_t second = 1; second <= 2; second++) {
        struct dt *t = set_of(p, 8);
        enclose(t, 0, 4, 1);
        enclose(t, 4, 4, second);
        check_areas(t, second == 1 ? (double[]){36} : (double[]){16, 20}, second, 36);
        CHECK(has_edge(t, 4, 2) && has_edge(t, 1, 4) && has_edge(t, 2, 7));
        dt_free(t);
    }
}

/* Godot #86127. */
TEST(outlines_may_be_nested_and_touch_at_corners_and_along_sides)
{
    const struct dt_point p[] = {{0, 0}, {12, 0}, {12, 12}, {0, 12}, /* the outline */
                                 {0, 6}, {6, 0},  {8, 8},            /* a hole: two corners on it */
                                 {6, 6}, {6, 2},  {2, 6},            /* an island in that */
                                 {8, 8}, {12, 8}, {12, 12}, {8, 12}}; /* a hole along two sides */
    struct dt *t = set_of(p, 14);
    enclose(t, 0, 4, 1);
    enclose(t, 4, 3, 1);
    enclose(t, 7, 3, 1);
    enclose(t, 10, 4, 1);
    check_areas(t, (double[]){144 - 30 + 8 - 16}, 1, 144 - 30 + 8 - 16);
    dt_free(t);
}

/* spade #73: the part inside the outline, not the hull. */
TEST(what_is_inside_an_outline_that_is_not_convex_is_not_its_hull)
{
    const struct dt_point p[] = {{0, 0}, {9, 0}, {9, 9}, {6, 9}, {6, 3}, {3, 3}, {3, 9}, {0, 9}};
    struct dt *t = set_of(p, 8);
    struct dt_ids rows = {0};
    uint32_t all[600];
    enclose(t, 0, 8, 5);
    check_areas(t, (double[]){63}, 1, 63);
    CHECK(dt_inside(t, 5, DT_TRIANGLES, false, NULL, &rows) == DT_OK);
    CHECK(rows.n == 3 * (8 - 2) && triangles(t, all) == rows.n + 3 * 2);
    free(rows.v);
    dt_free(t);
}

/* QGIS #44501: which original each part belongs to. */
TEST(parts_of_a_constraint_belong_to_the_one_that_was_declared)
{
    const struct dt_point p[] = {{0, 0}, {2, 0}, {4, 0}, {6, 0}, {3, 2}, {3, -2}};
    const struct dt_constraint line[] = {{0, 3, false, 7}, {4, 5, true, 9}};
    struct dt *t = set_of(p, 6);
    struct dt_constraint *row;
    struct dt_split plan;
    size_t n;
    uint32_t missing;
    CHECK(dt_constrain(t, &line[0], 1, NULL, &n, &missing) == DT_OK);
    CHECK(has_edge(t, 0, 1) && has_edge(t, 1, 2) && has_edge(t, 2, 3));
    CHECK(dt_constraints(t, NULL, DT_NONE, &row, &n) == DT_OK && n == 1);
    CHECK(row->a == 0 && row->b == 3 && !row->border && row->number == 7);
    free(row);
    CHECK(dt_plan_split(t, &line[1], 1, SIZE_MAX, NULL, &plan, &missing) == DT_OK);
    CHECK(plan.n_points == 1 && plan.n_released == 1 && plan.n_added == 4 && plan.split == 2);
    for (size_t i = 0; i < plan.n_added; i++) {
        bool of_line = plan.added[i].a == 0 || plan.added[i].a == 3;
        CHECK(plan.added[i].number == (of_line ? 7 : 9) && plan.added[i].border == !of_line);
    }
    dt_split_clear(&plan);
    dt_free(t);
}
