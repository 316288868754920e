/* edit_fuzz.c - libFuzzer target: any bytes as a history of edits of a live set on a small lattice.
 * After every step the set's triangulation is checked. Every table and query must have the same result as for a
 * fresh set with the same points and ids. Views that began some steps ago must have the tables of
 * copies that were made at that moment.
 *
 * The first byte chooses tolerance and scale, the second the lattice; steps follow: an opcode and its
 * arguments. Missing bytes at the end read as 0. */
#include <stdlib.h>
#include <string.h>

#include "core/delaunay_constraints.h"

enum { MAX_INPUT = 24, MAX_IDS = 400, MAX_LIVE = 90, WORDS = 4096, MOMENTS = 3 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A state of the set, and a copy made in that state. */
struct moment {
    struct dt_view *view; /* NULL: none */
    struct dt *copy;
    bool rings;   /* it reads the triangulation */
    bool blocked; /* the view blocked an edit */
};

/* The script, and the expected content of the set. */
struct script {
    const uint8_t *at, *end;
    struct dt *set;
    double scale;
    uint32_t width, height; /* lattice points */
    uint32_t ids, live;
    bool is_live[MAX_IDS];
    struct dt_point xy[MAX_IDS];
    struct moment moment[MOMENTS];
};

static void require(bool ok)
{
    if (!ok)
        abort();
}

static uint32_t byte(struct script *s)
{
    return s->at < s->end ? *s->at++ : 0;
}

/* A place on the lattice, or half way between its points. */
static struct dt_point place(const struct script *s, uint32_t column, uint32_t row, bool half)
{
    double off = half ? 0.5 : 0;
    return (struct dt_point){(column % s->width + off) * s->scale,
                             (row % s->height + off) * s->scale};
}

static struct dt_point read_place(struct script *s)
{
    uint32_t b = byte(s);
    return place(s, b & 15, b >> 4, false);
}

/* The k-th live id, modulo their number; there must be one. */
static uint32_t live_id(const struct script *s, uint32_t k)
{
    uint32_t id = 0;
    for (k %= s->live;; id++)
        if (s->is_live[id] && k-- == 0)
            return id;
}

/* ---- a fresh set ---- */

/* Without a tolerance the smallest id at a place represents it; with one, the representative depends on
 * the history, so it is read from the set. */
static uint32_t representative(const struct script *s, uint32_t id)
{
    uint32_t rep = 0, known;
    require(dt_representative(s->set, id, &known) == DT_OK && s->is_live[known]);
    if (dt_tolerance(s->set) > 0)
        return known;
    while (!s->is_live[rep] || s->xy[rep].x != s->xy[id].x || s->xy[rep].y != s->xy[id].y)
        rep++;
    require(rep == known);
    return rep;
}

static void copy_constraints(const struct dt *from, struct dt *to)
{
    struct dt_constraint *c;
    size_t n, added;
    uint32_t missing;
    require(dt_constraints(from, NULL, DT_NONE, &c, &n) == DT_OK);
    require(dt_constrain(to, c, n, NULL, &added, &missing) == DT_OK && added == n);
    free(c);
}

static struct dt *fresh_set(const struct script *s, enum dt_method method)
{
    static uint32_t ids[MAX_IDS], reps[MAX_IDS];
    static struct dt_point xy[MAX_IDS];
    uint32_t n = 0;
    struct dt *fresh = dt_new(dt_tolerance(s->set));
    struct dt_options opt = {.method = method};
    for (uint32_t id = 0; id < s->ids; id++) {
        if (!s->is_live[id])
            continue;
        ids[n] = id;
        xy[n] = s->xy[id];
        reps[n++] = representative(s, id);
    }
    require(fresh != NULL && n == s->live && dt_next_id(s->set) == s->ids);
    require(dt_restore(fresh, ids, xy, reps, n, s->ids, NULL) == DT_OK);
    copy_constraints(s->set, fresh);
    require(dt_triangulate(fresh, &opt) == DT_OK);
    return fresh;
}

/* ---- comparison ---- */

static void compare_table(const struct dt *a, const struct dt *b, enum dt_table table, bool cw)
{
    static uint32_t wa[WORDS], wb[WORDS];
    size_t rows_a, rows_b, words_a, words_b;
    struct dt_cursor ca, cb;
    require(dt_table_begin(a, NULL, table, cw, &ca) == DT_OK);
    require(dt_table_begin(b, NULL, table, cw, &cb) == DT_OK);
    require(ca.rows == cb.rows && ca.interior == cb.interior);
    require(dt_table_read(a, &ca, wa, WORDS, WORDS, &rows_a, &words_a) == DT_OK);
    require(dt_table_read(b, &cb, wb, WORDS, WORDS, &rows_b, &words_b) == DT_OK);
    require(rows_a == ca.rows && rows_b == rows_a && words_a == words_b);
    require(memcmp(wa, wb, words_a * sizeof *wa) == 0);
}

static void compare_moment(const struct dt *set, const struct moment *m, enum dt_table table,
                           bool cw)
{
    static uint32_t got[WORDS], want[WORDS];
    size_t rows_got, rows_want, words_got, words_want;
    struct dt_cursor a, b;
    enum dt_status status = dt_table_begin(set, m->view, table, cw, &a);
    if (table > DT_COINCIDENT && !m->rings)
        require(status == DT_UNTRIANGULATED);
    else
        require(status == DT_OK || (status == DT_NOMEM && m->blocked && table > DT_COINCIDENT));
    if (status != DT_OK)
        return;
    require(dt_table_begin(m->copy, NULL, table, cw, &b) == DT_OK);
    require(a.rows == b.rows && a.interior == b.interior);
    require(dt_table_read(set, &a, got, WORDS, WORDS, &rows_got, &words_got) == DT_OK);
    require(dt_table_read(m->copy, &b, want, WORDS, WORDS, &rows_want, &words_want) == DT_OK);
    require(rows_got == a.rows && rows_want == rows_got && words_got == words_want);
    require(memcmp(got, want, words_got * sizeof *got) == 0);
}

static void compare_constraints(const struct dt *set, const struct moment *m)
{
    struct dt_constraint *a, *b;
    size_t n, k;
    require(dt_constraints(set, m->view, DT_NONE, &a, &n) == DT_OK);
    require(dt_constraints(m->copy, NULL, DT_NONE, &b, &k) == DT_OK && n == k);
    for (size_t i = 0; i < n; i++)
        require(a[i].a == b[i].a && a[i].b == b[i].b && a[i].border == b[i].border &&
                a[i].number == b[i].number);
    free(a);
    free(b);
}

static void end_moment(struct moment *m)
{
    dt_view_end(m->view);
    dt_free(m->copy);
    *m = (struct moment){0};
}

/* Compares the views with their copies; one view begins again. */
static void check_moments(struct script *s, uint32_t salt)
{
    for (uint32_t i = 0; i < MOMENTS; i++)
        for (enum dt_table t = DT_POINTS; s->moment[i].view != NULL && t <= DT_HULL; t++)
            compare_moment(s->set, &s->moment[i], t, salt >> t & 1);
    for (uint32_t i = 0; i < MOMENTS; i++)
        if (s->moment[i].view != NULL)
            compare_constraints(s->set, &s->moment[i]);
    struct moment *m = &s->moment[salt % (2 * MOMENTS) / 2];
    end_moment(m);
    m->rings = salt % 7 > 0;
    m->view = dt_view_begin(s->set, m->rings);
    require(m->view != NULL && dt_clone(s->set, &m->copy) == DT_OK);
}

/* An edit of n points is about to happen. */
static void note_block(struct script *s, uint32_t n)
{
    for (uint32_t i = 0; i < MOMENTS; i++)
        s->moment[i].blocked = s->moment[i].blocked || dt_view_blocks(s->set, n);
}

static void compare_ids(struct dt_ids *a, struct dt_ids *b)
{
    require(a->n == b->n && (a->n == 0 || memcmp(a->v, b->v, a->n * sizeof *a->v) == 0));
    a->n = b->n = 0;
}

static void compare_queries(const struct dt *a, const struct dt *b, struct dt_point q, uint32_t k)
{
    struct dt_location la = {0}, lb = {0};
    struct dt_ids ia = {0}, ib = {0};
    require(dt_locate(a, q, &la) == DT_OK && dt_locate(b, q, &lb) == DT_OK);
    require(la.where == lb.where && memcmp(la.id, lb.id, sizeof la.id) == 0);
    require(dt_nearest(a, q, 1, &ia) == DT_OK && dt_nearest(b, q, 1, &ib) == DT_OK);
    compare_ids(&ia, &ib);
    require(dt_nearest(a, q, k, &ia) == DT_OK && dt_nearest(b, q, k, &ib) == DT_OK);
    compare_ids(&ia, &ib);
    require(dt_within_disc(a, q, k, NULL, &ia) == DT_OK &&
            dt_within_disc(b, q, k, NULL, &ib) == DT_OK);
    compare_ids(&ia, &ib);
    free(ia.v);
    free(ib.v);
}

static void check(const struct script *s, uint32_t salt)
{
    struct dt_summary sum;
    dt_summary(s->set, &sum);
    require(sum.points == s->live && dt_refresh(s->set, NULL) == DT_OK);
    if ((s->ids & 3) != 0) /* else regions are as edits have left them */
        require(dt_survey(s->set, NULL) == DT_OK);
    require(dt_check(s->set, NULL, NULL) == DT_OK);
    struct dt *fresh = fresh_set(s, salt & 1 ? DT_DIVIDE : DT_SHELLING);
    for (enum dt_table table = DT_POINTS; table <= DT_TRIANGLES; table++)
        compare_table(s->set, fresh, table, (salt & 2) != 0);
    compare_table(s->set, fresh, salt & 4 ? DT_EDGES : DT_HULL, (salt & 2) != 0);
    for (uint32_t i = 0; i < 2; i++) {
        salt = salt * 1664525 + 1013904223;
        struct dt_point q = place(s, salt >> 16, salt >> 24, (salt & 1 << 15) != 0);
        compare_queries(s->set, fresh, q, 1 + i);
    }
    dt_free(fresh);
}

/* ---- steps ---- */

/* A limit that an edit may exceed. Then it must change nothing, and is repeated without a limit. */
static struct dt_options some_limit(const struct script *s)
{
    return (struct dt_options){.steps = 1 + (uint32_t)(s->end - s->at) * 5 % 64};
}

static void add(struct script *s, const struct dt_point *p, uint32_t n)
{
    struct dt_added added;
    if (s->ids + n > MAX_IDS || s->live + n > MAX_LIVE)
        return;
    struct dt_options opt = some_limit(s);
    note_block(s, n);
    enum dt_status status = dt_add_many(s->set, p, n, &opt, &added);
    require(status == DT_OK || (status == DT_TOOLONG && dt_add(s->set, p, n, &added) == DT_OK));
    require(added.first == s->ids && added.added == n);
    for (uint32_t i = 0; i < n; i++) {
        s->is_live[s->ids] = true;
        s->xy[s->ids++] = p[i];
    }
    s->live += n;
}

static void add_batch(struct script *s)
{
    struct dt_point p[80];
    uint32_t b = byte(s), n = b < 250 ? 1 + b % 30 : 66, salt = byte(s);
    for (uint32_t i = 0; i < n; i++) {
        salt = salt * 1664525 + 1013904223;
        p[i] = place(s, salt >> 16 & 15, salt >> 24 & 15, false);
    }
    add(s, p, n);
}

/* Whether constraints are in the way of an edit. */
static bool is_refused(const struct script *s, enum dt_status status)
{
    return dt_constraints_count(s->set) > 0 && (status == DT_CROSSES || status == DT_CONSTRAINED);
}

/* Every step-th of n live ids, one of them twice. */
static void delete_some(struct script *s, uint32_t n)
{
    uint32_t ids[MAX_LIVE + 1], first = byte(s), step = 1 + byte(s) % 7, deleted, missing, k = 0;
    for (uint32_t i = 0; i < n && i * step < s->live; i++)
        ids[k++] = live_id(s, first + i * step);
    ids[k++] = ids[0];
    struct dt_options opt = some_limit(s);
    note_block(s, k);
    enum dt_status status = dt_delete_many(s->set, ids, k, &opt, &deleted, &missing);
    if (status == DT_TOOLONG)
        status = dt_delete(s->set, ids, k, &deleted, &missing);
    if (is_refused(s, status))
        return;
    require(status == DT_OK && deleted == k - 1);
    for (uint32_t i = 0; i + 1 < k; i++)
        s->is_live[ids[i]] = false;
    s->live -= deleted;
}

static void delete_missing(const struct script *s)
{
    uint32_t ids[2] = {s->live > 0 ? live_id(s, 0) : s->ids, s->ids}, deleted, missing;
    enum dt_status status = dt_delete(s->set, ids, 2, &deleted, &missing);
    require((status == DT_NOPOINT && missing == s->ids) || is_refused(s, status));
    require(dt_move(s->set, s->ids, (struct dt_point){1, 1}) == DT_NOPOINT);
}

static void move_to(struct script *s, uint32_t id, struct dt_point to)
{
    struct dt_options opt = some_limit(s);
    enum dt_status status = dt_move_to(s->set, id, to, &opt);
    if (status == DT_TOOLONG)
        status = dt_move(s->set, id, to);
    if (is_refused(s, status))
        return;
    require(status == DT_OK);
    s->xy[id] = to;
}

static void move(struct script *s)
{
    uint32_t id = live_id(s, byte(s));
    move_to(s, id, read_place(s));
}

/* A move by less than the width of the lattice, after which the mesh may still be valid. */
static void move_slightly(struct script *s)
{
    uint32_t b = byte(s), id = live_id(s, byte(s));
    struct dt_point to = {s->xy[id].x + ((double)(b & 15) - 7) * 0.0625 * s->scale,
                          s->xy[id].y + ((double)(b >> 4) - 7) * 0.0625 * s->scale};
    move_to(s, id, to);
}

/* Declares or releases a constraint, or deletes an end with its constraints. */
static void edit_constraints(struct script *s)
{
    uint32_t b = byte(s), one = live_id(s, byte(s)), other = live_id(s, byte(s)), n, missing;
    struct dt_constraint c = {one, other, (b & 1) != 0, b >> 1 & 3};
    struct dt_options opt = some_limit(s);
    size_t changed, at;
    if (b >> 5 == 7) {
        enum dt_status status = dt_delete_cascade(s->set, &one, 1, NULL, &n, &missing);
        require(status == DT_OK || is_refused(s, status));
        s->is_live[one] = status != DT_OK;
        s->live -= status == DT_OK;
    } else if (b >> 5 == 6) {
        enum dt_status status = dt_release(s->set, &c, 1, NULL, &changed, &at);
        require(status == DT_OK || status == DT_NOCONSTRAINT);
    } else if (one != other) {
        enum dt_status status = dt_constrain(s->set, &c, 1, &opt, &changed, &missing);
        if (status == DT_TOOLONG)
            status = dt_constrain(s->set, &c, 1, NULL, &changed, &missing);
        require(status == DT_OK || status == DT_CROSSES);
    }
}

static void rebuild_or_clone(struct script *s)
{
    struct dt_options opt = {.method = (enum dt_method)(byte(s) % 4), .rebuild = true};
    struct dt *copy;
    if (opt.method <= DT_DIVIDE) {
        require(dt_triangulate(s->set, &opt) == DT_OK);
        return;
    }
    require(dt_clone(s->set, &copy) == DT_OK);
    for (uint32_t i = 0; i < MOMENTS; i++)
        end_moment(&s->moment[i]);
    dt_free(s->set);
    s->set = copy;
}

static void step(struct script *s)
{
    uint32_t op = byte(s);
    struct dt_point p;
    if (op >= 180 && s->live > 1) {
        edit_constraints(s);
        return;
    }
    switch (s->live > 0 ? op % 9 : op % 9 / 4) {
    case 0:
    case 1:
        p = read_place(s);
        add(s, &p, 1);
        break;
    case 2:
        add_batch(s);
        break;
    case 3:
    case 4:
        delete_some(s, 1);
        break;
    case 5:
        delete_some(s, 1 + byte(s) % MAX_LIVE);
        break;
    case 6:
        move(s);
        break;
    case 7:
        move_slightly(s);
        break;
    default:
        delete_missing(s);
        rebuild_or_clone(s);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double tolerances[] = {0, 0, 0, 0.5, 1, 1.5}, scales[] = {1, 0.1};
    static struct script s;
    memset(&s, 0, sizeof s);
    s.at = data;
    s.end = data + (size < MAX_INPUT ? size : MAX_INPUT);
    uint32_t kind = byte(&s), shape = byte(&s);
    s.scale = scales[kind / 6 % 2];
    s.width = 1 + (shape & 15);
    s.height = 1 + (shape >> 4);
    s.set = dt_new(tolerances[kind % 6] * s.scale);
    require(s.set != NULL && dt_triangulate(s.set, NULL) == DT_OK);
    for (uint32_t i = kind; s.at < s.end; i++) {
        step(&s);
        check(&s, i);
        check_moments(&s, i);
    }
    for (uint32_t i = 0; i < MOMENTS; i++)
        end_moment(&s.moment[i]);
    dt_free(s.set);
    return 0;
}
