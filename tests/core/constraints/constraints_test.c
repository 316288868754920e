/* constraints_test.c - constraints of a set, through the public interface: compared with the definition, with brute
 * force, and with sets that were made in another order. */
#include "core/delaunay_constraints.h"

#include <stdlib.h>
#include <string.h>

#include "tests/oracle/constrained.h"
#include "tests/test.h"

/* ---- sets and graphs ---- */

static uint32_t below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

static void check_mesh(const struct dt *t)
{
    const char *fault = NULL;
    if (dt_check(t, NULL, &fault) != DT_OK)
        CHECK_MSG(false, "%s", fault);
    fault = constrained_fault(t);
    if (fault != NULL)
        CHECK_MSG(false, "%s", fault);
}

static struct dt *set_of(const struct dt_point *p, uint32_t n)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    CHECK(dt_add(t, p, n, &added) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    return t;
}

static enum dt_status constrain_one(struct dt *t, uint32_t a, uint32_t b)
{
    struct dt_constraint c = {a, b, false, 0};
    size_t added;
    uint32_t missing;
    return dt_constrain(t, &c, 1, NULL, &added, &missing);
}

static enum dt_status release_one(struct dt *t, uint32_t a, uint32_t b)
{
    struct dt_constraint c = {a, b, false, 0};
    size_t released, missing;
    return dt_release(t, &c, 1, NULL, &released, &missing);
}

static bool has_edge(const struct dt *t, uint32_t a, uint32_t b)
{
    struct dt_ids out = {0};
    bool there = dt_triangles_at_edge(t, a, b, false, &out) == DT_OK;
    free(out.v);
    return there;
}

/* ---- one constraint ---- */

TEST(a_constraint_becomes_an_edge_and_is_one_no_more_when_it_is_released)
{
    const struct dt_point p[] = {{0, 0}, {10, 1}, {5, 3}, {5, -3}};
    struct dt *t = set_of(p, 4);
    CHECK(!has_edge(t, 0, 1));
    CHECK(constrain_one(t, 0, 1) == DT_OK && has_edge(t, 0, 1));
    check_mesh(t);
    CHECK(release_one(t, 1, 0) == DT_OK && !has_edge(t, 0, 1));
    check_mesh(t);
    CHECK(release_one(t, 1, 0) == DT_NOCONSTRAINT);
    dt_free(t);
}

TEST(a_vertex_on_a_constraint_divides_it_and_joins_it_again_when_it_goes)
{
    const struct dt_point p[] = {{0, 0}, {10, 0}, {5, 3}, {5, -3}};
    struct dt *t = set_of(p, 4);
    struct dt_added added;
    uint32_t deleted, missing, middle;
    CHECK(constrain_one(t, 0, 1) == DT_OK);
    CHECK(dt_add(t, &(struct dt_point){4, 0}, 1, &added) == DT_OK);
    middle = added.first;
    CHECK(has_edge(t, 0, middle) && has_edge(t, middle, 1) && !has_edge(t, 0, 1));
    check_mesh(t);
    CHECK(dt_delete(t, &middle, 1, &deleted, &missing) == DT_OK && has_edge(t, 0, 1));
    check_mesh(t);
    dt_free(t);
}

TEST(constraints_that_cross_are_named_and_nothing_changes)
{
    const struct dt_point p[] = {{0, 0}, {10, 10}, {0, 10}, {10, 0}, {2, 9}, {9, 2}};
    struct dt *t = set_of(p, 6);
    struct dt_crossed crossed;
    CHECK(constrain_one(t, 4, 5) == DT_OK && constrain_one(t, 3, 2) == DT_OK);
    CHECK(constrain_one(t, 1, 0) == DT_CROSSES);
    dt_crossed(t, &crossed);
    CHECK(crossed.one.a == 0 && crossed.one.b == 1 && crossed.other.a == 2 && crossed.other.b == 3);
    CHECK(dt_constraints_count(t) == 2);
    check_mesh(t);
    dt_free(t);
}

TEST(constraints_may_cross_at_a_vertex_which_cannot_go_then)
{
    const struct dt_point p[] = {{0, 0}, {10, 10}, {0, 10}, {10, 0}, {5, 5}};
    struct dt *t = set_of(p, 5);
    uint32_t deleted, missing, middle = 4;
    struct dt_crossed crossed;
    CHECK(constrain_one(t, 0, 1) == DT_OK && constrain_one(t, 2, 3) == DT_OK);
    check_mesh(t);
    CHECK(dt_delete(t, &middle, 1, &deleted, &missing) == DT_CROSSES);
    dt_crossed(t, &crossed);
    CHECK(crossed.one.a == 2 && crossed.one.b == 3 && crossed.other.a == 0 && crossed.other.b == 1);
    CHECK(dt_move(t, middle, (struct dt_point){5, 6}) == DT_CROSSES);
    check_mesh(t);
    CHECK(release_one(t, 0, 1) == DT_OK && dt_delete(t, &middle, 1, &deleted, &missing) == DT_OK);
    check_mesh(t);
    dt_free(t);
}

TEST(the_end_of_a_constraint_is_not_deleted_unless_the_constraint_goes_too)
{
    const struct dt_point p[] = {{0, 0}, {10, 1}, {5, 3}, {5, -3}};
    struct dt *t = set_of(p, 4);
    uint32_t deleted, missing, end = 1;
    CHECK(constrain_one(t, 0, 1) == DT_OK);
    CHECK(dt_delete(t, &end, 1, &deleted, &missing) == DT_CONSTRAINED && missing == 1);
    CHECK(dt_delete_cascade(t, &end, 1, NULL, &deleted, &missing) == DT_OK && deleted == 1);
    CHECK(dt_constraints_count(t) == 0);
    check_mesh(t);
    dt_free(t);
}

TEST(constraints_of_a_set_that_has_not_been_triangulated_are_judged_when_it_is)
{
    const struct dt_point p[] = {{0, 0}, {10, 10}, {0, 10}, {10, 0}};
    struct dt *t = dt_new(0);
    struct dt_added added;
    struct dt_summary sum;
    CHECK(dt_add(t, p, 4, &added) == DT_OK);
    CHECK(constrain_one(t, 0, 1) == DT_OK && constrain_one(t, 2, 3) == DT_OK);
    CHECK(dt_triangulate(t, NULL) == DT_CROSSES);
    dt_summary(t, &sum);
    CHECK(!sum.triangulated && dt_constraints_count(t) == 2);
    CHECK(release_one(t, 2, 3) == DT_OK && dt_triangulate(t, NULL) == DT_OK && has_edge(t, 0, 1));
    check_mesh(t);
    dt_free(t);
}

TEST(constraints_between_invalid_ends_are_refused)
{
    const struct dt_point p[] = {{0, 0}, {1, 0}, {0, 1}};
    struct dt *t = set_of(p, 3);
    size_t added;
    uint32_t missing = 0;
    CHECK(dt_constrain(t, (struct dt_constraint[]){{0, 1, false, 0}, {1, 7, false, 0}}, 2, NULL,
                       &added, &missing) == DT_NOPOINT &&
          missing == 7);
    CHECK(constrain_one(t, 2, 2) == DT_NOEDGE);
    CHECK(dt_constraints_count(t) == 0);
    CHECK(dt_constrain(
              t, (struct dt_constraint[]){{0, 1, false, 5}, {1, 0, true, 5}, {1, 0, false, 5}}, 3,
              NULL, &added, &missing) == DT_OK &&
          added == 2);
    dt_free(t);
}

/* ---- random graphs ---- */

enum { MOST = 64 };

/* A set, and the content that it should have. */
struct model {
    struct dt *t;
    uint32_t width, height;
    uint32_t ids;
    bool live[MOST];
    struct dt_point xy[MOST];
};

static struct dt_point lattice_place(const struct model *m)
{
    return (struct dt_point){below(m->width), below(m->height)};
}

static uint32_t live_id(const struct model *m)
{
    uint32_t id;
    do
        id = below(m->ids);
    while (!m->live[id]);
    return id;
}

static uint32_t live_count(const struct model *m)
{
    uint32_t n = 0;
    for (uint32_t id = 0; id < m->ids; id++)
        n += m->live[id];
    return n;
}

static bool would_cross(const struct model *m, uint32_t a, uint32_t b)
{
    struct dt_constraint *c;
    size_t n;
    bool crosses = false;
    CHECK(dt_constraints(m->t, NULL, DT_NONE, &c, &n) == DT_OK);
    for (size_t i = 0; i < n && !crosses; i++)
        crosses = constraints_cross(m->t, a, b, c[i].a, c[i].b);
    free(c);
    return crosses;
}

static void try_to_add(struct model *m)
{
    struct dt_added added;
    if (m->ids == MOST)
        return;
    m->xy[m->ids] = lattice_place(m);
    CHECK(dt_add(m->t, &m->xy[m->ids], 1, &added) == DT_OK && added.first == m->ids);
    m->live[m->ids++] = true;
}

static void try_to_constrain(struct model *m)
{
    uint32_t a = live_id(m), b = live_id(m);
    if (a == b)
        return;
    struct dt_constraint c = {a, b, below(2) == 0, below(3)};
    size_t added;
    uint32_t missing;
    enum dt_status want = would_cross(m, a, b) ? DT_CROSSES : DT_OK;
    CHECK(dt_constrain(m->t, &c, 1, NULL, &added, &missing) == want);
}

static void try_to_release(struct model *m)
{
    struct dt_constraint *c;
    size_t n, released, missing;
    CHECK(dt_constraints(m->t, NULL, DT_NONE, &c, &n) == DT_OK);
    if (n > 0)
        CHECK(dt_release(m->t, &c[below((uint32_t)n)], 1, NULL, &released, &missing) == DT_OK);
    free(c);
}

static void try_to_delete(struct model *m)
{
    uint32_t id = live_id(m), deleted, missing;
    enum dt_status status = below(4) == 0
                                ? dt_delete_cascade(m->t, &id, 1, NULL, &deleted, &missing)
                                : dt_delete(m->t, &id, 1, &deleted, &missing);
    CHECK(status == DT_OK || status == DT_CROSSES || status == DT_CONSTRAINED);
    m->live[id] = status != DT_OK;
}

static void try_to_move(struct model *m)
{
    uint32_t id = live_id(m), missing;
    struct dt_point to = lattice_place(m);
    enum dt_status status =
        below(2) == 0 ? dt_move(m->t, id, to) : dt_move_many(m->t, &id, &to, 1, NULL, &missing);
    CHECK(status == DT_OK || status == DT_CROSSES);
    if (status == DT_OK)
        m->xy[id] = to;
}

static void try_to_swap(struct model *m)
{
    uint32_t id[2] = {live_id(m), live_id(m)}, missing;
    if (id[0] == id[1])
        return;
    struct dt_point to[2] = {m->xy[id[1]], m->xy[id[0]]};
    enum dt_status status = dt_move_many(m->t, id, to, 2, NULL, &missing);
    CHECK(status == DT_OK || status == DT_CROSSES);
    for (int i = 0; i < 2 && status == DT_OK; i++)
        m->xy[id[i]] = to[i];
}

/* A set with the same points, ids and constraints, triangulated at the end by this engine. */
static struct dt *fresh_set(const struct model *m, enum dt_method method, enum dt_status *status)
{
    struct dt *t = dt_new(0);
    struct dt_added added;
    uint32_t deleted, missing;
    struct dt_constraint *c;
    size_t n, k;
    for (uint32_t id = 0; id < m->ids; id++) {
        struct dt_point p = m->live[id] ? m->xy[id] : (struct dt_point){1e20 + 1e8 * id, -1e20};
        CHECK(dt_add(t, &p, 1, &added) == DT_OK);
    }
    for (uint32_t id = 0; id < m->ids; id++)
        CHECK(m->live[id] || dt_delete(t, &id, 1, &deleted, &missing) == DT_OK);
    CHECK(dt_constraints(m->t, NULL, DT_NONE, &c, &n) == DT_OK);
    CHECK(dt_constrain(t, c, n, NULL, &k, &missing) == DT_OK && k == n);
    free(c);
    *status = dt_triangulate(t, &(struct dt_options){.method = method});
    return t;
}

static void check_same_table(const struct dt *a, const struct dt *b, enum dt_table table)
{
    static uint32_t wa[40 * MOST], wb[40 * MOST];
    struct dt_cursor ca, cb;
    size_t rows, words_a, words_b;
    CHECK(dt_table_begin(a, NULL, table, false, &ca) == DT_OK);
    CHECK(dt_table_begin(b, NULL, table, false, &cb) == DT_OK);
    CHECK(dt_table_read(a, &ca, wa, 40 * MOST, SIZE_MAX, &rows, &words_a) == DT_OK);
    CHECK(dt_table_read(b, &cb, wb, 40 * MOST, SIZE_MAX, &rows, &words_b) == DT_OK);
    CHECK(words_a == words_b && memcmp(wa, wb, words_a * sizeof *wa) == 0);
}

static void check_canonical(const struct model *m)
{
    for (enum dt_method method = DT_AUTO; method <= DT_SHELLING; method++) {
        enum dt_status status;
        struct dt *fresh = fresh_set(m, method, &status);
        CHECK(status == DT_OK);
        for (enum dt_table table = DT_POINTS; table <= DT_HULL; table++)
            check_same_table(m->t, fresh, table);
        dt_free(fresh);
    }
}

/* LOCATE of every place between lattice points, by the triangles. */
static void check_places(const struct model *m)
{
    struct dt_location at;
    for (int k = 0; k < 8; k++) {
        struct dt_point q = {below(2 * m->width) * 0.5 - 0.25, below(2 * m->height) * 0.5};
        struct dt_ids box = {0};
        CHECK(dt_locate(m->t, q, &at) == DT_OK);
        CHECK(dt_within_triangles(m->t, q, q, false, NULL, &box) == DT_OK);
        CHECK((box.n == 0) == (at.where == DT_OUTSIDE) || at.where == DT_ON_EDGE ||
              at.where == DT_ON_VERTEX);
        if (at.where == DT_INSIDE)
            CHECK(box.n == 3 && memcmp(box.v, at.id, sizeof at.id) == 0);
        free(box.v);
    }
}

/* A random set's k nearest and the points in a disc, compared with a look at all. */
static int nearer(const struct model *m, struct dt_point q, uint32_t a, uint32_t b)
{
    double ax = m->xy[a].x - q.x, ay = m->xy[a].y - q.y, bx = m->xy[b].x - q.x,
           by = m->xy[b].y - q.y;
    double da = ax * ax + ay * ay, db = bx * bx + by * by;
    return da != db ? da < db : a < b;
}

static bool is_vertex(const struct model *m, uint32_t id)
{
    uint32_t rep;
    return m->live[id] && dt_representative(m->t, id, &rep) == DT_OK && rep == id;
}

static void check_nearest(const struct model *m, const struct dt_view *v)
{
    struct dt_point q = {below(2 * m->width + 8) * 0.5 - 2, below(2 * m->height + 8) * 0.5 - 2};
    uint32_t k = 1 + below(6), want[MOST], n = 0, many[8];
    struct dt_ids got = {0};
    size_t done;
    for (uint32_t id = 0; id < m->ids; id++) {
        uint32_t i = n;
        if (!is_vertex(m, id))
            continue;
        for (n++; i > 0 && nearer(m, q, id, want[i - 1]); i--)
            want[i] = want[i - 1];
        want[i] = id;
    }
    n = n < k ? n : k;
    CHECK(dt_nearest(m->t, q, k, &got) == DT_OK && got.n == n);
    CHECK(n == 0 || memcmp(got.v, want, n * sizeof *want) == 0);
    free(got.v);
    CHECK(dt_nearest_many(m->t, v, &q, 1, k, NULL, many, &done) == DT_OK && done == 1);
    CHECK(n == 0 || memcmp(many, want, n * sizeof *want) == 0);
}

static void check_within(const struct model *m)
{
    struct dt_point q = {below(2 * m->width + 8) * 0.5 - 2, below(2 * m->height + 8) * 0.5 - 2};
    double r = below(8) * 0.5;
    uint32_t n = 0;
    struct dt_ids got = {0};
    CHECK(dt_within_disc(m->t, q, r, NULL, &got) == DT_OK);
    for (uint32_t id = 0; id < m->ids; id++) {
        double x = m->xy[id].x - q.x, y = m->xy[id].y - q.y;
        if (is_vertex(m, id) && x * x + y * y <= r * r)
            CHECK(n < got.n && got.v[n++] == id);
    }
    CHECK(n == got.n);
    free(got.v);
}

/* ---- earlier moments ---- */

/* A view, and a copy made when it began. */
struct moment {
    struct dt_view *view;
    struct dt *copy;
};

static void check_same_constraints(const struct dt *t, const struct moment *m, uint32_t id)
{
    struct dt_constraint *got, *want;
    size_t n, k;
    CHECK(dt_constraints(t, m->view, id, &got, &n) == DT_OK);
    CHECK(dt_constraints(m->copy, NULL, id, &want, &k) == DT_OK && n == k);
    for (size_t i = 0; i < n; i++)
        CHECK(got[i].a == want[i].a && got[i].b == want[i].b && got[i].border == want[i].border &&
              got[i].number == want[i].number);
    free(got);
    free(want);
}

static void check_same_places(const struct dt *t, const struct moment *m, struct dt_point q)
{
    uint32_t got[4], want[4];
    size_t done;
    CHECK(dt_locate_many(t, m->view, &q, 1, NULL, got, &done) == DT_OK);
    CHECK(dt_locate_many(m->copy, NULL, &q, 1, NULL, want, &done) == DT_OK);
    CHECK(memcmp(got, want, 3 * sizeof *got) == 0);
    CHECK(dt_nearest_many(t, m->view, &q, 1, 4, NULL, got, &done) == DT_OK);
    CHECK(dt_nearest_many(m->copy, NULL, &q, 1, 4, NULL, want, &done) == DT_OK);
    CHECK(memcmp(got, want, sizeof got) == 0);
}

/* The view of t sees the content of the copy. */
static void check_moment(const struct model *m, const struct moment *then)
{
    static uint32_t a[40 * MOST], b[40 * MOST];
    size_t rows, words_a, words_b;
    for (enum dt_table table = DT_POINTS; table <= DT_HULL; table++) {
        struct dt_cursor ca, cb;
        CHECK(dt_table_begin(m->t, then->view, table, false, &ca) == DT_OK);
        CHECK(dt_table_begin(then->copy, NULL, table, false, &cb) == DT_OK);
        CHECK(dt_table_read(m->t, &ca, a, 40 * MOST, SIZE_MAX, &rows, &words_a) == DT_OK);
        CHECK(dt_table_read(then->copy, &cb, b, 40 * MOST, SIZE_MAX, &rows, &words_b) == DT_OK);
        CHECK(words_a == words_b && memcmp(a, b, words_a * sizeof *a) == 0);
    }
    check_same_constraints(m->t, then, DT_NONE);
    check_same_constraints(m->t, then, below(m->ids));
    check_same_places(m->t, then, (struct dt_point){below(m->width), below(m->height)});
}

static void end_moment(struct moment *m)
{
    dt_view_end(m->view);
    dt_free(m->copy);
}

static void begin_moment(struct model *m, struct moment *then)
{
    then->view = dt_view_begin(m->t, true);
    CHECK(then->view != NULL && dt_clone(m->t, &then->copy) == DT_OK);
}

static void step(struct model *m)
{
    void (*const kinds[])(struct model *) = {try_to_add,       try_to_add,       try_to_constrain,
                                             try_to_constrain, try_to_constrain, try_to_release,
                                             try_to_delete,    try_to_move,      try_to_swap};
    if (live_count(m) < 3)
        try_to_add(m);
    else
        kinds[below(sizeof kinds / sizeof *kinds)](m);
}

static void run_history(uint32_t steps)
{
    struct model m = {.t = dt_new(0), .width = 2 + below(5), .height = 1 + below(5)};
    CHECK(dt_triangulate(m.t, NULL) == DT_OK);
    for (uint32_t i = 0; i < steps; i++) {
        step(&m);
        check_mesh(m.t);
        check_places(&m);
        check_nearest(&m, NULL);
        check_within(&m);
    }
    check_canonical(&m);
    dt_free(m.t);
}

TEST(views_have_the_constraints_and_the_triangulation_of_their_moment)
{
    for (int history = 0; history < 100; history++) {
        struct model m = {.t = dt_new(0), .width = 2 + below(5), .height = 1 + below(5)};
        struct moment then[3];
        CHECK(dt_triangulate(m.t, NULL) == DT_OK);
        for (int i = 0; i < 6; i++)
            try_to_add(&m);
        for (int i = 0; i < 3; i++)
            begin_moment(&m, &then[i]);
        for (int i = 0; i < 40; i++) {
            step(&m);
            if (below(4) == 0)
                CHECK(dt_triangulate(m.t, &(struct dt_options){.rebuild = true}) == DT_OK);
            for (int k = 0; k < 3; k++)
                check_moment(&m, &then[k]);
            struct moment *again = &then[below(3)];
            end_moment(again);
            begin_moment(&m, again);
        }
        for (int i = 0; i < 3; i++)
            end_moment(&then[i]);
        dt_free(m.t);
    }
}

/* With a tolerance: representatives depend on the history, constraints stand between them. */
TEST(constraints_between_aliases_follow_their_representatives)
{
    for (int history = 0; history < 50; history++) {
        struct model m = {.t = dt_new(0.4), .width = 3 + below(5), .height = 3 + below(4)};
        CHECK(dt_triangulate(m.t, NULL) == DT_OK);
        for (int i = 0; i < 60; i++) {
            step(&m);
            uint32_t id = live_id(&m);
            struct dt_point to = {m.xy[id].x + below(3) * 0.25 - 0.25,
                                  m.xy[id].y + below(3) * 0.25 - 0.25};
            enum dt_status status = dt_move(m.t, id, to);
            CHECK(status == DT_OK || status == DT_CROSSES);
            m.xy[id] = status == DT_OK ? to : m.xy[id];
            check_mesh(m.t);
            struct dt *copy;
            CHECK(dt_clone(m.t, &copy) == DT_OK);
            check_same_table(m.t, copy, DT_TRIANGLES);
            check_same_table(m.t, copy, DT_COINCIDENT);
            dt_free(copy);
        }
        dt_free(m.t);
    }
}

TEST(constraints_take_at_most_40_bytes_each_and_no_more_than_was_estimated)
{
    enum { N = 100000 };
    struct dt *t = dt_new(0);
    struct dt_point *p = malloc(N * sizeof *p);
    struct dt_constraint *c = malloc(N * sizeof *c);
    struct dt_added got;
    struct dt_summary before, after;
    size_t added;
    uint32_t missing;
    for (uint32_t i = 0; i < N; i++) {
        p[i] = (struct dt_point){i, (double)(i % 100 * i % 7)};
        c[i] = (struct dt_constraint){i, i + 1, false, i};
    }
    CHECK(dt_add(t, p, N, &got) == DT_OK && dt_triangulate(t, NULL) == DT_OK);
    for (uint32_t i = 0; i < 3; i++) /* the mesh gets room for edits */
        CHECK(dt_add(t, &(struct dt_point){i + 0.5, 9}, 1, &got) == DT_OK);
    CHECK(constrain_one(t, 0, 500) == DT_OK && release_one(t, 0, 500) == DT_OK);
    dt_summary(t, &before);
    size_t estimate = dt_constrain_memory(t, N - 1);
    CHECK(dt_constrain(t, c, N - 1, NULL, &added, &missing) == DT_OK && added == N - 1);
    dt_summary(t, &after);
    CHECK(after.memory - before.memory <= 40 * (size_t)N + 65536);
    CHECK(after.memory - before.memory <= estimate);
    CHECK(dt_check(t, NULL, NULL) == DT_OK);
    dt_free(t);
    free(p);
    free(c);
}

TEST(an_edit_of_constraints_beyond_its_limit_changes_nothing)
{
    for (int history = 0; history < 40; history++) {
        struct model m = {.t = dt_new(0), .width = 6, .height = 6};
        CHECK(dt_triangulate(m.t, NULL) == DT_OK);
        for (int i = 0; i < 30; i++)
            try_to_add(&m);
        for (int i = 0; i < 20; i++) {
            struct dt_constraint c[3];
            size_t added, before = dt_constraints_count(m.t);
            uint32_t missing;
            for (int k = 0; k < 3; k++) {
                c[k] = (struct dt_constraint){live_id(&m), 0, false, 0};
                do
                    c[k].b = live_id(&m);
                while (c[k].b == c[k].a);
            }
            struct dt_options few = {.steps = 1 + below(12)};
            enum dt_status status = dt_constrain(m.t, c, 3, &few, &added, &missing);
            CHECK(status == DT_OK || status == DT_TOOLONG || status == DT_CROSSES);
            CHECK(status == DT_OK || dt_constraints_count(m.t) == before);
            check_mesh(m.t);
        }
        dt_free(m.t);
    }
}

TEST(random_graphs_on_lattices_are_the_constrained_delaunay_triangulation_whatever_their_history)
{
    for (int i = 0; i < 150; i++)
        run_history(20 + below(60));
}
