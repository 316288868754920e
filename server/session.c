/* session.c - see session.h. */
#include "server/session.h"

#include "proto/line.h"
#include "proto/request.h"
#include "server/cmd_load.h"
#include "server/command.h"
#include "server/stream.h"

#include <stddef.h>
#include <stdlib.h>

enum {
    TURN_NS = 500 * 1000,  /* after this long it is somebody else's turn */
    STEPS_PER_LOOK = 16,   /* requests between looks at the clock */
    FEED_BYTES = 64 * 1024 /* of a load, in one step */
};

/* ---- what an answer leaves to do ---- */

static struct answer new_answer(struct session *s)
{
    return (struct answer){.out = &s->conn.out, .owner = s->id, .role = s->role};
}

static void consume_held(struct session *s)
{
    buf_consume(&s->conn.in, s->held);
    s->held = 0;
}

/* Whether the next request may be looked at right now. */
static bool take_over(struct session *s, const struct answer *a)
{
    s->role = a->role;
    s->stream = a->stream;
    s->job = a->job;
    if (a->broken) {
        conn_close(&s->conn);
        return false;
    }
    if (a->wait != NULL) {
        dataset_wait(a->wait, &s->waiter);
        return false;
    }
    if (a->again || a->retry) /* the request itself is still to be carried out */
        return a->retry;
    consume_held(s);
    if (a->load != NULL)
        s->load = a->load;
    if (a->close)
        conn_finish(&s->conn);
    return !a->close && s->job == NULL;
}

/* Refuses what cannot be understood, and whatever follows it. */
static bool refuse(struct session *s, enum reply_code code, const char *why)
{
    reply_err(&s->conn.out, code, "%s", why);
    conn_finish(&s->conn);
    return false;
}

static bool refuse_line(struct session *s, enum line_fault fault)
{
    return refuse(s, fault == LINE_TOO_LONG ? ERR_TOOLONG : ERR_SYNTAX, line_fault_text(fault));
}

/* ---- steps: each carries out one request, or a piece of one; true: go on ---- */

/* Whether the end of what is there is the end of a line. When the daemon stops it is not: it may
 * have been cut. */
static bool input_ended(const struct session *s)
{
    return s->conn.eof && !s->conn.draining;
}

static bool step_stream(struct session *s)
{
    struct answer a = new_answer(s);
    a.stream = s->stream;
    stream_refill(s->server, &a);
    s->stream = a.stream;
    s->job = a.job;
    if (a.broken) {
        conn_close(&s->conn);
        return false;
    }
    if (s->stream != NULL) /* go on when this piece is out */
        conn_again(&s->conn);
    return s->stream == NULL && s->job == NULL;
}

static bool commit_load(struct session *s)
{
    struct answer a = new_answer(s);
    size_t mark = buf_len(a.out);
    if (buf_reserve(a.out, REPLY_ERR_ROOM) == NULL) {
        conn_close(&s->conn);
        return false;
    }
    load_commit(s->server, s->load, &a);
    if (a.out->failed)
        command_out_of_memory(s->server, &a, mark);
    if (a.wait == NULL) {
        load_free(s->server, s->load);
        s->load = NULL;
    }
    return take_over(s, &a);
}

static bool step_load(struct session *s)
{
    struct buf *in = &s->conn.in;
    size_t n = buf_len(in) < FEED_BYTES ? buf_len(in) : FEED_BYTES;
    bool last = input_ended(s) && n == buf_len(in);
    if (!s->load->body.complete) {
        ptrdiff_t took = load_feed(s->server, s->load, buf_head(in), n, last);
        /* A line longer than a step's bytes: once more with all there is. */
        if (took == 0 && n < buf_len(in))
            took = load_feed(s->server, s->load, buf_head(in), buf_len(in), input_ended(s));
        if (took < 0)
            return refuse_line(s, s->load->body.line_fault);
        buf_consume(in, (size_t)took);
        if (took == 0 && !s->load->body.complete) {
            if (s->conn.eof)
                conn_finish(
                    &s->conn); /* the daemon stops; what has not arrived whole is not carried out */
            return false;
        }
    }
    return !s->load->body.complete || commit_load(s);
}

/* Whether a line is no request but something that a browser was made to send. */
static bool is_foreign(struct session *s, const struct line *line, const struct request *q)
{
    const struct word *name = &q->word[0];
    bool first = !s->greeted;
    s->greeted = true;
    return (first && line_is_http(line->text, line->len)) || name->text[name->len - 1] == ':';
}

static bool carry_out(struct session *s, const struct line *line)
{
    struct request *q = &s->server->request;
    if (!request_split(q, line->text, line->len))
        return refuse(s, ERR_NOMEM, "out of memory; nothing has changed");
    if (q->n == 0) {
        consume_held(s);
        return true;
    }
    if (is_foreign(s, line, q)) {
        conn_finish(&s->conn);
        return false;
    }
    if (q->word[0].text[0] == '*')
        return refuse(s, ERR_SYNTAX, "RESP framing is not spoken here; send lines");
    struct answer a = new_answer(s);
    command_run(s->server, q, &a);
    return take_over(s, &a);
}

static bool step_request(struct session *s)
{
    struct line line;
    ptrdiff_t took = line_read(buf_head(&s->conn.in), buf_len(&s->conn.in), input_ended(s), &line);
    if (took < 0)
        return refuse_line(s, line.fault);
    if (took > 0) {
        s->held = (size_t)took;
        return carry_out(s, &line);
    }
    if (s->conn.eof)
        conn_finish(&s->conn);
    return false;
}

static bool step(struct session *s)
{
    if (s->job != NULL || s->waiter.set != NULL)
        return false;
    if (conn_full(&s->conn)) {
        conn_again(&s->conn);
        return false;
    }
    if (s->stream != NULL)
        return step_stream(s);
    return s->load != NULL ? step_load(s) : step_request(s);
}

/* ---- what the connection tells ---- */

static void on_data(struct conn *c)
{
    struct session *s = (struct session *)c;
    int64_t start = clock_ns();
    for (unsigned n = 1; step(s); n++) {
        if (n % STEPS_PER_LOOK == 0 && clock_ns() - start > TURN_NS) {
            conn_again(c);
            return;
        }
    }
}

static void on_closed(struct conn *c)
{
    struct session *s = (struct session *)c;
    dataset_wait_no_more(&s->waiter);
    if (s->job != NULL)
        s->job->cancel = true;
    if (s->stream != NULL)
        stream_free(&s->server->sets, s->stream);
    if (s->load != NULL)
        load_free(s->server, s->load);
    if (s->closed != NULL)
        s->closed(s);
    free(s);
}

static void on_wake(struct waiter *w)
{
    struct session *s = (struct session *)((char *)w - offsetof(struct session, waiter));
    conn_again(&s->conn);
}

struct session *session_new(struct server *server, struct loop *loop, int fd,
                            void (*closed)(struct session *s))
{
    static const struct conn_events events = {.data = on_data, .closed = on_closed};
    struct session *s = calloc(1, sizeof *s);
    if (s == NULL)
        return NULL;
    s->server = server;
    s->role = auth_initial_role(&server->auth);
    s->waiter.wake = on_wake;
    s->closed = closed;
    if (conn_init(&s->conn, loop, fd, &events))
        return s;
    free(s);
    return NULL;
}

/* ---- what the workers tell ---- */

void session_job_done(struct session *s, struct job *j)
{
    struct answer a = new_answer(s);
    size_t mark = buf_len(a.out);
    s->job = NULL;
    a.broken = buf_reserve(a.out, REPLY_ERR_ROOM) == NULL;
    job_finish(s->server, j, &a);
    if (a.out->failed && !a.broken)
        command_out_of_memory(s->server, &a, mark);
    if (take_over(s, &a) || s->stream != NULL)
        conn_turn(&s->conn);
}

void session_progress(struct session *s, const struct job *j)
{
    if (j->what == NULL || buf_len(&s->conn.out) > 0)
        return;
    reply_comment(&s->conn.out, "progress %u %s", j->progress, j->what);
    if (s->conn.out.failed)
        buf_free(&s->conn.out);
    conn_turn(&s->conn);
}
