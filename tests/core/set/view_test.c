/* view_test.c - a view read during edits shows the same as a copy made at its moment. */
#include "core/delaunay.h"

#include "tests/test.h"

#include <stdlib.h>

enum { MOST = 4000 };

struct rows {
    struct dt_row row[MOST];
    size_t n;
};

/* The rows of an unchanged set, by its tables. */
static void rows_of(const struct dt *t, struct rows *r)
{
    static uint32_t id[MOST];
    struct dt_cursor c;
    size_t words;
    CHECK(dt_table_begin(t, NULL, DT_POINTS, false, &c) == DT_OK && c.rows <= MOST);
    CHECK(dt_table_read(t, &c, id, MOST, MOST, &r->n, &words) == DT_OK && r->n == c.rows);
    for (size_t i = 0; i < r->n; i++) {
        r->row[i].id = id[i];
        CHECK(dt_get(t, id[i], &r->row[i].at) == DT_OK);
        CHECK(dt_representative(t, id[i], &r->row[i].representative) == DT_OK);
    }
}

static void check_equal(const struct rows *got, const struct rows *want)
{
    CHECK_MSG(got->n == want->n, "%zu rows instead of %zu", got->n, want->n);
    for (size_t i = 0; i < want->n; i++) {
        struct dt_row g = got->row[i], w = want->row[i];
        CHECK_MSG(g.id == w.id && g.representative == w.representative && g.at.x == w.at.x &&
                      g.at.y == w.at.y,
                  "row %zu is %u %u %g %g instead of %u %u %g %g", i, g.id, g.representative,
                  g.at.x, g.at.y, w.id, w.representative, w.at.x, w.at.y);
    }
}

/* Reads up to `room` more rows; false at the end. */
static bool read_some(struct dt *t, struct dt_view *v, uint32_t *from, struct rows *r, size_t room)
{
    size_t n;
    CHECK(r->n + room <= MOST);
    CHECK(dt_view_rows(t, v, from, r->row + r->n, room, &n) == DT_OK && n <= room);
    r->n += n;
    return n == room;
}

static void read_rest(struct dt *t, struct dt_view *v, struct rows *r, size_t room)
{
    uint32_t from = 0;
    r->n = 0;
    while (read_some(t, v, &from, r, room))
        ;
}

/* ---- edits: a small lattice, so that points coincide ---- */

static struct dt_point somewhere(void)
{
    return (struct dt_point){test_below(7), test_below(7)};
}

static void add_some(struct dt *t, uint32_t n)
{
    struct dt_point p[64];
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        p[i] = somewhere();
    CHECK(dt_add(t, p, n, &added) == DT_OK);
}

static void delete_some(struct dt *t, uint32_t n)
{
    uint32_t id[64], deleted, missing;
    for (uint32_t i = 0; i < n; i++)
        id[i] = test_below(dt_next_id(t));
    dt_delete(t, id, n, &deleted, &missing); /* of many, one is often missing: nothing happens */
}

/* By so little that the mesh may stay as it is. */
static void nudge(struct dt *t, uint32_t id)
{
    struct dt_point p;
    if (dt_get(t, id, &p) == DT_OK)
        dt_move(t, id, (struct dt_point){p.x + 0.0625 * test_below(3), p.y});
}

static void edit(struct dt *t)
{
    struct dt_options again = {.rebuild = true};
    unsigned kind = test_below(100);
    if (kind < 20)
        add_some(t, 1 + test_below(3));
    else if (kind < 50)
        nudge(t, test_below(dt_next_id(t)));
    else if (kind < 70)
        delete_some(t, 1 + test_below(3));
    else if (kind < 97)
        dt_move(t, test_below(dt_next_id(t)), somewhere());
    else if (kind < 98)
        CHECK(dt_triangulate(t, &again) == DT_OK); /* other vertex numbers */
    else
        add_some(t, 64);
}

static struct dt *crowd(double tolerance, bool live)
{
    struct dt *t = dt_new(tolerance);
    for (int i = 0; i < 4; i++)
        add_some(t, 50);
    for (int i = 0; i < 40; i++)
        delete_some(t, 1);
    if (live)
        CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

/* ---- tests ---- */

TEST(view_has_the_rows_of_a_copy_after_any_edits)
{
    static const double tolerance[] = {0, 0.5, 1, 1.5};
    static struct rows got, want;
    for (unsigned round = 0; round < 120; round++) {
        struct dt *t = crowd(tolerance[round % 4], round % 8 < 4), *copy;
        uint32_t most = 1 + test_below(9), edits = test_below(8);
        for (int twice = 0; twice < 2; twice++) {
            CHECK(dt_clone(t, &copy) == DT_OK);
            rows_of(copy, &want);
            struct dt_view *v = dt_view_begin(t, false);
            uint32_t from = 0;
            CHECK(v != NULL && dt_view_next_id(v) == dt_next_id(copy));
            got.n = 0;
            do
                for (uint32_t i = 0; i < edits; i++)
                    edit(t);
            while (read_some(t, v, &from, &got, 1 + test_below(most)));
            CHECK(!read_some(t, v, &from, &got, 1));
            check_equal(&got, &want);
            dt_view_end(v);
            dt_free(copy);
        }
        CHECK(dt_triangulate(t, NULL) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
        dt_free(t);
    }
}

TEST(view_outlives_the_deletion_of_all_points)
{
    static struct rows got, want;
    static uint32_t id[MOST];
    struct dt_summary sum;
    for (int live = 0; live < 2; live++) {
        struct dt *t = crowd(1, live);
        uint32_t deleted, missing;
        rows_of(t, &want);
        struct dt_view *v = dt_view_begin(t, false);
        for (size_t i = 0; i < want.n; i++)
            id[i] = want.row[i].id;
        CHECK(dt_delete(t, id, want.n, &deleted, &missing) == DT_OK && deleted == want.n);
        add_some(t, 10);
        read_rest(t, v, &got, 7);
        check_equal(&got, &want);
        dt_summary(t, &sum);
        size_t with = sum.memory;
        dt_view_end(v);
        while (dt_view_tidy(t))
            ;
        dt_summary(t, &sum);
        CHECK(sum.points == 10 && with - sum.memory >= want.n * sizeof(struct dt_row));
        dt_free(t);
    }
}

/* A family's representative is deleted many times. */
TEST(view_saves_no_row_for_each_alias_of_a_family_that_is_renamed)
{
    enum { FAMILY = 3500, GONE = 200 };
    static struct rows got, want;
    struct dt_point p = {1, 1};
    struct dt_added added;
    struct dt_summary before, after;
    struct dt *t = dt_new(0);
    for (uint32_t i = 0; i < FAMILY; i++)
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    rows_of(t, &want);
    dt_summary(t, &before);
    struct dt_view *v = dt_view_begin(t, false);
    for (uint32_t id = 0, deleted, missing; id < GONE; id++)
        CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    dt_summary(t, &after);
    CHECK(after.memory - before.memory < (size_t)FAMILY * sizeof(struct dt_row));
    read_rest(t, v, &got, 100);
    check_equal(&got, &want);
    dt_view_end(v);
    dt_free(t);
}

TEST(view_that_cannot_be_kept_says_so_and_edits_go_on)
{
    static struct rows got, want;
    bool lost = false;
    for (long n = 1;; n++) {
        struct dt *t = crowd(0.5, true);
        uint32_t missing, deleted, id;
        rows_of(t, &want);
        struct dt_view *v = dt_view_begin(t, false);
        id = want.row[0].id;
        test_fail_alloc(n);
        enum dt_status status = dt_delete(t, &id, 1, &deleted, &missing);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        size_t rows = 0;
        uint32_t from = 0;
        enum dt_status read = dt_view_rows(t, v, &from, got.row, MOST, &rows);
        got.n = rows;
        CHECK(status == DT_OK || status == DT_NOMEM);
        if (read == DT_OK)
            check_equal(&got, &want);
        else
            CHECK(read == DT_NOMEM && failed && status == DT_OK);
        lost = lost || read == DT_NOMEM;
        dt_view_end(v);
        dt_free(t);
        if (!failed)
            break;
    }
    CHECK(lost);
}
