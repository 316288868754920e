/* sweep.c - large results of a moment: a scan of all rows, a piece at a time.
 *
 * A search along the triangulation visits little more than its result, but it needs the set as it is
 * from the first step to the last. A sweep reads the rows of a view instead, in order of their ids, so
 * that edits can continue between two pieces. For a result that is a large share of the set, that is no slower.
 *
 * The nearest k are kept in a heap with the farthest of them on top. */
#include "core/control/work.h"
#include "core/delaunay.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/set/reader.h"
#include "core/set/view_rows.h"

#include <math.h>
#include <stdlib.h>

struct dt_sweep_hit {
    double d; /* nearest: the rounded square of the distance */
    struct dt_point at;
    uint32_t id;
};

/* ---- the order of the nearest ---- */

/* Whether a comes before b: nearer or, as near, of the smaller id. */
static bool before(struct dt_point q, const struct dt_sweep_hit *a, const struct dt_sweep_hit *b)
{
    if (dt_squares_decide(a->d, b->d))
        return a->d < b->d;
    int sign = dt_compare_distance(q, a->at, b->at);
    return sign != 0 ? sign < 0 : a->id < b->id;
}

/* Puts h into the heap of n hits in place of the one at i, or below it. */
static void sift_down(struct dt_sweep *s, size_t i, size_t n, struct dt_sweep_hit h)
{
    for (size_t child; (child = 2 * i + 1) < n; i = child) {
        if (child + 1 < n && before(s->at, &s->hit[child], &s->hit[child + 1]))
            child++;
        if (!before(s->at, &h, &s->hit[child]))
            break;
        s->hit[i] = s->hit[child];
    }
    s->hit[i] = h;
}

static void sift_up(struct dt_sweep *s, size_t i, struct dt_sweep_hit h)
{
    for (; i > 0 && before(s->at, &s->hit[(i - 1) / 2], &h); i = (i - 1) / 2)
        s->hit[i] = s->hit[(i - 1) / 2];
    s->hit[i] = h;
}

/* ---- rows ---- */

enum dt_status dt_sweep_read(const struct dt *t, const struct dt_view *v, struct dt_sweep *s,
                             size_t rows)
{
    if (s->row == NULL) {
        s->row = malloc(rows * sizeof *s->row);
        s->room = rows;
    }
    s->rows = 0;
    return s->row == NULL ? DT_NOMEM : dt_view_rows(t, v, &s->from, s->row, s->room, &s->rows);
}

static bool is_hit(const struct dt_sweep *s, struct dt_point p)
{
    switch (s->kind) {
    case DT_SWEEP_BOX:
        return s->at.x <= p.x && p.x <= s->hi.x && s->at.y <= p.y && p.y <= s->hi.y;
    case DT_SWEEP_DISC:
        return dt_compare_radius(p, s->at, s->radius) <= 0;
    case DT_SWEEP_NEAREST:
        return s->k > 0;
    }
    return false;
}

static enum dt_status take_id(struct dt_ids *ids, uint32_t id)
{
    enum dt_status status = dt_ids_reserve(ids, 1);
    if (status == DT_OK)
        ids->v[ids->n++] = id;
    return status;
}

static size_t next_cap(size_t cap)
{
    return 2 * cap + 1024;
}

static enum dt_status make_room(struct dt_sweep *s)
{
    if (s->n < s->cap)
        return DT_OK;
    size_t cap = next_cap(s->cap);
    struct dt_sweep_hit *hit = realloc(s->hit, cap * sizeof *hit);
    if (hit == NULL)
        return DT_NOMEM;
    s->hit = hit;
    s->cap = cap;
    return DT_OK;
}

static enum dt_status take_near(struct dt_sweep *s, const struct dt_row *r)
{
    struct dt_sweep_hit h = {dt_square_distance(r->at, s->at), r->at, r->id};
    if (s->n == s->k) {
        if (before(s->at, &h, &s->hit[0]))
            sift_down(s, 0, s->n, h);
        return DT_OK;
    }
    enum dt_status status = make_room(s);
    if (status == DT_OK)
        sift_up(s, s->n++, h);
    return status;
}

enum dt_status dt_sweep_sift(struct dt_sweep *s, struct dt_ids *out, bool *done)
{
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < s->rows && status == DT_OK; i++) {
        const struct dt_row *r = &s->row[i];
        if (r->id == r->representative && is_hit(s, r->at))
            status = s->kind == DT_SWEEP_NEAREST ? take_near(s, r) : take_id(out, r->id);
    }
    *done = s->rows < s->room;
    return status;
}

size_t dt_sweep_memory(const struct dt_sweep *s, const struct dt_ids *out)
{
    bool nearest = s->kind == DT_SWEEP_NEAREST;
    size_t hits = s->cap, ids = out->cap, want = s->n + s->room;
    want = want < s->k ? want : s->k;
    while (nearest && hits < want)
        hits = next_cap(hits);
    while (ids - out->n < (nearest ? s->n : s->room))
        ids = ids < 16 ? 16 : 2 * ids;
    return s->room * sizeof *s->row + hits * sizeof *s->hit + ids * sizeof *out->v;
}

/* ---- the end ---- */

enum dt_status dt_sweep_end(struct dt_sweep *s, const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_work work = dt_work_of(opt);
    enum dt_status status = DT_OK;
    for (size_t n = s->n; n > 1 && status == DT_OK; n--) {
        if ((n & DT_WORK_MASK) == 0)
            status = dt_work(&work, DT_WORK_BLOCK);
        struct dt_sweep_hit last = s->hit[n - 1];
        s->hit[n - 1] = s->hit[0];
        sift_down(s, 0, n - 1, last);
    }
    for (size_t i = 0; i < s->n && status == DT_OK; i++)
        status = take_id(out, s->hit[i].id);
    return status;
}

void dt_sweep_clear(struct dt_sweep *s)
{
    free(s->row);
    free(s->hit);
    s->row = NULL;
    s->hit = NULL;
}

/* ---- the rows of a table that are in a box, or meet it ---- */

enum { SIFT_WORDS = 4096 }; /* read from the table at a time */

static struct dt_point place(const struct dt *t, const struct dt_view *v, uint32_t id)
{
    struct dt_row row = {0};
    dt_view_row(t, v, id, &row);
    return row.at;
}

static enum dt_status take_triangle(const struct dt *t, struct dt_sift *s, const uint32_t *row,
                                    struct dt_ids *out)
{
    const struct dt_view *v = s->cursor.view;
    const struct dt_point p[3] = {place(t, v, row[0]), place(t, v, row[s->cursor.cw ? 2 : 1]),
                                  place(t, v, row[s->cursor.cw ? 1 : 2])};
    if (!dt_triangle_meets(p, s->lo, s->hi))
        return DT_OK;
    enum dt_status status = dt_ids_reserve(out, 3);
    for (int i = 0; i < 3 && status == DT_OK; i++)
        out->v[out->n++] = row[i];
    s->words += 3;
    return status;
}

static enum dt_status take_list(const struct dt *t, struct dt_sift *s, const uint32_t *row,
                                struct dt_ids *out)
{
    const struct dt_box box = {s->lo, s->hi};
    if (!dt_box_contains(&box, place(t, s->cursor.view, row[0])))
        return DT_OK;
    s->interior += s->rows < s->cursor.interior;
    s->words += 2 + (uint64_t)row[1];
    return dt_ids_append(out, row[0]);
}

static enum dt_status take_rows(const struct dt *t, struct dt_sift *s, const uint32_t *v,
                                size_t words, struct dt_ids *out)
{
    bool lists = s->cursor.table == DT_LISTS;
    enum dt_status status = DT_OK;
    for (size_t at = 0; at < words && status == DT_OK; at += lists ? 2 + (size_t)v[at + 1] : 3) {
        status = lists ? take_list(t, s, v + at, out) : take_triangle(t, s, v + at, out);
        s->rows++;
    }
    return status;
}

/* A row that is longer than usual. */
static enum dt_status read_long(const struct dt *t, struct dt_sift *s, size_t words,
                                struct dt_ids *out)
{
    size_t rows;
    uint32_t *v = malloc(words * sizeof *v);
    if (v == NULL)
        return DT_NOMEM;
    enum dt_status status = dt_table_read(t, &s->cursor, v, words, 1, &rows, &words);
    if (status == DT_OK)
        status = take_rows(t, s, v, words, out);
    free(v);
    return status;
}

enum dt_status dt_sift_read(const struct dt *t, struct dt_sift *s, size_t rows, struct dt_ids *out,
                            bool *done)
{
    uint32_t v[SIFT_WORDS];
    enum dt_status status = DT_OK;
    *done = false;
    for (size_t end = s->rows + rows; status == DT_OK && !*done && s->rows < end;) {
        size_t n, words;
        status = dt_table_read(t, &s->cursor, v, SIFT_WORDS, end - s->rows, &n, &words);
        if (status == DT_TOOSMALL) {
            status = read_long(t, s, words, out);
            continue;
        }
        *done = status == DT_OK && n == 0;
        if (status == DT_OK)
            status = take_rows(t, s, v, words, out);
    }
    return status;
}
