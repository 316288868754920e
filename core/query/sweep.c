/* sweep.c - large results of a moment: a scan of all rows, a piece at a time.
 *
 * A search along the triangulation visits little more than its result, but the set must not change
 * from its first step to its last. A sweep reads the rows of a view instead, in order of their ids, so
 * that edits can continue between two pieces. For a result that is a large share of the set, that is no slower. */
#include "core/control/stop.h"
#include "core/delaunay.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/query/nearest_heap.h"
#include "core/set/set.h"
#include "core/set/view_rows.h"

#include <stdlib.h>

enum dt_status dt_sweep_read(const struct dt *t, const struct dt_view *v, struct dt_sweep *s,
                             size_t rows)
{
    if (s->row == NULL) {
        s->row = malloc(rows * sizeof *s->row);
        s->room = rows;
    }
    if (s->near == NULL) {
        s->near = malloc(sizeof *s->near);
        if (s->near != NULL)
            *s->near = dt_nearest_heap_of(s->at, NULL, s->k);
    }
    s->rows = 0;
    return s->row == NULL || s->near == NULL
               ? DT_NOMEM
               : dt_view_rows(t, v, &s->from, s->row, s->room, &s->rows);
}

static bool is_hit(const struct dt_sweep *s, struct dt_point p)
{
    switch (s->kind) {
    case DT_SWEEP_BOX:
        return dt_box_contains(&(struct dt_box){s->at, s->hi}, p);
    case DT_SWEEP_DISC:
        return dt_compare_radius(p, s->at, s->radius) <= 0;
    case DT_SWEEP_NEAREST:
        return s->k > 0;
    }
    return false;
}

static enum dt_status take(struct dt_sweep *s, const struct dt_row *r, struct dt_ids *out)
{
    if (s->kind != DT_SWEEP_NEAREST)
        return dt_ids_append(out, r->id);
    struct dt_seen c = dt_nearest_heap_see(s->near, r->at, r->id);
    return c.d > s->near->limit ? DT_OK : dt_nearest_heap_push(s->near, c, NULL);
}

enum dt_status dt_sweep_sift(struct dt_sweep *s, struct dt_ids *out, bool *done)
{
    enum dt_status status = DT_OK;
    for (size_t i = 0; i < s->rows && status == DT_OK; i++) {
        const struct dt_row *r = &s->row[i];
        if (r->id == r->representative && is_hit(s, r->at))
            status = take(s, r, out);
    }
    *done = s->rows < s->room;
    return status;
}

size_t dt_sweep_memory(const struct dt_sweep *s, const struct dt_ids *out)
{
    bool nearest = s->kind == DT_SWEEP_NEAREST;
    size_t ids = out->cap;
    while (ids - out->n < (nearest ? s->near->n : s->room))
        ids = dt_array_room(ids, ids + 1, SIZE_MAX);
    return s->room * sizeof *s->row + (nearest ? dt_nearest_heap_room(s->near, s->room) : 0) +
           ids * sizeof *out->v;
}

enum dt_status dt_sweep_end(struct dt_sweep *s, const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status status = DT_OK;
    for (struct dt_nearest_heap *near = s->near; status == DT_OK && near->n > 0 && near->wanted > 0;
         near->wanted--) {
        if ((near->n & DT_WORK_MASK) == 0)
            status = dt_work(&work, DT_WORK_BLOCK);
        if (status == DT_OK)
            status = dt_ids_append(out, dt_nearest_heap_pop(near).key);
    }
    return status;
}

void dt_sweep_clear(struct dt_sweep *s)
{
    free(s->row);
    s->row = NULL;
    if (s->near != NULL)
        dt_nearest_heap_clear(s->near);
    free(s->near);
    s->near = NULL;
}

/* ---- the rows of a table that are in a box, or meet it ---- */

enum { SIFT_WORDS = 4096 }; /* read from the table at a time */

static enum dt_status take_triangle(const struct dt *t, struct dt_sift *s, const uint32_t *row,
                                    struct dt_ids *out)
{
    const struct dt_view *v = s->cursor.view;
    const struct dt_point p[3] = {dt_view_place(t, v, row[0]),
                                  dt_view_place(t, v, row[s->cursor.cw ? 2 : 1]),
                                  dt_view_place(t, v, row[s->cursor.cw ? 1 : 2])};
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
    if (!dt_box_contains(&box, dt_view_place(t, s->cursor.view, row[0])))
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
    return status == DT_TOOLONG ? DT_OK : status;
}
