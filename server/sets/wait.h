/* wait.h - queues of requests that wait for the same thing: a set, room in the log, memory.
 *
 * A queue is served in order, one request at a time. When what it is about may be had, the first
 * waiter that can go on is called; until it has been served (wait_served), nobody else is called, and
 * newcomers line up behind it. So n waiters cost n calls, not n * n. */
#ifndef SERVER_WAIT_H
#define SERVER_WAIT_H

#include <stdbool.h>
#include <stddef.h>

/* A request that waits; part of its session. */
struct waiter {
    struct waiter *prev, *next;
    struct wait_queue *queue; /* borrows while it waits or is called; NULL: neither */
    bool writes;              /* of a set's queue: it can go on only when the set has no writer */
    bool called;              /* it has left the queue: its turn has come */
    void (*wake)(struct waiter *w);
};

struct wait_queue {
    struct waiter *first, *last;
    struct waiter *called; /* whose turn it is; NULL: nobody's */
    /* Whether w can go on now; NULL: every waiter can. */
    bool (*admits)(const struct wait_queue *q, const struct waiter *w);
};

/* Whether nobody stands before a request; turn: the queue that has called it, NULL: none has. */
static inline bool wait_is_first(const struct wait_queue *q, const struct wait_queue *turn)
{
    return turn == q || (q->first == NULL && q->called == NULL);
}

/* Enters the queue, at its end, or at its front if it has called w. A waiter is in one queue at a
 * time: it leaves any other one. */
void wait_enter(struct wait_queue *q, struct waiter *w);

/* The waiter, if it waits or is called, does so no longer; the next one is called. */
void wait_served(struct waiter *w);

/* What is waited for may be had: calls the first waiter that can go on, if nobody is called yet. */
void wait_call(struct wait_queue *q);

/* The queue ends: all its waiters are woken, and find out for themselves. */
void wait_wake_all(struct wait_queue *q);

/* The queue that has called w; NULL: none has. */
static inline struct wait_queue *wait_turn(const struct waiter *w)
{
    return w->called ? w->queue : NULL;
}

#endif
