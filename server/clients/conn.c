/* conn.c - see conn.h. */
#include "server/clients/conn.h"

#include "server/ops/limits.h"

#include <errno.h>
#include <stddef.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    SMALL_INPUT = 4 * 1024, /* with more input than this a connection yields in a long turn */
    READ_SIZE = 64 * 1024,
    RECEIVE_SIZE = 256 * 1024, /* stays in the processor's cache until it has been parsed */
    LINGER_MS = 2000,
    LINGER_BYTES = 64 * 1024 * 1024
};

static void run_turn(struct task *task)
{
    struct conn *c = (struct conn *)((char *)task - offsetof(struct conn, turn));
    c->yielded = false;
    conn_turn(c);
}

static void run_disposal(struct task *task)
{
    struct conn *c = (struct conn *)((char *)task - offsetof(struct conn, disposal));
    if (task_is_queued(&c->turn)) { /* since before it was closed: freed after that has run */
        loop_dispose(c->loop, task);
        return;
    }
    close(~c->source.fd);
    buf_free(&c->in);
    buf_free(&c->out);
    reservation_set(&c->memory, 0);
    c->events->closed(c);
}

static void on_ready(struct source *source, uint32_t events);

bool conn_init(struct conn *c, struct loop *loop, int fd, const struct conn_events *events,
               const struct reservation *memory)
{
    *c = (struct conn){.source = {fd, on_ready, .shares = true},
                       .loop = loop,
                       .events = events,
                       .memory = *memory,
                       .owner_bytes = memory->bytes,
                       .interest = EPOLLIN};
    c->turn = (struct task){.run = run_turn, .shares = true};
    c->hold.reactor = loop->lane;
    c->disposal.run = run_disposal;
    c->progress_ms = c->heard_ms = loop->awake_ms;
    return loop_watch(loop, &c->source, c->interest);
}

void conn_again(struct conn *c)
{
    if (!c->closed)
        loop_defer(c->loop, &c->turn);
}

void conn_yield(struct conn *c)
{
    if (c->closed || task_is_queued(&c->turn))
        return;
    c->yielded = true;
    loop_yield(c->loop, &c->turn);
}

void conn_close(struct conn *c)
{
    if (c->closed)
        return;
    c->closed = true;
    hold_clear(&c->hold);
    loop_forget(c->loop, &c->source);
    c->source.fd = ~c->source.fd; /* closed by the disposal, since it takes the system a while */
    loop_dispose(c->loop, &c->disposal);
}

void conn_finish(struct conn *c)
{
    c->finishing = true;
}

void conn_drain(struct conn *c)
{
    c->draining = true;
    conn_again(c);
}

/* ---- buffers: borrowed from the loop while there is data to process ---- */

static void borrow(struct buf *mine, struct buf *spare)
{
    if (mine->cap == 0) {
        *mine = *spare;
        *spare = (struct buf){0};
    }
}

static void give_back(struct buf *mine, struct buf *spare)
{
    if (buf_len(mine) == 0 && mine->cap > 0) {
        if (spare->cap == 0 && mine->cap <= 2 * CONN_IN_LIMIT) {
            *spare = *mine;
            spare->start = spare->end = 0;
            spare->failed = false;
            *mine = (struct buf){0};
        } else {
            buf_free(mine);
        }
    }
}

/* Moves a short rest of input (an incomplete line) from the borrowed block into one of its own. */
static void keep_small(struct conn *c)
{
    struct buf small = {0};
    if (c->in.cap <= CONN_SMALL || buf_len(&c->in) >= CONN_SMALL)
        return;
    buf_append(&small, buf_head(&c->in), buf_len(&c->in));
    if (small.failed)
        return;
    buf_consume(&c->in, buf_len(&c->in));
    give_back(&c->in, &c->loop->spare_in);
    c->in = small;
}

/* ---- input ---- */

static bool wants_input(const struct conn *c)
{
    if (c->eof)
        return false;
    if (c->lingering)
        return true;
    size_t n = buf_len(&c->in);
    return !c->finishing && n < CONN_IN_LIMIT && !conn_full(c) &&
           (n < CONN_SMALL || !conn_is_short(c));
}

static void on_read_error(struct conn *c)
{
    if (errno == EAGAIN || errno == EWOULDBLOCK)
        c->eof = c->draining;
    else if (errno != EINTR)
        conn_close(c);
}

static void drop_input(struct conn *c)
{
    char scratch[16 * 1024];
    ssize_t n = recv(c->source.fd, scratch, sizeof scratch, 0);
    if (n < 0) {
        on_read_error(c);
        return;
    }
    c->dropped += (size_t)n;
    if (n == 0 || c->dropped > LINGER_BYTES)
        conn_close(c);
}

/* Receives the bytes that the socket has now, at most n. */
static size_t receive_now(struct conn *c, char *bytes, size_t n)
{
    ssize_t got = recv(c->source.fd, bytes, n, 0);
    if (got < 0) {
        on_read_error(c);
        return 0;
    }
    c->eof = got == 0;
    c->heard_ms = c->loop->awake_ms;
    return (size_t)got;
}

static void read_input(struct conn *c)
{
    size_t most = conn_is_short(c) ? CONN_SMALL : READ_SIZE;
    borrow(&c->in, &c->loop->spare_in);
    char *to = buf_reserve(&c->in, most);
    if (to == NULL)
        conn_close(c);
    else
        buf_commit(&c->in, receive_now(c, to, most));
}

size_t conn_receive(struct conn *c, char *bytes, size_t n)
{
    if (c->eof || c->closed)
        return 0;
    return receive_now(c, bytes, n < RECEIVE_SIZE ? n : RECEIVE_SIZE);
}

/* ---- output ---- */

/* Sends the bytes that the socket takes now; a failure that closes the connection counts as no bytes. */
static size_t send_now(struct conn *c, const void *bytes, size_t n)
{
    ssize_t sent;
    do
        sent = send(c->source.fd, bytes, n, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK)
        conn_close(c);
    if (sent <= 0)
        return 0;
    c->sent += (uint64_t)sent;
    c->progress_ms = c->loop->awake_ms;
    return (size_t)sent;
}

static void send_output(struct conn *c)
{
    for (size_t most; (most = conn_sendable(c)) > 0;) {
        size_t n = send_now(c, buf_head(&c->out), most);
        if (n == 0)
            return;
        buf_consume(&c->out, n);
    }
    c->progress_ms = c->loop->awake_ms;
}

bool conn_write(struct conn *c, const void *bytes, size_t n)
{
    size_t sent = 0;
    if (buf_len(&c->out) == 0 && c->hold.groups == 0)
        sent = send_now(c, bytes, n);
    if (c->closed || sent == n)
        return !c->closed;
    buf_append(&c->out, (const char *)bytes + sent, n - sent);
    if (c->out.failed)
        conn_close(c);
    conn_again(c);
    return false;
}

static void finish_if_sent(struct conn *c)
{
    if (c->closed || !c->finishing || c->lingering || buf_len(&c->out) > 0)
        return;
    if (c->eof) {
        conn_close(c);
        return;
    }
    shutdown(c->source.fd, SHUT_WR);
    c->lingering = true;
    c->linger_ms = c->loop->awake_ms;
}

/* ---- turns ---- */

static void settle(struct conn *c)
{
    if (c->closed)
        return;
    if (c->finishing)
        buf_consume(&c->in, buf_len(&c->in));
    give_back(&c->in, &c->loop->spare_in);
    give_back(&c->out, &c->loop->spare_out);
    keep_small(c);
    if (c->wants_room && !conn_full(c)) {
        c->wants_room = false;
        c->events->room(c);
    }
    reservation_set(&c->memory, c->owner_bytes + c->in.cap + c->out.cap);
    uint32_t interest =
        (wants_input(c) ? (uint32_t)EPOLLIN : 0) | (conn_sendable(c) > 0 ? (uint32_t)EPOLLOUT : 0);
    if (interest != c->interest) {
        c->interest = interest;
        loop_change(c->loop, &c->source, interest);
    }
}

void conn_flush(struct conn *c)
{
    if (c->closed)
        return;
    send_output(c);
    conn_again(c);
}

void conn_turn(struct conn *c)
{
    if (c->closed)
        return;
    if (c->draining && !c->lingering && wants_input(c)) {
        if (!c->receives)
            read_input(c);
        conn_again(c);
    }
    send_output(c);
    if (!c->closed && !c->finishing && !conn_full(c)) {
        borrow(&c->out, &c->loop->spare_out);
        c->events->data(c);
        loop_share(c->loop);
        if (!c->closed)
            send_output(c);
    }
    finish_if_sent(c);
    settle(c);
}

/* The turn of a connection that has yielded: it sends, without a call of `data`. It receives no more until that call, so its
 * input does not grow while it waits. */
static void send_and_settle(struct conn *c)
{
    send_output(c);
    settle(c);
}

static void on_ready(struct source *source, uint32_t events)
{
    struct conn *c = (struct conn *)source;
    bool readable = (events & EPOLLIN) != 0 && wants_input(c);
    if ((events & EPOLLERR) != 0 || ((events & EPOLLHUP) != 0 && !readable)) {
        conn_close(c);
        return;
    }
    if (readable && c->lingering)
        drop_input(c);
    else if (readable && !c->receives && !c->yielded)
        read_input(c);
    if (c->closed)
        return;
    bool much = c->receives || buf_len(&c->in) > SMALL_INPUT || (events & EPOLLOUT) != 0;
    if (much && loop_is_late(c->loop, clock_ns()))
        conn_yield(c);
    if (c->yielded)
        send_and_settle(c);
    else
        conn_turn(c);
}

/* Whether it does not read although a request has begun: its output is full, or memory was short when
 * its last turn ended. In the latter case there may be no other event that leads to a turn. */
static bool may_be_stuck(const struct conn *c)
{
    return (c->interest & EPOLLIN) == 0 && !c->eof && buf_len(&c->in) >= CONN_SMALL;
}

static bool is_stalled(const struct conn *c)
{
    return conn_sendable(c) > 0 && c->loop->awake_ms - c->progress_ms > LIMIT_STALL_S * 1000;
}

/* Closes it, unless the socket takes something now: the daemon may have been stopped. */
static void judge_stalled(struct conn *c)
{
    send_output(c);
    if (is_stalled(c))
        conn_close(c);
}

bool conn_has_input(const struct conn *c)
{
    int n = 0;
    return ioctl(c->source.fd, FIONREAD, &n) == 0 && n > 0;
}

void conn_check_timeouts(struct conn *c)
{
    if (c->lingering && c->loop->awake_ms - c->linger_ms > LINGER_MS)
        conn_close(c);
    else if (is_stalled(c))
        judge_stalled(c);
    else if (may_be_stuck(c))
        conn_again(c);
}
