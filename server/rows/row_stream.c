/* row_stream.c - see row_stream.h. */
#include "server/rows/row_stream.h"

#include "server/jobs/past.h"
#include "server/rows/stream.h"

#include <stdlib.h>

enum {
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

struct row_stream {
    struct stream stream; /* first */
    struct rows rows; /* owns their ids and fields; those that have not been cut into parts yet */
    struct places places; /* owns: those of the rows */
    /* a ring: `used` of them from `head` on, in the order of their rows */
    struct piece piece[PIECES];
    unsigned head, used, most;
    struct job *copying;                         /* borrows; not NULL: a worker makes the copy */
    const struct dt_field *field[DT_MAX_FIELDS]; /* of the rows of a surface */
    struct past past;                            /* owns: the copy, if there is one */
    size_t past_bytes;                           /* of the copy */
    bool heavy;                                  /* workers make the pieces */
    bool converted;                              /* the rows become RESP */
};

/* ---- life ---- */

static size_t piece_bytes(const struct row_stream *st)
{
    return st->rows.form == ROW_SURFACE ? SURFACE_PIECE : PIECE;
}

static size_t ids_bytes(const struct row_stream *st)
{
    size_t made = st->rows.made != NULL ? dt_cells_made_memory(st->rows.made) : 0;
    return sizeof *st + st->rows.ids.cap * sizeof(uint32_t) + st->past_bytes + made;
}

/* The bytes that are reserved for a piece of usual rows. */
static size_t piece_room(const struct row_stream *st)
{
    return rows_piece(&st->rows, PIECE);
}

/* Gives back what long rows have taken. Of pieces that workers make, the usual room stays reserved. */
static void settle(const struct row_stream *st, struct piece *p)
{
    size_t usual = piece_room(st), bytes;
    if (p->text.cap > usual)
        buf_fit(&p->text);
    bytes = p->text.cap + rows_memory(&p->part);
    reservation_set(&p->memory, st->heavy && bytes < usual ? usual : bytes);
}

void row_stream_free_places(struct server *s, struct places *places)
{
    dt_pages_release(places->p);
    dt_pages_release(places->kept);
    if (places->memory.bytes == 0)
        return;
    reservation_set(&places->memory, 0);
    server_memory_freed(s);
}

static void clear(struct server *s, struct stream *stream)
{
    struct row_stream *st = (struct row_stream *)stream;
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
    row_stream_free_places(s, &st->places);
}

static void cancel(struct stream *stream)
{
    struct row_stream *st = (struct row_stream *)stream;
    for (unsigned i = 0; i < PIECES; i++)
        if (st->piece[i].job != NULL)
            st->piece[i].job->cancel = true;
    if (st->copying != NULL)
        st->copying->cancel = true;
}

/* ---- pieces ---- */

struct making {
    struct job job;
    struct row_stream *stream; /* borrows: not freed before the job ends */
    struct piece *piece;
};

/* A part usually fits into a piece; if it is longer or takes longer, the piece is continued after this has been sent. */
static void make(struct row_stream *st, struct piece *p, const atomic_bool *cancel)
{
    p->part.done = p->uncut && !rows_cut(&st->rows, &p->part);
    if (p->part.done)
        return;
    p->part.pace.cancel = cancel;
    p->part.memory = &p->memory;
    rows_fill(&p->part, &p->text, piece_bytes(st) - ROW_MEMORY_SHORT);
    p->part.pace.cancel = NULL;
}

static void run_making(struct job *j)
{
    struct making *m = (struct making *)j;
    bool past = m->stream->past.dt != NULL; /* nobody edits the copy */
    if (past)
        job_end_visit(j);
    if (!j->cancel)
        make(m->stream, m->piece, &j->cancel);
    if (past)
        job_visit(j);
}

static void end_work(struct server *s, struct row_stream *st)
{
    reservation_set(&st->stream.memory, ids_bytes(st));
    stream_job_ended(s, &st->stream);
}

/* The job is never refused. */
static void end_making(struct server *s, struct job *j, struct answer *a)
{
    struct making *m = (struct making *)j;
    struct row_stream *st = m->stream;
    m->piece->job = NULL;
    m->piece->uncut = false;
    settle(st, m->piece);
    end_work(s, st);
}

/* Submits the piece, or its continuation, to a worker. */
static void begin(struct server *s, struct row_stream *st, struct piece *p)
{
    struct making *m = job_new(sizeof *m, run_making, end_making);
    if (m == NULL) {
        gate_visit(&st->rows.version->gate);
        make(st, p, NULL);
        gate_end_visit(&st->rows.version->gate);
        settle(st, p);
        p->uncut = false;
        return;
    }
    m->stream = st;
    m->piece = p;
    p->job = &m->job;
    st->stream.jobs++;
    job_read(s, NULL, &m->job, st->rows.version, p->part.pace.slow ? JOB_SLOW : JOB_SHORT);
}

/* ---- after an edit of the points ---- */

struct copying {
    struct job job;
    struct row_stream *stream; /* borrows: not freed before the job ends */
    struct past past;          /* owns, until it moves to the stream */
    size_t bytes;
};

static void run_copying(struct job *j)
{
    struct copying *c = (struct copying *)j;
    const struct rows *rows = &c->stream->rows;
    j->status =
        past_copy(j, rows->view, rows->surface.field, rows->surface.fields, false, &c->past);
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
    struct row_stream *st = c->stream;
    st->copying = NULL;
    st->rows.status = j->status;
    if (j->status == DT_OK) {
        st->past = c->past;
        st->past_bytes = c->bytes;
        c->past.dt = NULL;
        version_end_view(&s->sets, st->rows.version, st->rows.view);
        st->rows.view = NULL;
        use_past(&st->rows, &st->past);
    }
    for (unsigned i = 0; i < st->used && j->status == DT_OK && !st->stream.abandoned; i++) {
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

/* Whether rows continue on a copy, which is made when no piece is in work; until then none is begun. */
static bool needs_copy(const struct row_stream *st)
{
    bool needs = st->rows.surface.passed;
    for (unsigned i = 0; i < st->used; i++) {
        const struct piece *p = &st->piece[(st->head + i) % st->most];
        needs = needs || (p->job == NULL && p->part.surface.passed);
    }
    return needs;
}

/* Begins the copy if it is needed. */
static enum dt_status copy_past(struct server *s, struct row_stream *st)
{
    if (st->rows.status != DT_OK || st->stream.jobs > 0 || !needs_copy(st))
        return st->rows.status;
    struct copying *c = job_new(sizeof *c, run_copying, end_copying);
    if (c == NULL)
        return DT_NOMEM;
    c->stream = st;
    c->job.memory = server_reservation(s, BUDGET_REPLIES);
    st->copying = &c->job;
    st->stream.jobs++;
    job_read(s, NULL, &c->job, st->rows.version, JOB_LONG);
    return st->rows.status;
}

/* ---- sending ---- */

/* Whether the next rows have been made. */
static bool is_made(const struct row_stream *st)
{
    const struct piece *p = &st->piece[st->head];
    return st->used > 0 && p->job == NULL && !p->part.surface.passed;
}

/* Sends the text of the piece: all of it if it has the usual size, otherwise as much as fits into `most` bytes of out. A conversion to
 * RESP needs whole rows. */
static enum dt_status send_text(const struct server *s, const struct row_stream *st,
                                struct piece *p, struct buf *out, size_t most)
{
    enum { CONVERTED = 3 }; /* times the rows: in lines and in RESP */
    size_t n = buf_len(&p->text), room = most - buf_len(out);
    bool whole = st->converted && !st->rows.binary;
    if (whole && n > 2 * PIECE && !budget_fits(&s->budget, BUDGET_REPLIES, CONVERTED * n))
        return DT_NOMEM;
    n = whole || n <= PIECE || n < room ? n : room;
    buf_append(out, buf_head(&p->text), n); /* copied, so that the memory of a piece stays small */
    buf_consume(&p->text, n);
    return out->failed ? DT_NOMEM : DT_OK;
}

static enum dt_status send_made(struct server *s, struct row_stream *st, struct buf *out,
                                size_t most)
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
        if (!p->part.done && needs_copy(st)) {
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

/* Cuts off the next piece. False: there is none, or the set is being edited and other pieces are still to be sent.
 * If there are no other pieces then, a worker cuts it off (uncut). */
static bool cut_next(struct row_stream *st, struct piece *p)
{
    if (gate_try_visit(&st->rows.version->gate)) {
        bool cut = rows_cut(&st->rows, &p->part);
        gate_end_visit(&st->rows.version->gate);
        return cut;
    }
    p->uncut = st->used == 0;
    return p->uncut;
}

static void begin_next(struct server *s, struct row_stream *st)
{
    while (st->used < st->most && !needs_copy(st) && !(st->used > 0 && st->piece[st->head].uncut)) {
        struct piece *p = &st->piece[(st->head + st->used) % st->most];
        if (!cut_next(st, p))
            return;
        st->used++;
        begin(s, st, p);
    }
}

/* Sends finished pieces and begins others. If there was no memory for a job, the piece was made on this thread and
 * must be sent at once, because `ready` is not called for it. */
static enum dt_status go_on(struct server *s, struct row_stream *st, struct buf *out)
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

/* Whether this thread makes the next piece itself; then it is a visitor. Not while the set is being edited. */
static bool may_fill(struct row_stream *st)
{
    return st->used == 0 && !st->heavy && gate_try_visit(&st->rows.version->gate);
}

/* Makes rows right in the output, in the visit, which ends. */
static void fill(struct server *s, struct row_stream *st, struct buf *out)
{
    struct reservation memory =
        server_reservation(s, BUDGET_REPLIES); /* then it is the connection's */
    st->rows.memory = &memory;
    rows_fill(&st->rows, out, buf_len(out) + PIECE);
    gate_end_visit(&st->rows.version->gate);
    reservation_set(&memory, 0);
    if (out->cap > 4 * PIECE)
        buf_fit(out);
}

static bool refill(struct server *s, struct stream *stream, struct answer *a)
{
    struct row_stream *st = (struct row_stream *)stream;
    enum dt_status status;
    bool done;
    st->converted = a->out == &a->reactor->lines;
    if (may_fill(st)) {
        fill(s, st, a->out);
        status = copy_past(s, st); /* there are no workers: at once */
        done = st->rows.done;
    } else {
        status = go_on(s, st, a->out);
        done = st->used == 0;
    }
    a->broken = status != DT_OK;
    return status == DT_OK && !done;
}

static const struct stream_kind kind = {.refill = refill, .cancel = cancel, .clear = clear};

/* ---- its beginning ---- */

/* There are fewer pieces if they are large. */
static unsigned most_pieces(const struct row_stream *st)
{
    size_t room = piece_room(st);
    return room <= LARGE_PIECE ? PIECES : room <= 2 * LARGE_PIECE ? PIECES / 2 : 1;
}

/* False: there is no memory for the pieces. */
static bool reserve(struct server *s, struct row_stream *st)
{
    st->stream.memory = server_reservation(s, BUDGET_REPLIES);
    for (unsigned i = 0; i < PIECES; i++)
        st->piece[i].memory = st->stream.memory;
    bool good = reservation_resize(&st->stream.memory, ids_bytes(st));
    for (unsigned i = 0; st->heavy && good && i < st->most; i++)
        good = reservation_resize(&st->piece[i].memory, piece_room(st));
    for (unsigned i = 0; !good && i < st->most; i++)
        reservation_set(&st->piece[i].memory, 0);
    if (!good)
        reservation_set(&st->stream.memory, 0);
    return good;
}

bool row_stream_begin(struct server *s, struct answer *a, const struct rows *rows, bool heavy,
                      const struct places *places)
{
    struct row_stream *st = calloc(1, sizeof *st);
    if (st == NULL)
        return answer_out_of_memory(a);
    st->stream =
        (struct stream){.kind = &kind, .begun = true, .computes = row_is_computed(rows->form)};
    st->rows = *rows;
    for (size_t i = 0; i < rows->surface.fields; i++)
        st->field[i] = rows->surface.field[i];
    st->rows.surface.field = st->field;
    st->heavy = heavy && s->workers != NULL;
    st->most = most_pieces(st);
    if (!reserve(s, st)) {
        free(st);
        answer_busy(a);
        return false;
    }
    if (places != NULL)
        st->places = *places;
    version_pin(rows->version);
    a->next = ANSWER_STREAM;
    a->stream = &st->stream;
    return true;
}
