/* constraint_rows_test.c - constraints read in pieces, now and at earlier moments; and the reports of edits to readers that follow a
 * set. */
#include "core/delaunay_constraints.h"

#include "tests/test.h"

#include <stdlib.h>
#include <string.h>

enum { SIDE = 12, POINTS = SIDE * SIDE };

static uint32_t below(uint32_t n)
{
    return test_below(n);
}

/* A lattice, triangulated. */
static struct dt *lattice(void)
{
    static struct dt_point p[POINTS];
    struct dt_added added;
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){i % SIDE, i / SIDE};
    struct dt *t = dt_new(0);
    CHECK(t != NULL && dt_add_many(t, p, POINTS, NULL, &added) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static struct dt_constraint some_constraint(void)
{
    struct dt_constraint c = {below(POINTS), below(POINTS), below(2) == 0, below(3)};
    c.b += c.a == c.b ? (c.b == 0 ? 1 : UINT32_MAX) : 0;
    return c;
}

/* Declares or releases a few; refusals change nothing. */
static void edit(struct dt *t)
{
    struct dt_constraint c = some_constraint(), *all;
    size_t n, k;
    uint32_t missing;
    if (below(3) > 0) {
        dt_constrain(t, &c, 1, NULL, &n, &missing);
        return;
    }
    CHECK(dt_constraints(t, NULL, DT_NONE, &all, &n) == DT_OK);
    if (n > 0) {
        size_t at = below((uint32_t)n), m = below(10) == 0 ? n - at : 1;
        CHECK(dt_release(t, all + at, m, NULL, &k, &n) == DT_OK && k == m);
    }
    free(all);
}

static bool is_same(const struct dt_constraint *a, const struct dt_constraint *b)
{
    return a->a == b->a && a->b == b->b && a->border == b->border && a->number == b->number;
}

static void check_equal(const struct dt_constraint *got, size_t n, const struct dt_constraint *want,
                        size_t k)
{
    CHECK(n == k);
    for (size_t i = 0; i < n; i++)
        CHECK(is_same(&got[i], &want[i]));
}

TEST(constraints_are_read_in_pieces_as_they_were_while_edits_go_on)
{
    enum { VIEWS = 4 };
    for (int round = 0; round < 60; round++) {
        struct dt *t = lattice();
        struct dt_view *view[VIEWS];
        struct dt_constraint *want[VIEWS];
        struct dt_constraint_list got[VIEWS] = {{0}};
        size_t n[VIEWS];
        uint32_t from[VIEWS] = {0};
        for (int v = 0; v < VIEWS; v++) {
            for (int i = 0; i < 40; i++)
                edit(t);
            view[v] = dt_view_begin(t, false);
            CHECK(view[v] != NULL && dt_constraints(t, NULL, DT_NONE, &want[v], &n[v]) == DT_OK);
        }
        for (int open = VIEWS; open > 0;) {
            uint32_t v = below(VIEWS);
            edit(t);
            if (view[v] == NULL)
                continue;
            CHECK(dt_constraints_read(t, view[v], &from[v], 1 + below(9), &got[v]) == DT_OK);
            if (from[v] != DT_NONE)
                continue;
            check_equal(got[v].v, got[v].n, want[v], n[v]);
            dt_view_end(view[v]);
            view[v] = NULL;
            open--;
        }
        for (int v = 0; v < VIEWS; v++) {
            free(got[v].v);
            free(want[v]);
        }
        dt_free(t);
    }
}

TEST(reading_constraints_piece_by_piece_visits_an_id_with_many_in_one_piece)
{
    struct dt *t = lattice();
    struct dt_constraint_list got = {0};
    size_t added;
    uint32_t missing, from = 0;
    struct dt_constraint c[] = {{0, 1, false, 0},
                                {SIDE, 0, true, 7},
                                {0, SIDE, true, 2},
                                {SIDE, 0, false, 9},
                                {3, 4, false, 0}};
    CHECK(dt_constrain(t, c, 5, NULL, &added, &missing) == DT_OK && added == 5);
    CHECK(dt_constraints_read(t, NULL, &from, 1, &got) == DT_OK);
    CHECK(got.n == 4 && from == 1);
    check_equal(got.v, 4,
                (struct dt_constraint[]){
                    {0, 1, false, 0}, {0, SIDE, false, 9}, {0, SIDE, true, 2}, {0, SIDE, true, 7}},
                4);
    CHECK(dt_constraint_has(t, &c[1]) &&
          !dt_constraint_has(t, &(struct dt_constraint){0, 3, false, 0}));
    free(got.v);
    dt_free(t);
}

/* ---- touched ---- */

static void check_taken(struct dt *t, const struct dt_touched_constraint *want, size_t k)
{
    const struct dt_touched_constraint *got;
    size_t n;
    CHECK(dt_touched_take_constraints(t, &got, &n));
    CHECK_MSG(n == k, "%zu, not %zu", n, k);
    for (size_t i = 0; i < n; i++) {
        CHECK(is_same(&got[i].what, &want[i].what) && got[i].moved == want[i].moved);
        CHECK(memcmp(got[i].at, want[i].at, sizeof got[i].at) == 0);
    }
}

TEST(edits_report_the_constraints_that_they_declare_release_or_move_an_end_of)
{
    struct dt *t = lattice();
    const uint32_t end = SIDE + 1;
    const struct dt_constraint c = {end, 0, true, 5}, d = {0, end, true, 5};
    const struct dt_touched_constraint *got;
    size_t n;
    uint32_t missing, deleted;
    CHECK(!dt_touched_take_constraints(t, &got, &n));
    dt_touched_begin(t, false);
    CHECK(dt_constrain(t, &c, 1, NULL, &n, &missing) == DT_OK);
    CHECK(dt_touched_count(t) > 0);
    check_taken(t, (struct dt_touched_constraint[]){{d, {{0, 0}, {1, 1}}, false}}, 1);
    check_taken(t, NULL, 0);
    CHECK(dt_move(t, end, (struct dt_point){1.25, 1}) == DT_OK);
    CHECK(dt_touched_take_constraints(t, &got, &n) && n > 0);
    for (size_t i = 0; i < n; i++)
        CHECK(got[i].moved && is_same(&got[i].what, &d));
    CHECK(got[0].at[1].x == 1);
    CHECK(dt_delete_cascade(t, &end, 1, NULL, &deleted, &missing) == DT_OK);
    CHECK(dt_touched_take_constraints(t, &got, &n) && n > 0);
    CHECK(!got[0].moved && is_same(&got[0].what, &d) && got[0].at[1].x == 1.25);
    dt_touched_end(t);
    CHECK(!dt_touched_take_constraints(t, &got, &n));
    dt_free(t);
}

TEST(too_many_touched_constraints_are_a_change_of_everything)
{
    enum { MANY = 20000 };
    static struct dt_constraint c[MANY];
    const struct dt_touched_constraint *got;
    size_t n;
    uint32_t missing;
    struct dt *t = lattice();
    for (uint32_t i = 0; i < MANY; i++)
        c[i] = (struct dt_constraint){0, 1, false, i};
    dt_touched_begin(t, false);
    CHECK(dt_constrain(t, c, MANY, NULL, &n, &missing) == DT_OK && n == MANY);
    CHECK(!dt_touched_take_constraints(t, &got, &n));
    check_taken(t, NULL, 0);
    dt_free(t);
}

/* ---- boxes ---- */

/* Small integers, so that products are exact. */
static int side(struct dt_point a, struct dt_point b, double x, double y)
{
    double d = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    return (d > 0) - (d < 0);
}

static bool is_inside(struct dt_point p, struct dt_point lo, struct dt_point hi)
{
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y;
}

/* Whether closed segments meet. */
static bool do_meet(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    int one = side(a, b, c.x, c.y) * side(a, b, d.x, d.y);
    int other = side(c, d, a.x, a.y) * side(c, d, b.x, b.y);
    struct dt_point lo = {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y};
    struct dt_point hi = {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
    bool on = (side(a, b, c.x, c.y) == 0 && is_inside(c, lo, hi)) ||
              (side(a, b, d.x, d.y) == 0 && is_inside(d, lo, hi));
    return (one <= 0 && other < 0) || (one < 0 && other <= 0) || on;
}

TEST(segment_meets_a_box_if_it_has_an_end_inside_or_meets_a_side)
{
    for (int i = 0; i < 200000; i++) {
        struct dt_point p[4];
        for (int k = 0; k < 4; k++)
            p[k] = (struct dt_point){below(7), below(7)};
        struct dt_point a = p[0], b = p[1];
        struct dt_point lo = {p[2].x < p[3].x ? p[2].x : p[3].x, p[2].y < p[3].y ? p[2].y : p[3].y};
        struct dt_point hi = {p[2].x + p[3].x - lo.x, p[2].y + p[3].y - lo.y};
        const struct dt_point corner[4] = {lo, {hi.x, lo.y}, hi, {lo.x, hi.y}};
        bool want = is_inside(a, lo, hi) || is_inside(b, lo, hi);
        for (int k = 0; k < 4; k++)
            want = want || do_meet(corner[k], corner[(k + 1) % 4], a, b) ||
                   do_meet(a, b, corner[k], corner[(k + 1) % 4]);
        CHECK_MSG(dt_segment_meets_box(a, b, lo, hi) == want, "%g %g - %g %g, box %g %g %g %g", a.x,
                  a.y, b.x, b.y, lo.x, lo.y, hi.x, hi.y);
    }
}
