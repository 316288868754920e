/* stream.c - see stream.h. */
#include "server/stream.h"

#include "server/job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    AT_ONCE = 64, /* rows that are written without a stream */
    HEAVY_ROWS = 20000,
    TABLE_WORDS = 4096, /* read from a table in one go */
    PIECE = 64 * 1024   /* bytes of a refill */
};

/* ---- rows from ids ---- */

static void write_point(struct stream *st, struct buf *out, uint32_t id)
{
    struct dt_point p;
    st->status = dt_get(st->version->dt, id, &p);
    if (st->status != DT_OK)
        return;
    if (st->form == ROW_NEIGHBOUR) {
        double dx = p.x - st->from.x, dy = p.y - st->from.y;
        reply_row_neighbour(out, id, p.x, p.y, sqrt(dx * dx + dy * dy));
    } else if (st->binary) {
        reply_word_u32(out, id);
        reply_word_double(out, p.x);
        reply_word_double(out, p.y);
    } else {
        reply_row_point(out, id, p.x, p.y);
    }
}

static void write_ring(struct stream *st, struct buf *out, uint32_t id)
{
    uint32_t rep;
    bool boundary;
    st->row.n = 0;
    st->status = dt_ring(st->version->dt, id, st->cw, &st->row, &rep, &boundary);
    if (st->status != DT_OK)
        return;
    reply_row_ids(out, &rep, 1);
    if (st->row.n > 0 && !out->failed) {
        out->data[out->end - 1] = ' '; /* the ring goes on the same line */
        reply_row_ids(out, st->row.v, st->row.n);
    }
}

static void fill_from_ids(struct stream *st, struct buf *out, size_t limit)
{
    while (st->at < st->ids.n && st->status == DT_OK && !out->failed && buf_len(out) < limit) {
        const uint32_t *id = st->ids.v + st->at;
        if (st->form == ROW_IDS)
            reply_row_ids(out, id, st->width);
        else if (st->form == ROW_RING)
            write_ring(st, out, *id);
        else
            write_point(st, out, *id);
        st->at += st->form == ROW_IDS ? st->width : 1;
    }
    st->done = st->at == st->ids.n;
}

/* ---- rows from tables ---- */

/* How many words the row that starts at w has. */
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

static void write_table_row(struct stream *st, struct buf *out, uint32_t *w, size_t words)
{
    enum dt_table table = st->cursor.table;
    if (table == DT_POINTS || table == DT_HULL) {
        st->form = ROW_POINT;
        write_point(st, out, w[0]);
    } else if (st->binary) {
        reply_words_u32(out, w, words);
    } else if (table == DT_LISTS) {
        w[1] = w[0]; /* the degree is not part of the text */
        reply_row_ids(out, w + 1, words - 1);
    } else {
        reply_row_ids(out, w, words);
    }
}

/* Reads the one row that is longer than the usual buffer. */
static void write_long_row(struct stream *st, struct buf *out, size_t words)
{
    size_t rows;
    uint32_t *v = malloc(words * sizeof *v);
    if (v == NULL) {
        st->status = DT_NOMEM;
        return;
    }
    st->status = dt_table_read(st->version->dt, &st->cursor, v, words, 1, &rows, &words);
    if (st->status == DT_OK && rows == 1)
        write_table_row(st, out, v, words);
    free(v);
}

static void fill_from_table(struct stream *st, struct buf *out, size_t limit)
{
    uint32_t v[TABLE_WORDS];
    while (!st->done && st->status == DT_OK && !out->failed && buf_len(out) < limit) {
        /* A word takes up to 11 bytes of text, a point that an id stands for about four times that;
         * in binary form it is four bytes, and the rows of a table are what is sent. */
        bool as_it_is = st->binary && st->cursor.table != DT_POINTS && st->cursor.table != DT_HULL;
        size_t cap = (limit - buf_len(out)) / (as_it_is ? 4 : 40) + 64;
        size_t rows = 0, words = 0;
        st->status =
            dt_table_read(st->version->dt, &st->cursor, v, cap < TABLE_WORDS ? cap : TABLE_WORDS,
                          TABLE_WORDS, &rows, &words);
        if (st->status == DT_TOOSMALL) {
            write_long_row(st, out, words);
            continue;
        }
        st->done = st->status == DT_OK && rows == 0;
        if (as_it_is)
            reply_words_u32(out, v, words);
        for (size_t at = as_it_is ? words : 0; at < words && st->status == DT_OK;) {
            size_t n = row_words(st->cursor.table, v + at);
            write_table_row(st, out, v + at, n);
            at += n;
        }
    }
}

void stream_fill(struct stream *st, struct buf *out, size_t limit)
{
    if (st->table)
        fill_from_table(st, out, limit);
    else
        fill_from_ids(st, out, limit);
    if (out->failed)
        st->status = DT_NOMEM;
}

/* ---- life ---- */

static size_t rows(const struct stream *st)
{
    return st->table ? st->cursor.rows : st->ids.n / (st->form == ROW_IDS ? st->width : 1);
}

static bool answer_at_once(struct answer *a, struct stream *st)
{
    enum { BYTES_AT_ONCE = 16 * 1024 };
    if (rows(st) > AT_ONCE)
        return false;
    stream_fill(st, a->out, buf_len(a->out) + BYTES_AT_ONCE);
    return st->done || st->status != DT_OK;
}

void stream_answer(struct answer *a, struct stream *st, struct dt_ids *ids)
{
    if (ids != NULL)
        st->ids = *ids;
    if (answer_at_once(a, st)) {
        if (st->status != DT_OK)
            answer_out_of_memory(a);
        free(st->row.v);
        return;
    }
    a->stream = malloc(sizeof *st);
    if (a->stream == NULL) {
        answer_out_of_memory(a);
        free(st->row.v);
        return;
    }
    *a->stream = *st;
    version_pin(st->version);
    if (ids != NULL)
        *ids = (struct dt_ids){0};
}

void stream_free(struct registry *r, struct stream *st)
{
    version_unpin(r, st->version);
    free(st->ids.v);
    free(st->row.v);
    free(st);
}

/* The length of a binary table: four bytes a word, a point's coordinates sixteen more. */
static uint64_t table_bytes(const struct version *v, const struct dt_cursor *c)
{
    switch (c->table) {
    case DT_POINTS:
    case DT_HULL:
        return (uint64_t)c->rows * 20;
    case DT_COINCIDENT:
    case DT_EDGES:
        return (uint64_t)c->rows * 8;
    case DT_TRIANGLES:
        return (uint64_t)c->rows * 12;
    case DT_LISTS: /* id, degree, and every edge from both its ends */
        return (uint64_t)c->rows * 8 + (uint64_t)v->sum.edges * 8;
    }
    return 0;
}

void stream_answer_table(struct answer *a, struct version *v, enum dt_table table, bool cw,
                         bool binary)
{
    struct stream st = {.version = v, .table = true, .binary = binary};
    enum dt_status status = dt_table_begin(v->dt, table, cw, &st.cursor);
    if (status != DT_OK) {
        answer_status(a, status);
        return;
    }
    reply_ok(a->out, binary ? 0 : st.cursor.rows);
    if (table == DT_LISTS) {
        reply_key_u64(a->out, "interior", st.cursor.interior);
        reply_key_u64(a->out, "boundary", st.cursor.rows - st.cursor.interior);
    } else if (binary) {
        reply_key_u64(a->out, "rows", st.cursor.rows);
    }
    if (binary)
        reply_key_u64(a->out, "bytes", table_bytes(v, &st.cursor));
    reply_end(a->out);
    stream_answer(a, &st, NULL);
}

/* ---- refilling ---- */

struct refill {
    struct job job;
    struct stream *stream;
    struct buf piece;
};

static void run_refill(struct job *j)
{
    struct refill *r = (struct refill *)j;
    stream_fill(r->stream, &r->piece, PIECE);
}

/* What follows from filling: more to come, the end, or rows that cannot be continued. */
static void refilled(struct server *s, struct answer *a, struct stream *st)
{
    a->stream = NULL;
    if (st->status == DT_OK && !st->done) {
        a->stream = st;
        return;
    }
    a->broken = st->status != DT_OK;
    stream_free(&s->sets, st);
}

static void refill_done(struct server *s, struct job *j, struct answer *a)
{
    struct refill *r = (struct refill *)j;
    if (buf_len(a->out) == 0) {
        struct buf empty = *a->out;
        *a->out = r->piece;
        r->piece = empty;
    } else {
        buf_append(a->out, buf_head(&r->piece), buf_len(&r->piece));
    }
    if (a->out->failed)
        r->stream->status = DT_NOMEM;
    refilled(s, a, r->stream);
}

static void clear_refill(struct job *j)
{
    buf_free(&((struct refill *)j)->piece);
}

void stream_refill(struct server *s, struct answer *a)
{
    struct stream *st = a->stream;
    struct refill *r = NULL;
    if (rows(st) > HEAVY_ROWS)
        r = job_new(sizeof *r, run_refill, refill_done);
    if (r == NULL) {
        stream_fill(st, a->out, buf_len(a->out) + PIECE);
        refilled(s, a, st);
        return;
    }
    r->stream = st;
    r->job.clear = clear_refill;
    a->stream = NULL;
    job_read(s, a, &r->job, st->version, JOB_HEAVY | JOB_BRIEF);
}
