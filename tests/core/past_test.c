/* past_test.c - a set's rows of an earlier moment, read beside edits, are those of a copy made at that
 * moment. */
#include "core/delaunay.h"

#include "tests/test.h"

#include <stdlib.h>

enum { MOST = 4000 };

struct rows {
    struct dt_row row[MOST];
    size_t n;
};

/* The rows of a set that nobody edits, by its tables. */
static void rows_of(const struct dt *t, struct rows *r)
{
    static uint32_t id[MOST];
    struct dt_cursor c;
    size_t words;
    CHECK(dt_table_begin(t, DT_POINTS, false, &c) == DT_OK && c.rows <= MOST);
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
static bool read_some(struct dt *t, struct rows *r, size_t room)
{
    size_t n;
    CHECK(r->n + room <= MOST && dt_past_read(t, r->row + r->n, room, &n) == DT_OK && n <= room);
    r->n += n;
    return n == room;
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

TEST(past_rows_are_those_of_a_copy_whatever_edits_come_between)
{
    static const double tolerance[] = {0, 0.5, 1, 1.5};
    static struct rows got, want;
    for (unsigned round = 0; round < 120; round++) {
        struct dt *t = crowd(tolerance[round % 4], round % 8 < 4), *copy;
        uint32_t most = 1 + test_below(9), edits = test_below(8);
        for (int twice = 0; twice < 2; twice++) {
            CHECK(dt_clone(t, &copy) == DT_OK);
            rows_of(copy, &want);
            CHECK(dt_past_begin(t) == want.n);
            got.n = 0;
            do
                for (uint32_t i = 0; i < edits; i++)
                    edit(t);
            while (read_some(t, &got, 1 + test_below(most)));
            CHECK(!read_some(t, &got, 1));
            check_equal(&got, &want);
            dt_free(copy);
        }
        dt_past_end(t);
        CHECK(dt_triangulate(t, NULL) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
        dt_free(t);
    }
}

TEST(past_outlives_the_deletion_of_all_points)
{
    static struct rows got, want;
    static uint32_t id[MOST];
    struct dt_summary sum;
    for (int live = 0; live < 2; live++) {
        struct dt *t = crowd(1, live);
        uint32_t deleted, missing;
        rows_of(t, &want);
        dt_past_begin(t);
        for (size_t i = 0; i < want.n; i++)
            id[i] = want.row[i].id;
        CHECK(dt_delete(t, id, want.n, &deleted, &missing) == DT_OK && deleted == want.n);
        add_some(t, 10);
        got.n = 0;
        while (read_some(t, &got, 7))
            ;
        check_equal(&got, &want);
        dt_summary(t, &sum);
        size_t with = sum.memory;
        dt_past_end(t);
        dt_summary(t, &sum);
        CHECK(sum.points == 10 && with - sum.memory >= want.n * sizeof(struct dt_row));
        dt_free(t);
    }
}

/* A family's representative goes a thousand times. */
TEST(past_keeps_no_row_for_each_alias_of_a_family_that_is_renamed)
{
    enum { FAMILY = 3000, GONE = 1000 };
    static struct rows got, want;
    struct dt_point p = {1, 1};
    struct dt_added added;
    struct dt_summary before, after;
    struct dt *t = dt_new(0);
    for (uint32_t i = 0; i < FAMILY; i++)
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    rows_of(t, &want);
    dt_summary(t, &before);
    dt_past_begin(t);
    for (uint32_t id = 0, deleted, missing; id < GONE; id++)
        CHECK(dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    dt_summary(t, &after);
    CHECK(after.memory - before.memory < (size_t)FAMILY * sizeof(struct dt_row));
    got.n = 0;
    while (read_some(t, &got, 100))
        ;
    check_equal(&got, &want);
    dt_free(t);
}

TEST(past_that_cannot_be_kept_says_so_and_edits_go_on)
{
    static struct rows got, want;
    bool lost = false;
    for (long n = 1;; n++) {
        struct dt *t = crowd(0.5, true);
        uint32_t missing, deleted, id;
        rows_of(t, &want);
        dt_past_begin(t);
        id = want.row[0].id;
        test_fail_alloc(n);
        enum dt_status status = dt_delete(t, &id, 1, &deleted, &missing);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        size_t rows = 0;
        enum dt_status past = dt_past_read(t, got.row, MOST, &rows);
        got.n = rows;
        CHECK(status == DT_OK || status == DT_NOMEM);
        if (past == DT_OK)
            check_equal(&got, &want);
        else
            CHECK(past == DT_NOMEM && failed && status == DT_OK);
        lost = lost || past == DT_NOMEM;
        dt_free(t);
        if (!failed)
            break;
    }
    CHECK(lost);
}
