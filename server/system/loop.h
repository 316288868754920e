/* loop.h - the event loop: epoll, level-triggered, one thread.
 *
 * A turn:
 *     1. run deferred tasks
 *     2. wait for events, and deliver them to their sources
 *     3. run yielded tasks for a millisecond
 *     4. run the timers that are due
 *     5. dispose of closed sources, for a millisecond, too
 * A source is freed only at the end of a turn, so that no event of the batch points to freed memory.
 *
 * A task with more work than it may do at once yields: it goes to the end of a queue that is served
 * round robin. So turns stay short however many tasks have much work, and tasks with little work run
 * in every turn. */
#ifndef SERVER_LOOP_H
#define SERVER_LOOP_H

#include "proto/buf.h"
#include "server/system/timer.h"

#include <stdbool.h>
#include <stdint.h>

/* The time for deferred tasks and events; yielded tasks get as much again. */
enum { LOOP_TURN_NS = 1000 * 1000 };

struct source {
    int fd;
    void (*ready)(struct source *source, uint32_t events); /* epoll's events */
};

/* Something to run later; embedded in the object that it works on. */
struct task {
    struct list_link link; /* first: in a queue of the loop */
    void (*run)(struct task *task);
};

static inline bool task_is_queued(const struct task *task)
{
    return list_holds(&task->link);
}

struct loop {
    int epoll;
    bool stopped;
    struct list deferred, yielded, disposals;
    bool in_yielded; /* yielded tasks are running */
    int64_t turn_ns; /* monotonic; when this turn began */
    int64_t idle_ns; /* the time spent waiting for events so far */
    struct timers timers;
    int64_t now_ms; /* the same in milliseconds */
    int64_t awake_ns,
        awake_ms; /* the time without that in which the process was stopped, or had no processor: for limits
                                   of clients, whose input could not be read meanwhile */
    int64_t next_tick_ms;
    void (*tick)(struct loop *loop);     /* once a second; may be NULL */
    void (*turn_end)(struct loop *loop); /* at the end of every turn; may be NULL */
    struct buf spare_in,
        spare_out; /* large blocks that connections borrow while they have data to process */
};

/* False, with errno, if there is no epoll descriptor. */
bool loop_init(struct loop *loop);
void loop_clear(struct loop *loop);

/* Runs turns until loop_stop. */
void loop_run(struct loop *loop);
void loop_stop(struct loop *loop);

bool loop_watch(struct loop *loop, struct source *source, uint32_t events);
void loop_change(struct loop *loop, struct source *source, uint32_t events);
void loop_forget(struct loop *loop, struct source *source);

/* Runs the task at the beginning of the next turn. Does nothing if the task is queued already. */
void loop_defer(struct loop *loop, struct task *task);

/* Queues the task behind the others that have yielded: it runs in this turn or a later one. */
void loop_yield(struct loop *loop, struct task *task);

/* Whether this turn has already taken so long that a task with much work should yield at once; now is
 * clock_ns(). Yielded tasks have a time limit of their own. */
static inline bool loop_is_late(const struct loop *loop, int64_t now)
{
    return !loop->in_yielded && now - loop->turn_ns > LOOP_TURN_NS;
}

/* Runs the task at the end of this turn, or of a later one if there are very many. */
void loop_dispose(struct loop *loop, struct task *task);

/* Runs the timer when the monotonic clock has reached at_ms; timer_clear cancels it. */
static inline void loop_at(struct loop *loop, struct timer *t, int64_t at_ms)
{
    timers_set(&loop->timers, t, at_ms);
}

/* Milliseconds of the monotonic clock. */
int64_t clock_ms(void);
/* The same in nanoseconds. */
int64_t clock_ns(void);

#endif
