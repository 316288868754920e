/* view_limits_test.c - limits and costs of a view: no memory, edits that leave the triangulation to
 * a rebuild, sets that have none. */
#include <stdlib.h>
#include <string.h>

#include "core/set/set.h"
#include "tests/core/sets.h"
#include "tests/test.h"

enum { N = 60, WORDS = 2000 };

/* Points on a lattice, some of which coincide. */
static struct dt *lattice(double tolerance)
{
    struct dt_point p[N];
    struct dt_added added;
    struct dt *t = dt_new(tolerance);
    for (uint32_t i = 0; i < N; i++)
        p[i] = (struct dt_point){i * 7 % 8, i * 5 % 9 * 3 % 7};
    CHECK(dt_add(t, p, N, &added) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static enum dt_status read_table(const struct dt *t, const struct dt_view *v, enum dt_table table,
                                 struct dt_ids *out)
{
    struct dt_cursor c;
    size_t rows;
    enum dt_status s = dt_table_begin(t, v, table, false, &c);
    out->v = malloc(WORDS * sizeof *out->v);
    out->n = 0;
    return s == DT_OK ? dt_table_read(t, &c, out->v, WORDS, WORDS, &rows, &out->n) : s;
}

/* Returns whether the view can still be read; if so, it has the table of the copy. */
static bool check_table(const struct dt *t, const struct dt_view *v, const struct dt *copy,
                        enum dt_table table)
{
    struct dt_ids got = {0}, want = {0};
    enum dt_status s = read_table(t, v, table, &got);
    CHECK(s == DT_OK || s == DT_NOMEM);
    CHECK(read_table(copy, NULL, table, &want) == DT_OK);
    if (s == DT_OK)
        check_equal_ids(table_names[table], &got, &want);
    free(got.v);
    free(want.v);
    return s == DT_OK;
}

/* ---- no memory ---- */

enum { ADD, BATCH, DELETE, DELETE_MANY, MOVE, NUDGE, EDITS };

/* Some id may be missing: then nothing happens. */
static enum dt_status edit(struct dt *t, unsigned kind)
{
    struct dt_point p[20];
    struct dt_added added;
    uint32_t ids[] = {0, 1, 2, 3, 30, 31}, deleted, missing;
    for (uint32_t i = 0; i < 20; i++)
        p[i] = (struct dt_point){0.3 + i % 5, 0.4 + i % 4};
    switch (kind) {
    case ADD:
        return dt_add(t, p, 1, &added);
    case BATCH:
        return dt_add(t, p, 20, &added);
    case DELETE:
        return dt_delete(t, ids, 1, &deleted, &missing);
    case DELETE_MANY:
        return dt_delete(t, ids, 6, &deleted, &missing);
    case MOVE:
        return dt_move(t, 4, (struct dt_point){2, 2});
    default:
        return dt_move(t, 5, (struct dt_point){35 % 8 + 0.001, 25 % 9 * 3 % 7});
    }
}

/* The images that could not be saved in an edit that failed at its n-th allocation. */
struct losses {
    unsigned rows, rings;
};

static void check_view(const struct dt *t, const struct dt_view *v, const struct dt *copy,
                       bool rings, bool may_fail, struct losses *lost)
{
    bool rows_read = check_table(t, v, copy, DT_POINTS), rings_read = rings;
    CHECK(check_table(t, v, copy, DT_COINCIDENT) == rows_read && (rows_read || may_fail));
    for (enum dt_table k = DT_LISTS; rings && k <= DT_HULL; k++) {
        bool read = check_table(t, v, copy, k);
        CHECK(k == DT_LISTS || read == rings_read);
        rings_read = read;
    }
    CHECK((rings_read || !rings || may_fail) && (rows_read || !rings_read));
    lost->rows += !rows_read;
    lost->rings += rows_read && rings && !rings_read;
}

/* A later view has lost nothing. */
static void check_later(struct dt *t)
{
    struct losses none = {0, 0};
    struct dt *copy;
    struct dt_view *v = dt_view_begin(t, true);
    CHECK(v != NULL && dt_clone(t, &copy) == DT_OK);
    for (unsigned kind = ADD; kind <= DELETE; kind++)
        edit(t, kind);
    check_view(t, v, copy, true, false, &none);
    dt_view_end(v);
    dt_free(copy);
}

static bool fail_at(long n, unsigned kind, double tolerance, struct losses *lost)
{
    struct dt *t = lattice(tolerance), *copy;
    struct dt_view *rows = dt_view_begin(t, false), *rings = dt_view_begin(t, true);
    CHECK(rows != NULL && rings != NULL && dt_clone(t, &copy) == DT_OK);
    test_fail_alloc(n);
    enum dt_status s = edit(t, kind);
    bool failed = test_alloc_failed();
    test_fail_alloc(0);
    CHECK(s == DT_OK || (s == DT_NOMEM && failed));
    CHECK(dt_refresh(t, NULL) == DT_OK && dt_check(t, NULL, NULL) == DT_OK);
    check_view(t, rows, copy, false, failed, lost);
    check_view(t, rings, copy, true, failed, lost);
    dt_view_end(rows);
    dt_view_end(rings);
    check_later(t);
    dt_free(copy);
    dt_free(t);
    return failed;
}

TEST(view_without_memory_reports_that_and_edits_continue)
{
    struct losses lost = {0, 0};
    for (unsigned kind = 0; kind < EDITS; kind++)
        for (int tolerance = 0; tolerance < 2; tolerance++)
            for (long n = 1; fail_at(n, kind, 0.5 * tolerance, &lost); n++)
                ;
    CHECK(lost.rows > 0 && lost.rings > 0);
}

TEST(view_that_cannot_begin_for_lack_of_memory_leaves_the_set_as_it_was)
{
    struct dt *t = lattice(0);
    test_fail_alloc(1);
    CHECK(dt_view_begin(t, true) == NULL && test_alloc_failed());
    test_fail_alloc(0);
    check_later(t);
    dt_free(t);
}

/* ---- edits that are left to a rebuild ---- */

TEST(view_of_the_triangulation_is_lost_to_an_edit_that_it_blocks_and_the_rows_are_not)
{
    struct dt *t = lattice(0), *copy;
    struct dt_point p[100];
    struct dt_added added;
    struct losses lost = {0, 0};
    for (uint32_t i = 0; i < 100; i++)
        p[i] = (struct dt_point){i + 0.5, i * i % 17};
    CHECK(dt_clone(t, &copy) == DT_OK && !dt_view_blocks(t, 100));
    struct dt_view *rows = dt_view_begin(t, false), *rings;
    CHECK(rows != NULL && !dt_view_blocks(t, 100));
    rings = dt_view_begin(t, true);
    CHECK(dt_view_blocks(t, 100) && !dt_view_blocks(t, 60));
    CHECK(dt_add(t, p, 100, &added) == DT_OK);
    check_view(t, rings, copy, true, true, &lost);
    CHECK(lost.rings == 1 && lost.rows == 0);
    CHECK(dt_refresh(t, NULL) == DT_OK && !dt_view_blocks(t, 100));
    check_view(t, rings, copy, true, true, &lost);
    check_view(t, rows, copy, false, false, &lost);
    CHECK(lost.rings == 2 && lost.rows == 0);
    check_later(t);
    dt_view_end(rings);
    dt_view_end(rows);
    dt_free(copy);
    dt_free(t);
}

TEST(view_survives_a_rebuild_of_a_triangulation_that_is_current)
{
    struct dt *t = lattice(0.5), *copy;
    struct losses none = {0, 0};
    struct dt_options again = {.rebuild = true};
    CHECK(dt_clone(t, &copy) == DT_OK);
    struct dt_view *v = dt_view_begin(t, true);
    for (unsigned kind = 0; kind < EDITS; kind++) {
        CHECK(dt_triangulate(t, &again) == DT_OK);
        check_view(t, v, copy, true, false, &none);
        edit(t, kind);
        check_view(t, v, copy, true, false, &none);
    }
    dt_view_end(v);
    dt_free(copy);
    dt_free(t);
}

TEST(view_of_a_set_without_triangulation_reads_rows_only)
{
    struct dt *t = dt_new(0);
    struct dt_ids ring = {0}, words;
    struct dt_added added;
    struct dt_point p = {1, 2}, q;
    uint32_t rep;
    bool hull;
    CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    struct dt_view *v = dt_view_begin(t, true);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(read_table(t, v, DT_EDGES, &words) == DT_UNTRIANGULATED);
    free(words.v);
    CHECK(dt_view_ring(t, v, 0, false, &ring, &rep, &hull) == DT_UNTRIANGULATED);
    CHECK(dt_view_get(t, v, 0, &q) == DT_OK && q.x == 1 && q.y == 2);
    CHECK(dt_view_get(t, v, 1, &q) == DT_NOPOINT && dt_view_get(t, NULL, 0, &q) == DT_OK);
    dt_view_end(v);
    v = dt_view_begin(t, true);
    CHECK(dt_view_ring(t, v, 0, false, &ring, &rep, &hull) == DT_OK && hull && rep == 0);
    dt_view_end(v);
    free(ring.v);
    dt_free(t);
}

/* ---- what it costs ---- */

static size_t saved(const struct dt *t)
{
    return dt_views_memory(&t->views);
}

static struct dt_point anywhere(void)
{
    return (struct dt_point){test_uniform(), test_uniform()};
}

/* Half of the edits are moves to anywhere, which are a deletion and an insertion. */
static void edit_randomly(struct dt *t, uint32_t n, uint32_t edits)
{
    struct dt_added added;
    for (uint32_t i = 0; i < edits; i++) {
        uint32_t id = test_below(n), deleted, missing;
        struct dt_point p = anywhere();
        if (i % 4 == 0)
            CHECK(dt_add(t, &p, 1, &added) == DT_OK);
        else if (i % 4 == 1)
            dt_delete(t, &id, 1, &deleted, &missing);
        else
            dt_move(t, id, p);
    }
}

/* About 14 stars of 40 bytes for a move, seven for the others, and the map of them. */
TEST(views_cost_an_edit_a_few_hundred_bytes_however_many_are_open_and_nothing_when_they_have_ended)
{
    enum { POINTS = 60000, STEPS = 6000, VIEWS = 20 };
    struct dt_point *p = malloc(POINTS * sizeof *p);
    struct dt_view *v[VIEWS];
    struct dt_summary sum, after;
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = anywhere();
    struct dt *t = set_of(p, POINTS);
    edit_randomly(t, POINTS, 100);
    CHECK(saved(t) == 0);
    for (uint32_t i = 0; i < VIEWS; i++)
        CHECK((v[i] = dt_view_begin(t, true)) != NULL);
    dt_summary(t, &sum);
    edit_randomly(t, POINTS, STEPS);
    size_t bytes = saved(t);
    CHECK_MSG(bytes > STEPS * 200 && bytes < STEPS * 800, "%zu bytes an edit", bytes / STEPS);
    dt_summary(t, &after);
    CHECK(after.memory >= sum.memory + bytes);
    for (uint32_t i = 0; i < VIEWS; i++)
        dt_view_end(v[i]);
    while (dt_view_tidy(t))
        ;
    CHECK(saved(t) == 0);
    dt_free(t);
    free(p);
}

/* Views follow each other, and one is always open. */
TEST(what_no_view_needs_any_more_is_freed_while_others_are_open)
{
    enum { POINTS = 20000, ROUNDS = 60, STEPS = 300 };
    struct dt_point *p = malloc(POINTS * sizeof *p);
    size_t most = 0;
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = anywhere();
    struct dt *t = set_of(p, POINTS);
    struct dt_view *v = dt_view_begin(t, true);
    for (unsigned round = 0; round < ROUNDS; round++) {
        struct dt_view *next = dt_view_begin(t, true);
        dt_view_end(v);
        v = next;
        edit_randomly(t, POINTS, STEPS);
        while (dt_view_tidy(t))
            ;
        most = saved(t) > most ? saved(t) : most;
    }
    CHECK_MSG(most < 4 * STEPS * 800, "%zu bytes", most);
    dt_view_end(v);
    dt_free(t);
    free(p);
}

/* A view of rows stays open while others read the triangulation and end, or lose it to a rebuild. */
TEST(stars_that_no_view_reads_any_more_are_freed_while_rows_are_read)
{
    enum {
        POINTS = 20000,
        ROUNDS = 20,
        STEPS = 300,
        MAP = 5 * POINTS,
        ROW_BYTES = 100,
        STAR_BYTES = 200
    };
    struct dt_point *p = malloc(POINTS * sizeof *p);
    for (uint32_t i = 0; i < POINTS; i++)
        p[i] = anywhere();
    struct dt *t = set_of(p, POINTS);
    struct dt_view *rows = dt_view_begin(t, false), *v;
    struct dt_added added;
    for (unsigned round = 0; round < ROUNDS; round++) {
        v = dt_view_begin(t, true);
        edit_randomly(t, POINTS, STEPS);
        CHECK(saved(t) > STEPS * STAR_BYTES);
        dt_view_end(v);
        while (dt_view_tidy(t))
            ;
        CHECK_MSG(saved(t) < MAP + (round + 1) * STEPS * ROW_BYTES, "%zu bytes", saved(t));
    }
    v = dt_view_begin(t, true);
    edit_randomly(t, POINTS, ROUNDS * STEPS);
    size_t with_stars = saved(t);
    CHECK(dt_add(t, p, POINTS / 2, &added) == DT_OK && dt_refresh(t, NULL) == DT_OK);
    while (dt_view_tidy(t))
        ;
    CHECK_MSG(saved(t) + 20 * POINTS < with_stars, "%zu of %zu bytes", saved(t), with_stars);
    dt_view_end(v);
    dt_view_end(rows);
    dt_free(t);
    free(p);
}

/* ---- many views ---- */

/* If each begin, end or edit looked at all views, this would take minutes. */
TEST(views_begin_and_end_at_the_same_cost_however_many_there_are)
{
    enum { VIEWS = 100000, KEPT = 10 };
    static struct dt_view *view[VIEWS];
    struct dt *t = lattice(0), *copy = NULL;
    for (uint32_t i = 0; i < VIEWS; i++) {
        if (i == VIEWS - KEPT)
            CHECK(dt_clone(t, &copy) == DT_OK);
        view[i] = dt_view_begin(t, i % 3 != 0);
        CHECK(view[i] != NULL);
        if (i % 10 == 0 && i < VIEWS - KEPT)
            CHECK(dt_move(t, i / 10 % N, (struct dt_point){i % 17, i % 13}) == DT_OK);
    }
    for (uint32_t i = 0, at = 0; i < VIEWS - KEPT;
         i++) { /* in an order unlike that of their beginning */
        at = (at + 61807) % (VIEWS - KEPT);
        dt_view_end(view[at]);
        if (i % 10 == 0)
            CHECK(dt_move(t, i / 10 % N, (struct dt_point){i % 11, i % 19}) == DT_OK);
    }
    for (uint32_t i = VIEWS - KEPT; i < VIEWS; i++) {
        CHECK(check_table(t, view[i], copy, DT_POINTS));
        if (i % 3 != 0)
            CHECK(check_table(t, view[i], copy, DT_LISTS));
        dt_view_end(view[i]);
    }
    while (dt_view_tidy(t))
        ;
    CHECK(dt_views_are_empty(&t->views) && !dt_views_has_any(&t->views));
    dt_free(copy);
    dt_free(t);
}
