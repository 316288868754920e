/* view_tables_test.c - tables and rings at the moment of a view equal those of a copy made at that moment. Edits between
 * the pieces that are read, and other readers, make no difference. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/core/sets.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { VIEWS = 5, PARTS = 40, TABLES = 6 };

/* Reads a piece of up to `room` words and max_rows rows, or one row if that does not fit; false at
 * the end. */
static bool read_piece(const struct dt *t, struct dt_cursor *c, size_t room, size_t max_rows,
                       struct dt_ids *out)
{
    size_t rows, words;
    uint32_t *buffer = malloc((room + 1) * sizeof *buffer);
    enum dt_status s = dt_table_read(t, c, buffer, room, max_rows, &rows, &words);
    if (s == DT_TOOSMALL) {
        room = words;
        buffer = realloc(buffer, room * sizeof *buffer);
        s = dt_table_read(t, c, buffer, room, 1, &rows, &words);
    }
    CHECK_MSG(s == DT_OK, "status %d", s);
    append_ids(out, buffer, words);
    free(buffer);
    return rows > 0;
}

/* ---- one reader: a view, a copy, and a table on its way ---- */

struct reader {
    struct dt_view *view;
    struct dt *copy;
    bool busy; /* with a table: */
    bool cw, all_cut;
    struct dt_cursor whole; /* what has not been cut into parts yet */
    unsigned parts;
    struct dt_cursor part[PARTS];
    bool done[PARTS];
    struct dt_ids out[PARTS + 1]; /* of the whole before it was cut, and of the parts */
};

static void reader_begin(struct reader *r, struct dt *t)
{
    memset(r, 0, sizeof *r);
    r->view = dt_view_begin(t, true);
    CHECK(r->view != NULL && dt_clone(t, &r->copy) == DT_OK);
}

static void reader_end(struct reader *r)
{
    dt_view_end(r->view);
    dt_free(r->copy);
    for (unsigned i = 0; i <= PARTS; i++)
        free(r->out[i].v);
    memset(r, 0, sizeof *r);
}

static void table_begin(struct reader *r, const struct dt *t, enum dt_table table)
{
    struct dt_cursor want;
    r->busy = true;
    r->cw = test_below(2);
    r->all_cut = false;
    r->parts = 0;
    CHECK(dt_table_begin(t, r->view, table, r->cw, &r->whole) == DT_OK);
    CHECK(dt_table_begin(r->copy, NULL, table, r->cw, &want) == DT_OK);
    CHECK(r->whole.rows == want.rows && r->whole.interior == want.interior);
}

/* All parts have been read: compared with the table of the copy. */
static void table_end(struct reader *r)
{
    struct dt_ids want = {0}, got = {0};
    struct dt_cursor c;
    CHECK(dt_table_begin(r->copy, NULL, r->whole.table, r->cw, &c) == DT_OK);
    while (read_piece(r->copy, &c, 1000, 1000, &want))
        ;
    for (unsigned i = 0; i <= r->parts; i++) {
        append_ids(&got, r->out[i].v, r->out[i].n);
        r->out[i].n = 0;
    }
    check_equal_ids(table_names[r->whole.table], &got, &want);
    free(want.v);
    free(got.v);
    r->busy = false;
}

static void table_step(struct reader *r, const struct dt *t, uint32_t size)
{
    size_t room = test_below(4) == 0 ? 4096 : test_below(60), rows = 1 + test_below(size);
    if (r->parts == 0 && !r->all_cut && test_below(3) > 0) {
        if (!read_piece(t, &r->whole, room, rows, &r->out[0]))
            table_end(r);
        return;
    }
    if (!r->all_cut && (r->parts == 0 || test_below(2))) {
        uint32_t ids = r->parts + 2 >= PARTS ? 1000000 : test_below(2 * size);
        r->all_cut = !dt_table_cut(t, &r->whole, ids, &r->part[r->parts]);
        r->done[r->parts] = false;
        r->parts += !r->all_cut;
        return;
    }
    unsigned open = 0, i = 0;
    for (unsigned k = 0; k < r->parts; k++)
        open += !r->done[k];
    if (open == 0) {
        if (r->all_cut)
            table_end(r);
        return;
    }
    for (unsigned k = test_below(open); r->done[i] || k-- > 0; i++)
        ;
    r->done[i] = !read_piece(t, &r->part[i], room, rows, &r->out[i + 1]);
}

static void check_one_id(const struct reader *r, const struct dt *t)
{
    struct dt_ids got = {0}, want = {0};
    struct dt_point p = {0, 0}, q = {0, 0};
    uint32_t id = test_below(dt_next_id(t) + 1), rep_got = 0, rep_want = 0;
    bool cw = test_below(2), on_hull_got = false, on_hull_want = false;
    enum dt_status status = dt_get(r->copy, id, &p);
    CHECK(dt_view_get(t, r->view, id, &q) == status && p.x == q.x && p.y == q.y);
    status = dt_ring(r->copy, id, cw, &want, &rep_want, &on_hull_want);
    CHECK(dt_view_ring(t, r->view, id, cw, &got, &rep_got, &on_hull_got) == status);
    CHECK(rep_got == rep_want && on_hull_got == on_hull_want);
    check_equal_ids("ring", &got, &want);
    free(got.v);
    free(want.v);
}

static void check_rows(const struct reader *r, const struct dt *t)
{
    struct dt_row row[7];
    struct dt_point p;
    uint32_t from = 0, rep, total = 0;
    struct dt_summary then, want;
    size_t n = 7;
    while (n == 7) {
        CHECK(dt_view_rows(t, r->view, &from, row, 7, &n) == DT_OK);
        for (size_t i = 0; i < n; i++) {
            CHECK(dt_get(r->copy, row[i].id, &p) == DT_OK && p.x == row[i].at.x &&
                  p.y == row[i].at.y);
            CHECK(dt_representative(r->copy, row[i].id, &rep) == DT_OK &&
                  rep == row[i].representative);
        }
        total += (uint32_t)n;
    }
    dt_view_summary(r->view, &then);
    dt_summary(r->copy, &want);
    then.memory = want.memory;
    CHECK(total == want.points && then.points == want.points && then.edges == want.edges &&
          then.hull == want.hull && dt_view_next_id(r->view) == dt_next_id(r->copy));
}

/* ---- edits ---- */

struct world {
    struct dt *t;
    struct reader reader[VIEWS];
    const struct dt_point *p; /* of the family */
    uint32_t n;
};

static double valid(double v)
{
    return dt_coordinate_ok(v) ? v : 0;
}

/* Often one where a point was, or on the line of two of them. */
static struct dt_point some_place(const struct world *w)
{
    if (w->n == 0)
        return (struct dt_point){test_below(3), test_below(3)};
    struct dt_point a = w->p[test_below(w->n)], b = w->p[test_below(w->n)];
    double u = test_uniform();
    switch (test_below(6)) {
    case 0:
    case 1:
        return a;
    case 2:
        return (struct dt_point){valid(a.x / 2 + b.x / 2), valid(a.y / 2 + b.y / 2)};
    case 3:
        return (struct dt_point){valid(2 * a.x - b.x), valid(2 * a.y - b.y)};
    case 4:
        return (struct dt_point){a.x, b.y};
    }
    return (struct dt_point){valid(a.x + (b.x - a.x) * u), valid(a.y + (b.y - a.y) * u)};
}

/* A live id, often one on the hull; DT_NONE: there is none. */
static uint32_t some_id(const struct world *w)
{
    uint32_t id[400];
    size_t rows, words;
    struct dt_cursor c;
    enum dt_table table = test_below(3) == 0 ? DT_HULL : DT_POINTS;
    CHECK(dt_table_begin(w->t, NULL, table, false, &c) == DT_OK);
    CHECK(dt_table_read(w->t, &c, id, 400, 400, &rows, &words) == DT_OK);
    return rows == 0 ? DT_NONE : id[test_below((uint32_t)rows)];
}

/* Sometimes few steps are allowed, after which the edit is undone. */
static struct dt_options some_limit(void)
{
    return (struct dt_options){.steps = test_below(5) == 0 ? 1 + test_below(200) : 0};
}

static void check_status(enum dt_status status, const struct dt_options *opt)
{
    CHECK(status == DT_OK || (status == DT_TOOLONG && opt->steps > 0));
}

static void add(const struct world *w, uint32_t n)
{
    struct dt_options opt = some_limit();
    struct dt_point p[64];
    struct dt_added added;
    for (uint32_t i = 0; i < n; i++)
        p[i] = some_place(w);
    check_status(dt_add_many(w->t, p, n, &opt, &added), &opt);
}

static void delete (const struct world *w, uint32_t n)
{
    struct dt_options opt = some_limit();
    uint32_t ids[64], k = 0, deleted, missing;
    for (uint32_t i = 0; i < n; i++) {
        ids[k] = some_id(w);
        k += ids[k] != DT_NONE;
    }
    check_status(dt_delete_many(w->t, ids, k, &opt, &deleted, &missing), &opt);
}

static void move(const struct world *w, bool slightly)
{
    struct dt_options opt = some_limit();
    uint32_t id = some_id(w);
    struct dt_point p, to = some_place(w);
    if (id == DT_NONE)
        return;
    CHECK(dt_get(w->t, id, &p) == DT_OK);
    if (slightly)
        to = (struct dt_point){valid(nextafter(p.x, to.x)), valid(p.y + (to.y - p.y) * 1e-3)};
    check_status(dt_move_to(w->t, id, to, &opt), &opt);
}

static void edit(const struct world *w)
{
    struct dt_options again = {.rebuild = true};
    struct dt_summary sum;
    uint32_t kind = test_below(40);
    dt_summary(w->t, &sum);
    if (sum.points > w->n + 250 || kind == 0)
        delete (w, 60); /* often all of them */
    else if (kind < 14)
        add(w, 1);
    else if (kind < 15)
        add(w, test_below(64));
    else if (kind < 28)
        delete (w, 1 + test_below(test_below(2) ? 2 : 40));
    else if (kind < 39)
        move(w, test_below(2));
    else
        CHECK(dt_triangulate(w->t, &again) == DT_OK); /* other vertices; the same triangulation */
}

/* Lookups of places are equal to those in the copy, which lookup_test compares with brute force. */
static void check_places(const struct world *w, const struct reader *r)
{
    enum { PLACES = 40, MOST = 9 };
    struct dt_point p[PLACES];
    uint32_t got[PLACES * MOST], want[PLACES * MOST], k = 1 + test_below(MOST);
    size_t done;
    for (unsigned i = 0; i < PLACES; i++)
        p[i] = some_place(w);
    CHECK(dt_locate_many(r->copy, NULL, p, PLACES, NULL, want, &done) == DT_OK && done == PLACES);
    CHECK(dt_locate_many(w->t, r->view, p, PLACES, NULL, got, &done) == DT_OK && done == PLACES);
    check_equal_ids("triangles", &(struct dt_ids){got, 3 * PLACES, 0},
                    &(struct dt_ids){want, 3 * PLACES, 0});
    CHECK(dt_nearest_many(r->copy, NULL, p, PLACES, k, NULL, want, &done) == DT_OK);
    CHECK(dt_nearest_many(w->t, r->view, p, PLACES, k, NULL, got, &done) == DT_OK);
    check_equal_ids("nearest", &(struct dt_ids){got, (size_t)k * PLACES, 0},
                    &(struct dt_ids){want, (size_t)k * PLACES, 0});
}

/* ---- histories ---- */

static void step(struct world *w)
{
    struct reader *r = &w->reader[test_below(VIEWS)];
    uint32_t kind = test_below(60);
    if (kind < 20) {
        edit(w);
    } else if (r->view == NULL) {
        if (kind < 30)
            reader_begin(r, w->t);
    } else if (kind == 20) {
        reader_end(r); /* even if it has not read all */
    } else if (kind == 21) {
        check_rows(r, w->t);
    } else if (kind < 26) {
        check_one_id(r, w->t);
    } else if (kind < 28) {
        check_places(w, r);
    } else if (!r->busy) {
        table_begin(r, w->t, (enum dt_table)test_below(TABLES));
    } else {
        table_step(r, w->t, 20 + w->n / 3);
    }
}

static void run(struct world *w, unsigned steps)
{
    CHECK(dt_triangulate(w->t, NULL) == DT_OK);
    memset(w->reader, 0, sizeof w->reader);
    for (unsigned i = 0; i < steps; i++)
        step(w);
    for (unsigned i = 0; i < VIEWS; i++) {
        struct reader *r = &w->reader[i];
        while (r->view != NULL && r->busy)
            table_step(r, w->t, 50 + w->n / 3);
        if (r->view != NULL)
            reader_end(r);
    }
    while (dt_view_tidy(w->t))
        ;
    CHECK(dt_check(w->t, NULL, NULL) == DT_OK);
}

static struct dt *set_with(double tolerance, const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(tolerance);
    struct dt_added added;
    CHECK(t != NULL && dt_add(t, p, n, &added) == DT_OK);
    return t;
}

TEST_TIMEOUT(view_has_the_tables_of_a_copy_after_any_edits_on_every_family, 60)
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 5, 8, 15, 40};
    struct dt_point p[64];
    for (const struct family *f = families; f->name != NULL; f++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            family_points(f, p, sizes[i], test_random());
            struct world w = {.t = set_with(0, p, sizes[i]), .p = p, .n = sizes[i]};
            run(&w, 300);
            dt_free(w.t);
        }
    }
}

/* On a lattice points coincide; with a tolerance families unite. */
TEST_TIMEOUT(view_has_the_tables_of_a_copy_where_points_coincide_within_a_tolerance, 60)
{
    static const double tolerance[] = {0, 0.5, 1, 1.5};
    struct dt_point p[50];
    for (unsigned round = 0; round < 120; round++) {
        uint32_t width = 1 + test_below(6), height = 1 + test_below(6), n = test_below(50);
        for (uint32_t i = 0; i < n; i++)
            p[i] = (struct dt_point){test_below(width), test_below(height)};
        struct world w = {.t = set_with(tolerance[round % 4], p, n), .p = p, .n = n};
        run(&w, 1000);
        dt_free(w.t);
    }
}

/* All tables at once, in pieces of up to `rows` rows. */
static void check_all(struct reader *r, const struct dt *t, size_t rows)
{
    for (uint32_t k = 0; k < 2 * TABLES; k++) {
        struct dt_ids got = {0}, want = {0};
        struct dt_cursor c;
        CHECK(dt_table_begin(t, r->view, (enum dt_table)(k / 2), k % 2, &c) == DT_OK);
        while (read_piece(t, &c, 4096, rows, &got))
            ;
        CHECK(dt_table_begin(r->copy, NULL, (enum dt_table)(k / 2), k % 2, &c) == DT_OK);
        while (read_piece(r->copy, &c, 4096, 4096, &want))
            ;
        check_equal_ids(table_names[k / 2], &got, &want);
        free(got.v);
        free(want.v);
    }
}

/* A wheel around a hub, or half of one, so that the hub is on the hull; then points far away. */
static uint32_t fill_wheel(struct dt_point *p, uint32_t rim, uint32_t hub, bool half,
                           uint32_t others)
{
    double turn = half ? 3.0 : 6.283185307179586;
    uint32_t n = 0;
    for (uint32_t i = 0; i <= rim; i++)
        p[n++] = i == hub ? (struct dt_point){0, 0}
                          : (struct dt_point){cos(i * turn / rim), sin(i * turn / rim)};
    for (uint32_t i = 0; i < others; i++)
        p[n++] = (struct dt_point){3 * test_uniform(), 100 + test_uniform()};
    return n;
}

static const uint32_t rims[] = {30, 60, 250};

TEST_TIMEOUT(view_has_the_tables_of_a_copy_where_points_have_many_neighbours, 60)
{
    struct dt_point p[900];
    for (unsigned round = 0; round < 24; round++) {
        uint32_t rim = rims[round % 3], hub = test_below(test_below(2) ? 2 : rim);
        uint32_t n = fill_wheel(p, rim, hub, round / 3 % 2, round / 6 % 2 * 600);
        struct world w = {.t = set_with(0, p, n), .p = p, .n = n};
        run(&w, 1500);
        dt_free(w.t);
    }
}

/* The hub loses a neighbour and gets others, goes, and another point takes its place. */
static void check_hub(const struct dt_point *p, uint32_t n, uint32_t hub)
{
    struct reader r[4];
    struct dt_added added;
    uint32_t near = hub + 1, deleted, missing;
    struct dt *t = set_with(0, p, n);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    reader_begin(&r[0], t);
    CHECK(dt_delete(t, &near, 1, &deleted, &missing) == DT_OK);
    reader_begin(&r[1], t);
    CHECK(dt_add(t, &(struct dt_point){0.01, 0.02}, 1, &added) == DT_OK);
    reader_begin(&r[2], t);
    CHECK(dt_delete(t, &hub, 1, &deleted, &missing) == DT_OK);
    reader_begin(&r[3], t);
    CHECK(dt_add(t, &(struct dt_point){0, 0}, 1, &added) == DT_OK);
    for (uint32_t i = 0; i < 4; i++) {
        check_all(&r[i], t, 4096);
        check_all(&r[i], t, 7);
        reader_end(&r[i]);
    }
    dt_free(t);
}

TEST_TIMEOUT(view_has_the_star_of_a_hub_that_has_changed_since, 60)
{
    struct dt_point p[900];
    for (unsigned round = 0; round < 36; round++) {
        uint32_t rim = rims[round % 3], hub = round / 12 * (rim / 2 - 1);
        uint32_t n = fill_wheel(p, rim, hub, round / 3 % 2, round / 6 % 2 * 600);
        check_hub(p, n, hub);
    }
}
