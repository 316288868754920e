/* queue.h - queues of requests that wait for a resource: a set, room in the log, memory.
 *
 * A queue is served in order, one request at a time. When the resource may be available, the first
 * waiter that can continue is called; until it has been served (queue_served), no other one is called,
 * and new waiters enter behind it. So n waiters cost n calls, not n * n. */
#pragma once

#include "server/system/list.h"

/* A request that waits; part of its session. */
struct waiter {
    struct list_link link;       /* first */
    struct request_queue *queue; /* borrows while it waits or is called; NULL: neither */
    bool writes; /* in a set's queue: it can continue only when the set has no writer */
    bool called; /* it has left the queue and has its turn */
    void (*wake)(struct waiter *w);
};

struct request_queue {
    struct list waiting;
    struct waiter *called; /* the waiter that has its turn; NULL: none */
    /* Whether w can continue now; NULL: every waiter can. */
    bool (*admits)(const struct request_queue *q, const struct waiter *w);
};

/* Whether no other request is ahead of a request; turn: the queue that has called it, NULL: none. */
static inline bool queue_is_first(const struct request_queue *q, const struct request_queue *turn)
{
    return turn == q || (list_is_empty(&q->waiting) && q->called == NULL);
}

/* Enters the queue at its end, or at its front if the queue has called w. A waiter is in one queue at a time:
 * it leaves any other one. */
void queue_enter(struct request_queue *q, struct waiter *w);

/* Ends the turn or the waiting of w; the next waiter is called. */
void queue_served(struct waiter *w);

/* The resource may be available: calls the first waiter that can continue, unless one is called already. */
void queue_call(struct request_queue *q);

/* The resource is gone: wakes all waiters, which check again. */
void queue_wake_all(struct request_queue *q);

/* The queue that has called w; NULL: none. */
static inline struct request_queue *queue_turn(const struct waiter *w)
{
    return w->called ? w->queue : NULL;
}
