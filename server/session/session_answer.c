/* session_answer.c - processes answers: their bytes go to the connection, and the session enters the state that
 * they require. */
#include "proto/resp.h"
#include "server/bodies/load.h"
#include "server/command/command.h"
#include "server/replies/resp3.h"
#include "server/rows/stream.h"
#include "server/session/request_stats.h"
#include "server/session/session_inside.h"

/* Converts lines to RESP 3, whose types depend on the command. */
static bool reframe_typed(struct session *s, const char *lines, size_t n)
{
    const char *types = s->command != NULL ? s->command->rows : NULL;
    return resp3_reframe(&s->reader, types, lines, n, &s->conn.out);
}

enum { LINES_KEPT = 512 * 1024 };

/* Converts the reply to RESP. */
static bool reframe(struct session *s)
{
    struct buf *lines = &s->reactor->lines, *out = &s->conn.out;
    const char *head = buf_head(lines);
    size_t n = buf_len(lines);
    bool ok = s->client.typed ? reframe_typed(s, head, n) : resp_reframe(&s->reader, head, n, out);
    buf_rewind(lines, 0);
    if (lines->cap > LINES_KEPT) /* there was a long row */
        buf_free(lines);
    return ok && !out->failed;
}

bool session_deliver(struct session *s, const struct answer *a)
{
    bool framed = a->out != &s->reactor->lines || reframe(s);
    return framed && !a->broken;
}

void session_consume(struct session *s)
{
    buf_consume(&s->conn.in, s->held);
    s->held = 0;
}

/* Whether there is a reply, or the beginning of one. */
static bool has_begun(const struct answer *a)
{
    return a->next == ANSWER_DONE || (a->next == ANSWER_STREAM && a->stream->begun);
}

static void account(struct session *s, const struct answer *a)
{
    s->command = a->command;
    if (has_begun(a)) {
        request_stats_end(s, a, a->refused || s->refused);
        s->refused = false;
    } else if (a->next != ANSWER_WAIT || a->wait_for != WAIT_NOTHING) {
        s->refused = a->refused;
        request_stats_pause(s, a);
    }
}

/* The stream can continue. */
static void on_piece(void *ctx)
{
    conn_yield(&((struct session *)ctx)->conn);
}

/* Delays the reply until the log is durable. The reply of a job or a load does not exist yet. */
static void hold_reply(struct session *s, const struct answer *a)
{
    struct holders *in = &s->server->held;
    if (s->conn.closed || a->next == ANSWER_WORK || a->next == ANSWER_BODY)
        return;
    if (a->lsn != 0) {
        s->edited = a->lsn;
        hold_acknowledgement(in, &s->conn.hold, a->lsn, a->mark);
        if (s->deadline_ms != 0)
            session_limit_hold(s, a->lsn);
    }
    if (a->shown != 0)
        hold_view(in, &s->conn.hold, a->shown, a->mark);
}

/* Arranges what wakes the session, and returns the state in which the session waits for that. */
static enum session_state arrange_waiting(struct session *s, const struct answer *a)
{
    switch (a->wait_for) {
    case WAIT_JOB:
        s->job = a->job;
        return SESSION_WORKING;
    case WAIT_QUEUE:
        s->waiter.writes = a->wait_writes;
        queue_enter(a->wait, &s->waiter);
        return SESSION_WAITING;
    case WAIT_TIME:
        loop_at(s->conn.loop, &s->later, a->wait_ms);
        return SESSION_WAITING;
    case WAIT_NOTHING:
        break;
    }
    return SESSION_READING;
}

/* The same for every answer. */
static enum session_state arrange(struct session *s, const struct answer *a)
{
    switch (a->next) {
    case ANSWER_WAIT:
        return arrange_waiting(s, a);
    case ANSWER_WORK:
        s->job = a->job;
        return SESSION_WORKING;
    case ANSWER_STREAM:
        s->stream = a->stream;
        stream_notify(s->stream, on_piece, s);
        return SESSION_STREAMING;
    case ANSWER_BODY:
        s->load = a->load;
        load_notify(s->load, on_piece, s);
        break;
    case ANSWER_DONE:
        break;
    }
    return SESSION_READING;
}

/* The request has been carried out, or a worker has it. */
static void end_request(struct session *s, const struct answer *a)
{
    if ((a->lsn | a->shown) != 0)
        hold_reply(s, a);
    if (!s->waiter.called || a->next == ANSWER_WORK ||
        a->next == ANSWER_BODY) /* else see end_turn */
        queue_served(&s->waiter);
    session_consume(s);
    s->waited = s->again = false;
    if (s->load != NULL && a->next != ANSWER_BODY) {
        load_free(s->server, s->load);
        s->load = NULL;
    }
    if (a->next != ANSWER_WORK) {
        s->deadline_ms = 0;
        timer_clear(&s->deadline);
    }
    if (a->closes)
        conn_finish(&s->conn);
}

bool session_take_over(struct session *s, struct answer *a)
{
    account(s, a);
    bool delivered = session_deliver(s, a);
    s->client = a->client;
    s->state = arrange(s, a);
    if (!delivered)
        conn_close(&s->conn);
    else if (a->next == ANSWER_WAIT)
        s->again = true;
    else
        end_request(s, a);
    return delivered && !a->closes &&
           (s->state == SESSION_READING || s->state == SESSION_STREAMING);
}

bool session_refuse(struct session *s, enum reply_code code, const char *why)
{
    struct answer a;
    session_answer(s, &a);
    answer_err(&a, code, "%s", why);
    session_deliver(s, &a);
    queue_served(&s->waiter);
    conn_finish(&s->conn);
    return false;
}

bool session_refuse_line(struct session *s, enum line_fault fault)
{
    return session_refuse(s, fault == LINE_TOO_LONG ? ERR_TOOLONG : ERR_SYNTAX,
                          line_fault_text(fault));
}

/* ---- streams ---- */

/* A request counts as answered when its stream has begun. */
bool session_step_stream(struct session *s)
{
    loop_alone(s->conn.loop);
    if (s->conn.closed)
        return false;
    struct answer a;
    session_answer(s, &a);
    bool begun = s->stream->begun;
    if (s->stream->framed)
        a.out = &s->conn.out;
    a.next = ANSWER_STREAM;
    a.stream = s->stream;
    stream_refill(s->server, &a);
    if (!begun && has_begun(&a))
        request_stats_end(s, &a, a.refused);
    hold_reply(s, &a);
    bool delivered = session_deliver(s, &a), more = a.next == ANSWER_STREAM;
    if (!more)
        s->state = SESSION_READING;
    if (!delivered)
        conn_close(&s->conn);
    else if (more && conn_out_end(&s->conn) > a.mark) /* continue when this piece has been sent */
        conn_yield(&s->conn);
    return delivered && !more;
}
