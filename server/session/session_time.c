/* session_time.c - time limits: sessions that stall, that do not authenticate in time, or whose load stalls are
 * ended; and a probe detects closed connections. */
#include "server/bodies/load.h"
#include "server/clients/clients.h"
#include "server/ops/limits.h"
#include "server/rows/stream.h"
#include "server/session/session.h"
#include "server/session/session_inside.h"

enum {
    PROBE_MS = 50,     /* from the end of the input to the line that probes the client */
    LATE_AGAIN_MS = 20 /* from one look at a change that is not on the disk to the next */
};

/* Whether the session only waits for the next request. */
static bool is_listening(const struct session *s)
{
    return s->state == SESSION_READING && s->waiter.queue == NULL && buf_len(&s->conn.out) == 0;
}

/* Whether it only waits for the rest of a body. */
static bool is_receiving(const struct session *s)
{
    return s->state == SESSION_READING && s->load != NULL && s->waiter.queue == NULL &&
           (!s->load->body.complete || s->in_bulk);
}

void session_check_timeouts(struct session *s)
{
    struct conn *c = &s->conn;
    int64_t now = c->loop->awake_ms, idle_ms = (int64_t)s->server->config->idle_timeout_s * 1000;
    conn_check_timeouts(c);
    if (c->closed || c->finishing)
        return;
    if (s->client.role == ROLE_NONE && s->state != SESSION_WAITING &&
        now - s->since_ms > LIMIT_STRANGER_S * 1000) {
        notice_client(s, NOTICE_INFO, "has not authenticated in time: closed");
        session_refuse(s, ERR_TIMEOUT, "not authenticated within 10 seconds");
        conn_flush(c);
    } else if (is_receiving(s) && load_stalls(s->load, now) && !conn_has_input(c)) {
        session_refuse(s, ERR_TIMEOUT, "the points stopped coming; nothing was loaded");
        load_free(s->server, s->load);
        s->load = NULL;
        conn_flush(c);
    } else if (idle_ms > 0 && is_listening(s) && list_is_empty(&s->watching) &&
               now - c->heard_ms > idle_ms && !conn_has_input(c)) {
        session_refuse(s, ERR_TIMEOUT, "idle for too long");
        conn_flush(c);
    }
}

/* ---- replies that wait for followers ---- */

static void begin_awaited(struct session *s)
{
    if (s->awaited.lsn == 0) {
        s->awaited = s->last_awaited;
        s->last_awaited.lsn = 0;
    }
    if (s->awaited.lsn != 0)
        loop_at(s->conn.loop, &s->awaited_timer, s->awaited.at_ms);
}

void session_limit_hold(struct session *s, uint64_t lsn)
{
    if (s->conn.hold.groups == 0)
        return;
    s->last_awaited = (struct session_awaited){lsn, s->deadline_ms + 1};
    if (!timer_is_set(&s->awaited_timer))
        begin_awaited(s);
}

/* The change has been made, so the reply is not TIMEOUT. Waiting for the disk has no limit. */
void session_on_awaited(struct timer *t)
{
    struct session *s = (struct session *)((char *)t - offsetof(struct session, awaited_timer));
    const struct holders *in = &s->server->held;
    bool held = s->conn.hold.groups > 0;
    if (s->conn.closed)
        return;
    if (held && s->awaited.lsn > in->durable && s->awaited.lsn <= in->saved) {
        session_not_saved(&s->conn.hold);
        return;
    }
    if (held && s->awaited.lsn > in->saved)
        s->awaited.at_ms = s->conn.loop->now_ms + LATE_AGAIN_MS;
    else
        s->awaited.lsn = 0;
    begin_awaited(s);
}

/* ---- stopping ---- */

void session_break_off(struct session *s, int64_t waited_ms)
{
    const struct conn *c = &s->conn;
    bool computes = s->state == SESSION_STREAMING && s->stream->computes;
    bool unread = s->state != SESSION_WORKING && conn_sendable(c) > 0;
    if (computes || (unread && c->loop->awake_ms - c->progress_ms >= waited_ms))
        conn_close(&s->conn);
}

void session_evict(struct session *s)
{
    if (!s->conn.finishing)
        session_refuse(s, ERR_BUSY, "too many clients, and this one has not authenticated");
    conn_flush(&s->conn);
    conn_close(&s->conn);
}

void session_probe(struct session *s)
{
    if (!s->probed && !timer_is_set(&s->probe))
        loop_at(s->conn.loop, &s->probe, s->conn.loop->now_ms + PROBE_MS);
}

void session_on_probe(struct timer *t)
{
    struct session *s = (struct session *)((char *)t - offsetof(struct session, probe));
    if (s->state != SESSION_WORKING || s->conn.closed)
        return;
    s->probed = s->job->what != NULL;
    session_progress(s, s->job);
}
