/* conn.h - one client's byte streams: what arrived and is not consumed yet, what waits to be sent.
 *
 * A connection knows nothing of the protocol. It tells its owner three things: data (bytes arrived,
 * the input ended, the output drained, or the owner asked for another turn: do what you can, now),
 * and closed (the last call; the owner frees it). It reads no more while too much is unconsumed or
 * unsent, and it has no buffers while it is quiet. Those that it has are counted; when memory is
 * short, it reads and produces only as much as needs no large ones.
 *
 * End of input is not disconnection: a client that closed its sending side still gets every reply.
 * Only an error, a hang-up or a failed write means that nobody is there any more. */
#ifndef SERVER_CONN_H
#define SERVER_CONN_H

#include "proto/buf.h"
#include "server/disk/hold.h"
#include "server/sets/budget.h"
#include "server/system/loop.h"

enum {
    CONN_IN_LIMIT =
        160 * 1024, /* unconsumed bytes beyond which nothing is read; more than a whole line */
    CONN_OUT_LIMIT = 64 * 1024, /* unsent bytes beyond which the owner should produce no more */
    CONN_SMALL = 4 * 1024       /* the same for either when memory is short */
};

struct conn;

struct conn_events {
    void (*data)(struct conn *c);
    void (*closed)(struct conn *c); /* frees it */
};

struct conn {
    struct source source; /* first: the loop's view */
    struct loop *loop;
    const struct conn_events *events;
    struct buf in, out;
    struct reservation memory; /* what its owner has reserved, and the buffers */
    size_t owner_bytes;        /* the former */
    uint64_t sent;             /* bytes that have left out so far */
    struct hold hold; /* which bytes of out must wait for the disk; numbered as `sent` is */
    struct task turn, burial;
    uint32_t interest;   /* what epoll watches for */
    int64_t heard_ms;    /* when bytes last came in */
    int64_t progress_ms; /* when bytes last went out, or out was empty */
    bool yielded;        /* it is in the queue of those with much to do (loop_yield) */
    bool eof;            /* the input has ended */
    bool draining;       /* what has arrived is read, then the input counts as ended */
    bool finishing;      /* no more replies: send what there is, then close */
    bool lingering;      /* all is sent; input is read and dropped until the client closes */
    bool dead;
    size_t dropped;    /* bytes read while lingering */
    int64_t linger_ms; /* since when */
};

/* Takes over a connected non-blocking socket, and a reservation for its owner that lasts until
 * `closed` is called. False (and both are still the caller's) if the socket cannot be watched. */
bool conn_init(struct conn *c, struct loop *loop, int fd, const struct conn_events *events,
               const struct reservation *memory);

/* Asks for another call of data in the next turn. */
void conn_again(struct conn *c);

/* The same, behind the others that have much to do (loop_yield). Until then what arrives is read, and
 * data is not called. */
void conn_yield(struct conn *c);

/* Runs a turn now: for an owner that has put something into c->out from outside of data. */
void conn_turn(struct conn *c);

/* Sends what is in c->out, then closes. Input that still arrives is read and dropped for a while,
 * because closing with unread input would make the system throw away what the client has not
 * received yet. */
void conn_finish(struct conn *c);

/* The daemon stops: reads what has arrived, and no more. */
void conn_drain(struct conn *c);

/* Closes at once. The owner's closed is called at the end of the loop's turn. */
void conn_close(struct conn *c);

/* To be called once a second: closes those that linger or stall for too long, and gives those a turn
 * that read nothing because memory was short. */
void conn_check_timeouts(struct conn *c);

/* The number of the next byte that will be appended to out. */
static inline uint64_t conn_out_end(const struct conn *c)
{
    return c->sent + buf_len(&c->out);
}

/* How many bytes of out may be sent now. */
static inline size_t conn_sendable(const struct conn *c)
{
    return hold_free(&c->hold, c->sent, conn_out_end(c));
}

/* Whether there is no memory left for large buffers of clients; what there is, is for small ones. */
static inline bool conn_is_short(const struct conn *c)
{
    const struct budget *b = c->memory.budget;
    return b != NULL && !budget_fits(b, BUDGET_CLIENTS, CONN_OUT_LIMIT + *b->limit / 64);
}

/* Whether the owner should produce no more output for now; data is called when it has drained. */
static inline bool conn_full(const struct conn *c)
{
    size_t n = buf_len(&c->out);
    return n >= CONN_OUT_LIMIT || (n >= CONN_SMALL && conn_is_short(c));
}

#endif
