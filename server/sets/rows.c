/* rows.c - see rows.h. */
#include "server/sets/rows.h"

#include <math.h>
#include <stdlib.h>

enum {
    TABLE_WORDS = 4096, /* read from a table at a time */
    PART_IDS = 600      /* of a part: ids of a table or rows of a list, about 30 KiB of text */
};

/* ---- rows from ids ---- */

static void write_point(struct rows *r, struct buf *out, uint32_t id)
{
    struct dt_point p;
    r->status = dt_view_get(r->version->dt, r->view, id, &p);
    if (r->status != DT_OK)
        return;
    if (r->form == ROW_NEIGHBOUR) {
        double dx = p.x - r->from.x, dy = p.y - r->from.y;
        reply_row_neighbour(out, id, p.x, p.y, sqrt(dx * dx + dy * dy));
    } else if (r->binary) {
        reply_word_u32(out, id);
        reply_word_double(out, p.x);
        reply_word_double(out, p.y);
    } else {
        reply_row_point(out, id, p.x, p.y);
    }
}

static void write_ring(struct rows *r, struct buf *out, uint32_t id)
{
    uint32_t rep;
    bool boundary;
    r->ring.n = 0;
    r->status = dt_view_ring(r->version->dt, r->view, id, r->cw, &r->ring, &rep, &boundary);
    if (r->status != DT_OK)
        return;
    reply_row_ids(out, &rep, 1);
    if (r->ring.n > 0 && !out->failed) {
        out->data[out->end - 1] = ' '; /* the ring goes on the same line */
        reply_row_ids(out, r->ring.v, r->ring.n);
    }
}

/* Prefetches the data of the next rows. */
static void fetch_next(const struct rows *r)
{
    const uint32_t *id = r->ids.v + r->at;
    size_t left = r->ids.n - r->at, n = left < DT_AHEAD ? left : DT_AHEAD;
    if (r->form == ROW_RING)
        dt_fetch_ids(r->version->dt, id, n);
    else if (r->form != ROW_IDS)
        dt_fetch_points(r->version->dt, id, n);
}

static void fill_from_ids(struct rows *r, struct buf *out, size_t limit)
{
    while (r->at < r->ids.n && r->status == DT_OK && !out->failed && buf_len(out) < limit) {
        const uint32_t *id = r->ids.v + r->at;
        if (r->at % DT_AHEAD == 0 && r->ids.n > 1)
            fetch_next(r);
        if (r->form == ROW_IDS)
            reply_row_ids(out, id, r->width);
        else if (r->form == ROW_RING)
            write_ring(r, out, *id);
        else
            write_point(r, out, *id);
        r->at += r->form == ROW_IDS ? r->width : 1;
    }
    r->done = r->at == r->ids.n;
}

/* ---- rows from tables ---- */

/* The number of words of the row that starts at w. */
static size_t row_words(enum dt_table table, const uint32_t *w)
{
    switch (table) {
    case DT_POINTS:
    case DT_HULL:
        return 1;
    case DT_COINCIDENT:
    case DT_EDGES:
        return 2;
    case DT_TRIANGLES:
        return 3;
    case DT_LISTS:
        return 2 + w[1];
    }
    return 1;
}

static void write_table_row(struct rows *r, struct buf *out, uint32_t *w, size_t words)
{
    enum dt_table table = r->cursor.table;
    if (table == DT_POINTS || table == DT_HULL) {
        r->form = ROW_POINT;
        write_point(r, out, w[0]);
    } else if (r->binary) {
        reply_words_u32(out, w, words);
    } else if (table == DT_LISTS) {
        w[1] = w[0]; /* the degree is not part of the text */
        reply_row_ids(out, w + 1, words - 1);
    } else {
        reply_row_ids(out, w, words);
    }
}

/* Writes one row that is longer than the usual buffer. */
static void write_long_row(struct rows *r, struct buf *out, size_t words)
{
    size_t rows;
    uint32_t *v = malloc(words * sizeof *v);
    if (v == NULL) {
        r->status = DT_NOMEM;
        return;
    }
    r->status = dt_table_read(r->version->dt, &r->cursor, v, words, 1, &rows, &words);
    if (r->status == DT_OK && rows == 1)
        write_table_row(r, out, v, words);
    free(v);
}

static void fill_from_table(struct rows *r, struct buf *out, size_t limit)
{
    uint32_t v[TABLE_WORDS];
    while (!r->done && r->status == DT_OK && !out->failed && buf_len(out) < limit) {
        /* A word takes up to 11 bytes of text, and the row of a point about four times that. In binary
         * form a word takes four bytes, and most tables are sent as they are. */
        bool as_it_is = r->binary && r->cursor.table != DT_POINTS && r->cursor.table != DT_HULL;
        size_t cap = (limit - buf_len(out)) / (as_it_is ? 4 : 40) + 64;
        size_t rows = 0, words = 0;
        r->status =
            dt_table_read(r->version->dt, &r->cursor, v, cap < TABLE_WORDS ? cap : TABLE_WORDS,
                          TABLE_WORDS, &rows, &words);
        if (r->status == DT_TOOSMALL) {
            write_long_row(r, out, words);
            continue;
        }
        r->done = r->status == DT_OK && rows == 0;
        if (as_it_is)
            reply_words_u32(out, v, words);
        for (size_t at = as_it_is ? words : 0; at < words && r->status == DT_OK;) {
            size_t n = row_words(r->cursor.table, v + at);
            write_table_row(r, out, v + at, n);
            at += n;
        }
    }
}

void rows_fill(struct rows *r, struct buf *out, size_t limit)
{
    if (r->table)
        fill_from_table(r, out, limit);
    else
        fill_from_ids(r, out, limit);
    if (out->failed)
        r->status = DT_NOMEM;
}

/* ---- parts ---- */

size_t rows_count(const struct rows *r)
{
    return r->table ? r->cursor.rows : r->ids.n / (r->form == ROW_IDS ? r->width : 1);
}

bool rows_cut(struct rows *r, struct rows *part)
{
    *part = *r;
    part->ring = (struct dt_ids){0};
    if (r->table)
        return dt_table_cut(r->version->dt, &r->cursor, PART_IDS, &part->cursor);
    size_t n = PART_IDS * (r->form == ROW_IDS ? r->width : 1);
    r->at = r->ids.n - r->at > n ? r->at + n : r->ids.n;
    part->ids.n = r->at;
    return part->at < part->ids.n;
}

void rows_clear(struct rows *r)
{
    free(r->ring.v);
    r->ring = (struct dt_ids){0};
}
