/* wait.c - see wait.h. */
#include "server/sets/wait.h"

static void link_between(struct wait_queue *q, struct waiter *prev, struct waiter *w,
                         struct waiter *next)
{
    w->prev = prev;
    w->next = next;
    if (prev == NULL)
        q->first = w;
    else
        prev->next = w;
    if (next == NULL)
        q->last = w;
    else
        next->prev = w;
}

static void unlink_waiter(struct wait_queue *q, struct waiter *w)
{
    if (w->prev == NULL)
        q->first = w->next;
    else
        w->prev->next = w->next;
    if (w->next == NULL)
        q->last = w->prev;
    else
        w->next->prev = w->prev;
}

void wait_enter(struct wait_queue *q, struct waiter *w)
{
    bool front = w->called && w->queue == q;
    if (front) {
        q->called = NULL;
        w->called = false;
    } else {
        wait_served(w);
    }
    w->queue = q;
    if (front)
        link_between(q, NULL, w, q->first);
    else
        link_between(q, q->last, w, NULL);
}

void wait_served(struct waiter *w)
{
    struct wait_queue *q = w->queue;
    if (q == NULL)
        return;
    w->queue = NULL;
    if (!w->called) {
        unlink_waiter(q, w);
        return;
    }
    w->called = false;
    q->called = NULL;
    wait_call(q);
}

void wait_call(struct wait_queue *q)
{
    struct waiter *w = q->called == NULL ? q->first : NULL;
    while (w != NULL && q->admits != NULL && !q->admits(q, w))
        w = w->next;
    if (w == NULL)
        return;
    unlink_waiter(q, w);
    w->called = true;
    q->called = w;
    w->wake(w);
}

void wait_wake_all(struct wait_queue *q)
{
    struct waiter *w = q->called;
    if (w != NULL) {
        w->queue = NULL;
        w->called = false;
        q->called = NULL;
    }
    while ((w = q->first) != NULL) {
        unlink_waiter(q, w);
        w->queue = NULL;
        w->wake(w);
    }
}
