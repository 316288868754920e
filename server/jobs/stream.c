/* stream.c - see stream.h. */
#include "server/jobs/stream.h"

#include "server/jobs/job.h"
#include "server/ops/cost.h"
#include "server/sets/past.h"

#include <stdlib.h>

enum {
    AT_ONCE = 64,             /* rows that are written without a stream */
    HEAVY_ROWS = 20000,       /* more rows, or tables of more points, are made by workers */
    PIECE = 64 * 1024,        /* bytes of a piece, and of a refill; of a surface: SURFACE_PIECE, */
    LARGE_PIECE = 512 * 1024, /* or whole rows of text: there are fewer pieces than PIECES then */
    PIECES = 4                /* of one stream, made or in work */
};

struct piece {
    struct rows part;
    bool uncut;      /* the worker cuts it off first; then it is the only piece in work */
    struct buf text; /* owns */
    struct reservation
        memory;      /* for the text and what its rows take; a worker's while it has the piece */
    struct job *job; /* borrows; not NULL: a worker has the piece */
};

struct stream {
    struct rows rows; /* owns their ids and fields; those that have not been cut into parts yet */
    struct places places; /* owns: those of the rows */
    void (*ready)(void *ctx);
    void *ctx;
    struct piece
        piece[PIECES]; /* a ring: `used` of them from `head` on, in the order of their rows */
    unsigned head, used, most;
    unsigned in_work;
    bool passed; /* a piece needs the copy, which is made when no piece is in work; none is begun */
    struct job *copying;       /* borrows; not NULL: a worker makes it */
    struct past past;          /* owns: the copy, if there is one */
    size_t past_bytes;         /* of the copy */
    bool abandoned;            /* freed while workers are making pieces */
    bool heavy;                /* workers make the pieces */
    struct reservation memory; /* for ids */
};

/* ---- life ---- */

static bool answer_at_once(struct server *s, struct answer *a, struct rows *rows)
{
    enum { BYTES_AT_ONCE = 16 * 1024 };
    bool heavy = rows->heavy && (row_is_of_cell(rows->form) || rows->form == ROW_SURFACE);
    if (heavy || rows_count(rows) > AT_ONCE)
        return false;
    struct reservation memory =
        server_reservation(s, BUDGET_REPLIES); /* then it is the connection's */
    rows->memory = &memory; // cppcheck-suppress autoVariables ; until rows_fill returns
    rows->pace = (struct pace){.steps = COST_STEPS_AT_ONCE};
    rows_fill(rows, a->out, rows->table ? SIZE_MAX : buf_len(a->out) + BYTES_AT_ONCE);
    rows->pace = (struct pace){0};
    rows->memory = NULL;
    reservation_set(&memory, 0);
    return rows->done || rows->status != DT_OK;
}

/* Whether the rows are read from the set; those of a list are not. */
static bool reads_set(const struct rows *rows)
{
    return rows->table || !row_is_of_list(rows->form);
}

/* Whether the view must include the triangulation. */
static bool reads_rings(const struct rows *rows)
{
    return rows->table ? rows->cursor.table != DT_POINTS && rows->cursor.table != DT_COINCIDENT
                       : rows->form == ROW_RING || row_is_computed(rows->form);
}

/* The number of points that are read: COINCIDENT, for instance, reads all for its few rows. */
static uint32_t table_work(const struct version *v, enum dt_table table)
{
    return table == DT_HULL ? v->sum.hull : v->sum.points;
}

static bool is_heavy(const struct rows *rows)
{
    size_t work = rows->table ? table_work(rows->version, rows->cursor.table) : rows_count(rows);
    return rows->heavy || rows->form == ROW_SURFACE || work > HEAVY_ROWS;
}

static size_t piece_bytes(const struct stream *st)
{
    return st->rows.form == ROW_SURFACE ? SURFACE_PIECE : PIECE;
}

static size_t ids_bytes(const struct stream *st)
{
    size_t made = st->rows.made != NULL ? dt_cells_made_memory(st->rows.made) : 0;
    return sizeof *st + st->rows.ids.cap * sizeof(uint32_t) + st->past_bytes + made;
}

/* The bytes that are reserved for a piece of usual rows. */
static size_t piece_room(const struct stream *st)
{
    return rows_piece(&st->rows, PIECE);
}

/* There are fewer pieces if they are large. */
static unsigned most_pieces(const struct stream *st)
{
    size_t room = piece_room(st);
    return room <= LARGE_PIECE ? PIECES : room <= 2 * LARGE_PIECE ? PIECES / 2 : 1;
}

/* False: there is no memory for the pieces. */
static bool reserve(struct server *s, struct stream *st)
{
    st->memory = server_reservation(s, BUDGET_REPLIES);
    for (unsigned i = 0; i < PIECES; i++)
        st->piece[i].memory = st->memory;
    bool good = reservation_resize(&st->memory, ids_bytes(st));
    for (unsigned i = 0; st->heavy && good && i < st->most; i++)
        good = reservation_resize(&st->piece[i].memory, piece_room(st));
    for (unsigned i = 0; !good && i < st->most; i++)
        reservation_set(&st->piece[i].memory, 0);
    if (!good)
        reservation_set(&st->memory, 0);
    return good;
}

/* Gives back what long rows have taken. Of pieces that workers make, the usual room stays reserved. */
static void settle(const struct stream *st, struct piece *p)
{
    size_t usual = piece_room(st), bytes;
    if (p->text.cap > usual)
        buf_fit(&p->text);
    bytes = p->text.cap + rows_memory(&p->part);
    reservation_set(&p->memory, st->heavy && bytes < usual ? usual : bytes);
}

static void free_places(struct server *s, struct places *places)
{
    dt_pages_release(places->p);
    if (places->memory.bytes == 0)
        return;
    reservation_set(&places->memory, 0);
    server_memory_freed(s);
}

/* NULL: out of memory, or answer_busy. */
static struct stream *new_stream(struct server *s, struct answer *a, struct rows *rows)
{
    struct stream *st = calloc(1, sizeof *st);
    if (st != NULL && rows->view == NULL && reads_set(rows))
        rows->view = dt_view_begin(rows->version->dt, reads_rings(rows));
    if (st == NULL || (rows->view == NULL && reads_set(rows))) {
        free(st);
        answer_out_of_memory(a);
        return NULL;
    }
    rows->surface.view = rows->view;
    st->rows = *rows;
    st->heavy = s->workers != NULL && is_heavy(rows);
    st->most = most_pieces(st);
    if (!reserve(s, st)) {
        free(st);
        answer_busy(a);
        return NULL;
    }
    version_pin(rows->version);
    return st;
}

void stream_answer(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids)
{
    if (ids != NULL)
        rows->ids = *ids;
    if (rows->view == NULL && answer_at_once(s, a, rows)) {
        if (rows->status != DT_OK)
            answer_out_of_memory(a);
        rows_clear(rows);
        return;
    }
    struct stream *st = new_stream(s, a, rows);
    if (st == NULL) {
        version_end_view(&s->sets, rows->version, rows->view);
        rows_clear(rows);
        return;
    }
    a->next = ANSWER_STREAM;
    a->stream = st;
    if (ids != NULL)
        *ids = (struct dt_ids){0};
}

void stream_answer_places(struct server *s, struct answer *a, struct rows *rows,
                          struct places *places)
{
    rows->place = places->p;
    rows->places = places->n;
    stream_answer(s, a, rows, NULL);
    if (a->next == ANSWER_STREAM)
        a->stream->places = *places;
    else
        free_places(s, places);
}

void stream_notify(struct stream *st, void (*ready)(void *ctx), void *ctx)
{
    st->ready = ready;
    st->ctx = ctx;
}

bool stream_computes(const struct stream *st)
{
    return row_is_computed(st->rows.form);
}

void stream_free(struct server *s, struct stream *st)
{
    st->abandoned = true;
    for (unsigned i = 0; i < PIECES; i++)
        if (st->piece[i].job != NULL)
            st->piece[i].job->cancel = true;
    if (st->copying != NULL)
        st->copying->cancel = true;
    if (st->in_work > 0)
        return;
    for (unsigned i = 0; i < PIECES; i++) {
        rows_clear(&st->piece[i].part);
        buf_free(&st->piece[i].text);
        reservation_set(&st->piece[i].memory, 0);
    }
    version_end_view(&s->sets, st->rows.version, st->rows.view);
    version_unpin(&s->sets, st->rows.version);
    rows_clear(&st->rows);
    free(st->rows.ids.v);
    free(st->rows.field);
    dt_cells_made_free(st->rows.made);
    if (st->past.dt != NULL)
        s->sets.discard(s->sets.discard_ctx, st->past.dt);
    reservation_set(&st->memory, 0);
    free_places(s, &st->places);
    free(st);
}

/* The length of a binary table: 4 bytes a word, 16 for the coordinates of a point, and 8 for a value of it. */
static uint64_t table_bytes(const struct version *v, const struct rows *rows)
{
    const struct dt_cursor *c = &rows->cursor;
    switch (c->table) {
    case DT_POINTS:
    case DT_HULL:
        return (uint64_t)c->rows * (20 + 8 * rows->fields);
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

static void answer_table(struct server *s, struct answer *a, struct rows *made)
{
    struct rows rows = *made;
    struct version *v = rows.version;
    enum dt_table table = rows.cursor.table;
    bool cw = rows.cw, binary = rows.binary;
    if (table_work(v, table) > AT_ONCE) {
        rows.view = dt_view_begin(v->dt, reads_rings(&rows));
        if (rows.view == NULL) {
            answer_out_of_memory(a);
            return;
        }
    }
    enum dt_status status = dt_table_begin(v->dt, rows.view, table, cw, &rows.cursor);
    if (status != DT_OK) {
        version_end_view(&s->sets, v, rows.view);
        answer_status(a, status);
        return;
    }
    reply_ok(a->out, binary ? 0 : rows.cursor.rows);
    if (table == DT_LISTS) {
        reply_key_u64(a->out, "interior", rows.cursor.interior);
        reply_key_u64(a->out, "boundary", rows.cursor.rows - rows.cursor.interior);
    } else if (binary) {
        reply_key_u64(a->out, "rows", rows.cursor.rows);
    }
    if (binary)
        reply_key_u64(a->out, "bytes", table_bytes(v, &rows));
    reply_end(a->out);
    stream_answer(s, a, &rows, NULL);
}

void stream_answer_table(struct server *s, struct answer *a, struct version *v, enum dt_table table,
                         bool cw, bool binary)
{
    struct rows rows = {
        .version = v, .table = true, .binary = binary, .cw = cw, .cursor.table = table};
    answer_table(s, a, &rows);
}

void stream_answer_points(struct server *s, struct answer *a, struct version *v, bool binary,
                          const struct dt_field **field, size_t fields)
{
    struct rows rows = {.version = v,
                        .table = true,
                        .binary = binary,
                        .cursor.table = DT_POINTS,
                        .field = field,
                        .fields = fields};
    answer_table(s, a, &rows);
    if (a->next != ANSWER_STREAM)
        free(field);
}

/* ---- pieces ---- */

struct making {
    struct job job;
    struct stream *stream; /* borrows: not freed before the job ends */
    struct piece *piece;
};

/* A part usually fits into a piece; if it is longer or takes longer, the piece is continued after this has been sent. */
static void make(struct stream *st, struct piece *p, const atomic_bool *cancel)
{
    p->part.done = p->uncut && !rows_cut(&st->rows, &p->part);
    if (p->part.done)
        return;
    p->part.pace.cancel = cancel;
    p->part.memory = &p->memory;
    rows_fill(&p->part, &p->text, piece_bytes(st) - ROOM_ROW);
    p->part.pace.cancel = NULL;
}

static void run_making(struct job *j)
{
    struct making *m = (struct making *)j;
    bool free = m->stream->past.dt != NULL && j->queued_ns > 0; /* nobody edits the copy */
    if (free)
        version_unlock(j->base);
    if (!j->cancel)
        make(m->stream, m->piece, &j->cancel);
    if (free)
        version_lock_read(j->base);
}

static void end_work(struct server *s, struct stream *st)
{
    st->in_work--;
    reservation_set(&st->memory, ids_bytes(st));
    if (st->abandoned)
        stream_free(s, st);
    else if (st->ready != NULL)
        st->ready(st->ctx);
}

static void end_making(struct server *s, struct job *j, struct answer *a)
{
    struct making *m = (struct making *)j;
    struct stream *st = m->stream;
    (void)a; /* never refused */
    m->piece->job = NULL;
    m->piece->uncut = false;
    settle(st, m->piece);
    st->passed = st->passed || m->piece->part.surface.passed;
    end_work(s, st);
}

/* Submits the piece, or its continuation, to a worker. */
static void begin(struct server *s, struct stream *st, struct piece *p)
{
    struct making *m = job_new(sizeof *m, run_making, end_making);
    if (m == NULL) {
        version_lock_read(st->rows.version);
        make(st, p, NULL);
        version_unlock(st->rows.version);
        settle(st, p);
        p->uncut = false;
        st->passed = st->passed || p->part.surface.passed;
        return;
    }
    m->stream = st;
    m->piece = p;
    p->job = &m->job;
    st->in_work++;
    job_read(s, NULL, &m->job, st->rows.version, p->part.pace.slow ? JOB_SLOW : JOB_SHORT);
}

/* ---- after an edit of the points ---- */

struct copying {
    struct job job;
    struct stream *stream; /* borrows: not freed before the job ends */
    struct past past;      /* owns, until it moves to the stream */
    size_t bytes;
};

static void run_copying(struct job *j)
{
    struct copying *c = (struct copying *)j;
    const struct rows *rows = &c->stream->rows;
    j->status = past_copy(j->base, rows->view, rows->surface.field, &j->options, j->queued_ns > 0,
                          &j->memory, &c->past);
    c->bytes = j->memory.bytes;
}

/* The rows continue on the copy. */
static void use_past(struct rows *rows, const struct past *past)
{
    rows->surface.dt = past->dt;
    rows->surface.field = past->field;
    rows->surface.view = NULL;
    rows->surface.passed = false;
}

static void end_copying(struct server *s, struct job *j, struct answer *a)
{
    struct copying *c = (struct copying *)j;
    struct stream *st = c->stream;
    (void)a;
    st->copying = NULL;
    st->passed = false;
    st->rows.status = j->status;
    if (j->status == DT_OK) {
        st->past = c->past;
        st->past_bytes = c->bytes;
        c->past.dt = NULL;
        version_end_view(&s->sets, st->rows.version, st->rows.view);
        st->rows.view = NULL;
        use_past(&st->rows, &st->past);
    }
    for (unsigned i = 0; i < st->used && j->status == DT_OK && !st->abandoned; i++) {
        struct piece *p = &st->piece[(st->head + i) % st->most];
        bool again = p->part.surface.passed;
        use_past(&p->part, &st->past);
        p->part.view = NULL;
        if (again)
            begin(s, st, p);
    }
    dt_free(c->past.dt);
    end_work(s, st);
}

/* Begins the copy when no piece is in work. */
static enum dt_status copy_past(struct server *s, struct stream *st)
{
    if (!st->passed || st->in_work > 0)
        return st->rows.status;
    struct copying *c = job_new(sizeof *c, run_copying, end_copying);
    if (c == NULL)
        return DT_NOMEM;
    c->stream = st;
    c->job.memory = server_reservation(s, BUDGET_REPLIES);
    st->copying = &c->job;
    st->in_work++;
    job_read(s, NULL, &c->job, st->rows.version, JOB_LONG);
    return st->rows.status;
}

/* ---- sending ---- */

/* Whether the next rows have been made. */
static bool is_made(const struct stream *st)
{
    const struct piece *p = &st->piece[st->head];
    return st->used > 0 && p->job == NULL && !p->part.surface.passed;
}

/* Sends the text of the piece: all of it if it has the usual size, otherwise as much as fits into `most` bytes of out. A conversion to
 * RESP needs whole rows. */
static enum dt_status send_text(const struct server *s, const struct stream *st, struct piece *p,
                                struct buf *out, size_t most)
{
    enum { CONVERTED = 3 }; /* times the rows: in lines and in RESP */
    size_t n = buf_len(&p->text), room = most - buf_len(out);
    bool whole = out == &s->lines && !st->rows.binary;
    if (whole && n > 2 * PIECE && !budget_fits(&s->budget, BUDGET_REPLIES, CONVERTED * n))
        return DT_NOMEM;
    n = whole || n <= PIECE || n < room ? n : room;
    buf_append(out, buf_head(&p->text), n); /* copied, so that the memory of a piece stays small */
    buf_consume(&p->text, n);
    return out->failed ? DT_NOMEM : DT_OK;
}

static enum dt_status send_made(struct server *s, struct stream *st, struct buf *out, size_t most)
{
    while (is_made(st) && buf_len(out) < most) {
        struct piece *p = &st->piece[st->head];
        if (p->part.status != DT_OK)
            return p->part.status;
        enum dt_status status = send_text(s, st, p, out, most);
        if (status != DT_OK || buf_len(&p->text) > 0)
            return status;
        if (p->text.cap > piece_room(st))
            buf_free(&p->text);
        settle(st, p);
        if (!p->part.done && st->passed) {
            p->part.surface.passed = true; /* continues on the copy */
        } else if (!p->part.done) {
            begin(s, st, p);
        } else {
            rows_clear(&p->part);
            st->head = (st->head + 1) % st->most;
            st->used--;
        }
    }
    return DT_OK;
}

/* Cuts off the next piece. False: there is none, or an edit has the lock and other pieces are still to be sent.
 * If there are no other pieces then, a worker cuts it off (uncut). */
static bool cut_next(struct stream *st, struct piece *p)
{
    if (version_try_read(st->rows.version)) {
        bool cut = rows_cut(&st->rows, &p->part);
        version_unlock(st->rows.version);
        return cut;
    }
    p->uncut = st->used == 0;
    return p->uncut;
}

static void begin_next(struct server *s, struct stream *st)
{
    while (st->used < st->most && !st->passed && !(st->used > 0 && st->piece[st->head].uncut)) {
        struct piece *p = &st->piece[(st->head + st->used) % st->most];
        if (!cut_next(st, p))
            return;
        st->used++;
        begin(s, st, p);
    }
}

/* Sends finished pieces and begins others. If there was no memory for a job, the piece was made on this thread and
 * must be sent at once, because `ready` is not called for it. */
static enum dt_status go_on(struct server *s, struct stream *st, struct buf *out)
{
    size_t most = buf_len(out) + PIECE;
    enum dt_status status;
    do {
        status = send_made(s, st, out, most);
        if (status == DT_OK)
            status = copy_past(s, st);
        if (status == DT_OK)
            begin_next(s, st);
    } while (status == DT_OK && is_made(st) && buf_len(out) < most);
    return status;
}

/* Whether this thread makes the next piece itself; then it holds the lock. Not while an edit has it. */
static bool may_fill(struct stream *st)
{
    return st->used == 0 && !st->heavy && version_try_read(st->rows.version);
}

/* Makes rows right in the output, with the lock, which is released. */
static void fill(struct server *s, struct stream *st, struct buf *out)
{
    struct reservation memory =
        server_reservation(s, BUDGET_REPLIES); /* then it is the connection's */
    st->rows.memory = &memory;
    rows_fill(&st->rows, out, buf_len(out) + PIECE);
    version_unlock(st->rows.version);
    reservation_set(&memory, 0);
    if (out->cap > 4 * PIECE)
        buf_fit(out);
}

void stream_refill(struct server *s, struct answer *a)
{
    struct stream *st = a->stream;
    enum dt_status status;
    bool done;
    if (may_fill(st)) {
        fill(s, st, a->out);
        st->passed = st->rows.surface.passed;
        status = copy_past(s, st); /* there are no workers: at once */
        done = st->rows.done;
    } else {
        status = go_on(s, st, a->out);
        done = st->used == 0;
    }
    if (status == DT_OK && !done)
        return;
    a->next = ANSWER_DONE;
    a->broken = status != DT_OK;
    stream_free(s, st);
}
