/* queue.c - see queue.h. */
#include "server/sets/queue.h"

void queue_enter(struct request_queue *q, struct waiter *w)
{
    bool front = w->called && w->queue == q;
    if (front) {
        q->called = NULL;
        w->called = false;
    } else {
        queue_served(w);
    }
    w->queue = q;
    if (front)
        list_prepend(&q->waiting, &w->link);
    else
        list_append(&q->waiting, &w->link);
}

void queue_served(struct waiter *w)
{
    struct request_queue *q = w->queue;
    if (q == NULL)
        return;
    w->queue = NULL;
    if (!w->called) {
        list_remove(&w->link);
        return;
    }
    w->called = false;
    q->called = NULL;
    queue_call(q);
}

void queue_call(struct request_queue *q)
{
    struct waiter *w = q->called == NULL ? list_first(&q->waiting) : NULL;
    while (w != NULL && q->admits != NULL && !q->admits(q, w))
        w = list_next(&q->waiting, w);
    if (w == NULL)
        return;
    list_remove(&w->link);
    w->called = true;
    q->called = w;
    w->wake(w);
}

void queue_wake_all(struct request_queue *q)
{
    struct waiter *w = q->called;
    if (w != NULL) {
        w->queue = NULL;
        w->called = false;
        q->called = NULL;
    }
    while ((w = list_pop(&q->waiting)) != NULL) {
        w->queue = NULL;
        w->wake(w);
    }
}
