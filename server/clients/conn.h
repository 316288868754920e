/* conn.h - one client's byte streams: input that is not consumed yet, and output that is not sent yet.
 *
 * A connection does not know the protocol. It calls its owner back: `data` when bytes have arrived, the
 * input has ended, the output has drained, or the owner asked for another turn; `closed` as the last
 * call, in which the owner frees it. It stops reading while too much is unconsumed or unsent, and has
 * no buffers while it is idle. Its buffers count as memory of clients; when memory is short, it reads
 * and produces only as much as fits into small ones.
 *
 * A connection receives and sends while its loop shares the world (loop.h). `data` and `room` are called in that state, `closed`
 * when the loop is alone.
 *
 * End of input is not disconnection: a client that closed its sending side still gets every reply.
 * Only an error, a hang-up or a failed write means that the client has disconnected. */
#pragma once

#include "proto/buf.h"
#include "server/disk/reply_hold.h"
#include "server/sets/budget.h"
#include "server/system/loop.h"

enum {
    /* unconsumed bytes from which on nothing is read; more than the longest line */
    CONN_IN_LIMIT = 160 * 1024,
    CONN_OUT_LIMIT = 64 * 1024, /* unsent bytes from which on the owner should produce no more */
    CONN_SMALL = 4 * 1024       /* both limits when memory is short */
};

struct conn;

struct conn_events {
    void (*data)(struct conn *c);
    void (*room)(struct conn *c);   /* `wants_room` was set, and there is room in `out` */
    void (*closed)(struct conn *c); /* frees it */
};

struct conn {
    struct source source; /* first: the loop's view */
    struct loop *loop;
    const struct conn_events *events;
    struct buf in, out;
    struct reservation memory; /* of its owner, and of the buffers */
    size_t owner_bytes;        /* the owner's share */
    uint64_t sent;             /* bytes sent so far */
    /* bytes of `out` that must not be sent before the log is durable; see reply_hold.h */
    struct hold hold;
    struct task turn, disposal;
    uint32_t interest;   /* the events that epoll watches */
    int64_t heard_ms;    /* when bytes last came in; this and the next two in time awake (loop.h) */
    int64_t progress_ms; /* when bytes last went out, or out was empty */
    bool yielded;        /* `turn` is queued behind other tasks with much work (loop_yield) */
    bool eof;            /* the input has ended */
    bool receives;       /* the owner takes the input itself (conn_receive), in `data` */
    bool draining;       /* input that has arrived is read, then the input counts as ended */
    bool finishing;      /* no more replies: send what is in `out`, then close */
    bool lingering;      /* all is sent; input is read and dropped until the client closes */
    bool closed;
    bool wants_room;   /* asks for a call of `room` */
    size_t dropped;    /* bytes read while lingering */
    int64_t linger_ms; /* since when */
};

/* Takes over a connected non-blocking socket, and a reservation for its owner that lasts until
 * `closed` is called. False (and both are still the caller's) if the socket cannot be watched. */
bool conn_init(struct conn *c, struct loop *loop, int fd, const struct conn_events *events,
               const struct reservation *memory);

/* Asks for another call of data in the next turn. */
void conn_again(struct conn *c);

/* The same, behind other tasks with much work (loop_yield). Until then input is read, and `data` is not
 * called. */
void conn_yield(struct conn *c);

/* Receives input right into bytes[n], past `in`, which is empty; returns how many bytes. 0: none have arrived, or the input has ended,
 * or the connection has been closed. While c->receives, the connection itself reads no input. */
size_t conn_receive(struct conn *c, char *bytes, size_t n);

/* Output from outside of `data`: sends at once the bytes that the socket takes, if nothing precedes them, and appends the rest. False:
 * some of it is sent later, or never: out of memory, or disconnected. */
bool conn_write(struct conn *c, const void *bytes, size_t n);

/* For an owner that has appended to c->out outside of `data`: sends at once the bytes that the socket takes; the rest of the turn
 * follows. The calling thread may be that of another loop, which is alone. */
void conn_flush(struct conn *c);

/* A turn: sends, has `data` called, and sends. Only the connection's own loop runs it. */
void conn_turn(struct conn *c);

/* Sends the bytes of c->out, then closes. Input that still arrives is read and dropped for a while,
 * because closing with unread input resets the connection, and the client would lose output that it has
 * not received yet. */
void conn_finish(struct conn *c);

/* The daemon is stopping: reads the bytes that have arrived, and then stops reading. */
void conn_drain(struct conn *c);

/* Closes at once. The owner's `closed` is called at the end of the loop's turn. */
void conn_close(struct conn *c);

/* Whether input has arrived that has not been read. */
bool conn_has_input(const struct conn *c);

/* To be called once a second: closes the connection if it lingers or stalls for too long, and runs a turn
 * if it stopped reading because memory was short. */
void conn_check_timeouts(struct conn *c);

/* The number of the next byte that will be appended to out. */
static inline uint64_t conn_out_end(const struct conn *c)
{
    return c->sent + buf_len(&c->out);
}

/* Returns how many bytes of out may be sent now. */
static inline size_t conn_sendable(const struct conn *c)
{
    return hold_free(&c->hold, c->sent, conn_out_end(c));
}

/* Whether memory is short: the rest is kept for small buffers. */
static inline bool conn_is_short(const struct conn *c)
{
    const struct budget *b = c->memory.budget;
    return b != NULL && !budget_fits(b, BUDGET_CLIENTS, CONN_OUT_LIMIT + b->limit / 64);
}

/* Whether the owner should produce no more output for now; `data` is called when `out` has drained. */
static inline bool conn_full(const struct conn *c)
{
    size_t n = buf_len(&c->out);
    return n >= CONN_OUT_LIMIT || (n >= CONN_SMALL && conn_is_short(c));
}
