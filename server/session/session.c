/* session.c - see session.h. */
#include "server/session/session.h"

#include "proto/line.h"
#include "proto/request.h"
#include "proto/resp.h"
#include "server/bodies/load.h"
#include "server/clients/clients.h"
#include "server/command/command.h"
#include "server/command/prefetch.h"
#include "server/ops/limits.h"
#include "server/redis/redis.h"
#include "server/rows/stream.h"
#include "server/session/request_stats.h"
#include "server/session/session_inside.h"
#include "server/watch/watch.h"

#include <stddef.h>
#include <stdlib.h>

enum {
    TURN_NS = 250 * 1000,      /* after which the session yields */
    LATE_TURN_NS = 100 * 1000, /* the same if the loop's turn is already long */
    BATCH_NS = 1000 * 1000,    /* the same while there are prefetched requests */
    STEPS_PER_LOOK = 16        /* the clock is read after this number of the quickest requests */
};

/* Whether a request is too long before AUTH. */
static bool is_too_much(const struct session *s, size_t bytes, size_t words)
{
    return s->client.role == ROLE_NONE &&
           (bytes > LIMIT_STRANGER_BYTES || words > LIMIT_STRANGER_WORDS);
}

static bool refuse_stranger(struct session *s)
{
    return session_refuse(s, ERR_TOOLONG,
                          "before AUTH a request has at most 10 words and 16384 bytes");
}

/* Whether the request has waited beyond its deadline. */
static bool is_late(const struct session *s)
{
    return s->deadline_ms != 0 && s->held > 0 && s->conn.loop->now_ms > s->deadline_ms;
}

/* A session that a queue has called keeps its turn for all requests that it carries out at once, because a turn
 * for each request of a pipeline would double the cost. Then the next waiter is called. The turn is also kept
 * while a request is still to be carried out. */
static void end_turn(struct session *s)
{
    if (s->waiter.called && s->held == 0 && s->load == NULL)
        queue_served(&s->waiter);
}

/* Answers with ERR TIMEOUT. */
static bool give_up(struct session *s)
{
    s->timed_out = true;
    timer_clear(&s->later);
    struct answer a;
    session_answer(s, &a);
    answer_status(&a, DT_CANCELLED);
    bool next = session_take_over(s, &a);
    end_turn(s);
    return next;
}

void session_set_deadline(struct session *s)
{
    if (s->limit_ms > 0 && s->deadline_ms == 0) {
        s->deadline_ms = s->conn.loop->now_ms + s->limit_ms;
        loop_at(s->conn.loop, &s->deadline, s->deadline_ms + 1);
    }
    s->timed_out = false;
}

/* Leaves the request to a later turn of the loop. When thousands of clients send one at the same moment, all requests
 * together may take long, and events of other clients come first. */
static bool leave_for_later(struct session *s, const struct request *q)
{
    if (!s->late || s->waiter.called || command_is_quick(s->server, s->reactor, q))
        return false;
    s->held = 0;
    conn_yield(&s->conn);
    return true;
}

/* The deadline counts from the first attempt to carry out the request. */
static void take_timeout(struct session *s, struct request *q)
{
    command_take_timeout(q, &s->limit_ms);
    session_set_deadline(s);
}

/* Shares the world with other reactors, if there are any, or is alone in it, as the request requires. False: the session has been ended
 * meanwhile. */
static inline bool enter_world(struct session *s, const struct request *q)
{
    if (s->conn.loop->world == NULL)
        return true;
    if (!s->again && s->waiter.queue == NULL && command_shares(s->server, s->reactor, q))
        loop_share(s->conn.loop);
    else
        loop_alone(s->conn.loop);
    return !s->conn.closed && !s->conn.finishing;
}

/* ---- steps: each carries out one request, or a piece of one; true: continue ---- */

bool session_input_ended(const struct session *s)
{
    return s->conn.eof && !s->conn.draining;
}

bool session_wait_for_input(struct session *s)
{
    if (s->conn.eof)
        conn_finish(&s->conn);
    else if (buf_len(&s->conn.in) >= CONN_SMALL && conn_is_short(&s->conn))
        return session_refuse(s, ERR_BUSY, "not enough memory for such a long request; try again");
    return false;
}

/* Carries out a request in RESP framing, as Redis's or as ours. */
static void run_resp(struct session *s, const struct request *q, const struct resp *resp,
                     struct answer *a)
{
    a->out = &s->conn.out;
    if (!redis_answer(s->server, q, a)) {
        a->out = &s->reactor->lines;
        command_run(s->server, q, a);
    }
    s->in_bulk = a->next == ANSWER_BODY && resp->has_body;
    s->bulk_left = resp->body;
    a->closes |= resp->has_body && a->next == ANSWER_DONE;
}

/* resp NULL: the request is a line; http: it looks like the first line of an HTTP request. */
static bool carry_out(struct session *s, const struct resp *resp, bool http)
{
    struct request *q = &s->reactor->request;
    s->greeted = s->greeted || resp != NULL;
    if (q->n == 0) {
        session_consume(s);
        return true;
    }
    if (is_too_much(s, s->held, q->n))
        return refuse_stranger(s);
    const struct word *name = &q->word[0];
    bool browser = resp == NULL && (http || name->text[name->len - 1] == ':');
    s->greeted = true;
    if (browser) { /* against its user's will */
        notice_client(s, NOTICE_WARNING,
                      "does not speak the protocol, but HTTP, for instance: closed");
        conn_finish(&s->conn);
        return false;
    }
    if (leave_for_later(s, q))
        return false;
    take_timeout(s, q);
    if (!enter_world(s, q))
        return false;
    struct answer a;
    session_answer(s, &a);
    if (resp != NULL)
        run_resp(s, q, resp, &a);
    else
        command_run(s->server, q, &a);
    return session_take_over(s, &a);
}

static bool step_line(struct session *s)
{
    struct line line;
    ptrdiff_t took =
        line_read(buf_head(&s->conn.in), buf_len(&s->conn.in), session_input_ended(s), &line);
    if (took < 0)
        return session_refuse_line(s, line.fault);
    if (took > 0) {
        s->held = (size_t)took;
        if (!request_split(&s->reactor->request, line.text, line.len))
            return session_refuse(s, ERR_NOMEM, "out of memory; nothing has changed");
        return carry_out(s, NULL, !s->greeted && line_is_http(line.text, line.len));
    }
    if (is_too_much(s, buf_len(&s->conn.in), 0))
        return refuse_stranger(s);
    return session_wait_for_input(s);
}

static bool step_resp(struct session *s)
{
    struct resp resp;
    struct buf *in = &s->conn.in;
    ptrdiff_t took = resp_read(buf_head(in), buf_len(in), &s->reactor->request, &resp);
    s->need = resp.need;
    if (took == 0 && is_too_much(s, buf_len(in) > s->need ? buf_len(in) : s->need, 0))
        return refuse_stranger(s);
    if (took == 0)
        return session_wait_for_input(s);
    if (took > 0) {
        s->held = (size_t)took;
        return carry_out(s, &resp, false);
    }
    static const enum reply_code code[] = {
        [RESP_BROKEN] = ERR_SYNTAX, [RESP_TOO_LONG] = ERR_TOOLONG, [RESP_NOMEM] = ERR_NOMEM};
    return session_refuse(s, code[resp.fault], resp_fault_text(resp.fault));
}

static bool step_request(struct session *s)
{
    stats_resume(&s->reactor->stats, &s->pause);
    if (is_late(s))
        return give_up(s);
    struct buf *in = &s->conn.in;
    if (buf_len(in) == 0 || buf_len(in) < s->need)
        return session_wait_for_input(s);
    s->resp = buf_head(in)[0] == '*';
    if (s->resp || s->greeted) {
        size_t took = prefetch_take(s->server, s->reactor, buf_head(in), buf_len(in));
        if (took > 0) {
            s->held = took;
            s->need = 0;
            return carry_out(s, s->resp ? &(struct resp){0} : NULL, false);
        }
    }
    return s->resp ? step_resp(s) : step_line(s);
}

static bool step(struct session *s)
{
    if (s->state == SESSION_WAITING || s->state == SESSION_WORKING)
        return false;
    if (conn_full(&s->conn)) { /* gives up its turn: the client may not read for long */
        queue_served(&s->waiter);
        conn_yield(&s->conn);
        return false;
    }
    if (s->state == SESSION_STREAMING)
        return session_step_stream(s);
    return s->load != NULL ? session_step_load(s) : step_request(s);
}

/* ---- events of the connection ---- */

/* Whether the session has used up its time. Prefetched requests are still carried out, because the prefetched data
 * is lost when the session yields. */
static bool has_had_its_turn(const struct session *s, int64_t start, bool late)
{
    int64_t spent = s->reactor->stats.mark_ns - start;
    return spent > (late ? LATE_TURN_NS : TURN_NS) &&
           (spent > BATCH_NS || !prefetch_has_more(s->reactor->prefetch));
}

static void on_data(struct conn *c)
{
    struct session *s = (struct session *)c;
    struct stats *stats = &s->reactor->stats;
    if (s->waiter.queue != NULL) /* which may call the next one when this one has been served */
        loop_alone(c->loop);
    int64_t start = stats_look(stats);
    bool late = loop_is_late(c->loop, start);
    prefetch_forget(s->reactor->prefetch);
    s->late = late;
    for (unsigned n = 1; step(s); n++) {
        s->late = false;
        if (n % STEPS_PER_LOOK == 0 || s->load != NULL)
            stats_look(stats);
        if (has_had_its_turn(s, start, late)) { /* slower requests read the clock, too */
            conn_yield(c);
            break;
        }
    }
    if (stats->run > 0)
        stats_look(stats);
    end_turn(s);
    if (c->eof && s->state == SESSION_WORKING)
        session_probe(s);
}

static void on_room(struct conn *c)
{
    loop_alone(c->loop);
    watch_resume((struct session *)c);
}

static void on_closed(struct conn *c)
{
    struct session *s = (struct session *)c;
    queue_served(&s->waiter);
    timer_clear(&s->later);
    timer_clear(&s->deadline);
    timer_clear(&s->awaited_timer);
    timer_clear(&s->probe);
    if (s->state == SESSION_WORKING)
        s->job->cancel = true;
    if (s->state == SESSION_STREAMING)
        stream_free(s->server, s->stream);
    if (s->load != NULL)
        load_free(s->server, s->load);
    watch_leave(s);
    list_move(&s->server->temporary, &s->temporary);
    if (s->closed != NULL)
        s->closed(s);
    free(s->name);
    free(s);
}

static void on_wake(struct waiter *w)
{
    struct session *s = list_owner(&w->link, offsetof(struct session, waiter));
    s->state = SESSION_READING;
    conn_again(&s->conn);
}

static void on_later(struct timer *t)
{
    struct session *s = (struct session *)((char *)t - offsetof(struct session, later));
    s->waited = true;
    s->state = SESSION_READING;
    conn_again(&s->conn);
}

/* The deadline has passed. The request is answered now if it waits in a queue. A job is cancelled, and its end brings the
 * answer. */
static void pass_deadline(struct timer *t)
{
    struct session *s = (struct session *)((char *)t - offsetof(struct session, deadline));
    bool in_line = s->waiter.queue != NULL || s->state == SESSION_WAITING;
    if (s->conn.closed)
        return;
    s->timed_out = true;
    if (s->state == SESSION_WORKING) {
        s->job->cancel = true;
    } else if (in_line) {
        give_up(s);
        conn_again(&s->conn);
    }
}

struct session *session_new(struct server *server, struct reactor *reactor, int fd,
                            const struct sock_peer *peer, void (*closed)(struct session *s))
{
    static const struct conn_events events = {
        .data = on_data, .room = on_room, .closed = on_closed};
    struct session *s = calloc(1, sizeof *s);
    if (s == NULL)
        return NULL;
    s->server = server;
    s->reactor = reactor;
    s->client.role = auth_initial_role(&server->auth);
    s->since_ms = reactor->loop.awake_ms;
    s->peer = *peer;
    s->command = NULL;
    s->waiter.wake = on_wake;
    s->probe.run = session_on_probe;
    s->later.run = on_later;
    s->deadline.run = pass_deadline;
    s->awaited_timer.run = session_on_awaited;
    s->closed = closed;
    struct reservation memory = server_reservation(server, BUDGET_CLIENTS);
    reservation_set(&memory, sizeof *s);
    if (conn_init(&s->conn, &reactor->loop, fd, &events, &memory))
        return s;
    reservation_set(&memory, 0);
    free(s);
    return NULL;
}

/* ---- events of the log ---- */

static struct session *session_of(struct hold *h)
{
    return (struct session *)(void *)((char *)h - offsetof(struct session, conn.hold));
}

void session_released(struct hold *h)
{
    conn_again(&session_of(h)->conn);
}

void session_not_saved(struct hold *h)
{
    struct session *s = session_of(h);
    struct conn *c = &s->conn;
    buf_rewind(&c->out, conn_sendable(c));
    hold_clear(h);
    queue_served(&s->waiter);
    struct answer a;
    session_answer(s, &a);
    if ((s->server->held.failing & HOLD_DISK) != 0)
        answer_err(&a, ERR_IO,
                   "the disk has failed: it is unknown whether the last changes were saved");
    else
        answer_err(&a, ERR_NOFOLLOWERS,
                   "too few followers have the last changes, which are saved here");
    bool delivered = session_deliver(s, &a);
    if (s->state == SESSION_WORKING || s->state == SESSION_STREAMING || !delivered || c->out.failed)
        conn_close(c); /* nothing may follow that line */
    else
        conn_finish(c);
    conn_again(c);
}

/* ---- events of the workers ---- */

/* The next request is carried out in the next turn of the loop: otherwise a client with a pipeline would overtake requests
 * that already wait for the set. */
void session_job_done(struct session *s, struct job *j)
{
    struct answer a;
    session_answer(s, &a);
    size_t mark = buf_len(a.out);
    timer_clear(&s->probe);
    s->state = SESSION_READING;
    bool room = buf_reserve(a.out, REPLY_ERR_ROOM) != NULL;
    request_stats_job(s, j);
    job_finish(s->server, j, &a);
    if (a.out->failed && room)
        command_out_of_memory(s->server, &a, mark);
    session_take_over(s, &a);
    if (!room)
        conn_close(&s->conn);
    end_turn(s);
    conn_again(&s->conn);
}

void session_progress(struct session *s, const struct job *j)
{
    if (j->what == NULL || s->resp || buf_len(&s->conn.out) > 0)
        return;
    reply_comment(&s->conn.out, "progress %u %s", j->progress, j->what);
    if (s->conn.out.failed)
        buf_free(&s->conn.out);
    conn_flush(&s->conn);
}

void session_progress_waiting(const struct job *j)
{
    enum { MOST = 100 };
    const struct request_queue *queue = j->set != NULL ? &j->set->queue : j->waiting;
    const struct list *waiting = queue != NULL ? &queue->waiting : NULL;
    struct list_link *at = waiting != NULL ? list_first(waiting) : NULL, *next;
    for (int n = 0; at != NULL && n < MOST; n++, at = next) {
        next = list_next(waiting, at);
        session_progress(list_owner(at, offsetof(struct session, waiter)), j);
    }
}
