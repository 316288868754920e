/* loop.h - an event loop: epoll, level-triggered, one thread. A daemon has one loop, or several, which share a world.
 *
 * A turn:
 *
 *     1. Wait for events.
 *     2. Run deferred tasks for a quarter of a millisecond, and deliver the events to their sources.
 *     3. Run yielded tasks for a quarter of a millisecond.
 *     4. Run the timers that are due.
 *     5. Dispose of closed sources, for a quarter of a millisecond.
 *
 * A source is freed only at the end of a turn, so that no event of the batch points to freed memory.
 *
 * The world is everything that loops have in common. A loop that shares the world with others changes only what is its
 * own. A loop that is alone in the world may change everything, also what belongs to other loops, because none of them is
 * in the world. While a loop waits for events it is outside. One loop without others is always alone. Sources and tasks run
 * while the loop is alone, unless they say that they can share the world.
 *
 * A task with more work than it may do at once yields: it goes to the end of a queue that is served
 * round robin. So turns stay short however many tasks have much work, and tasks with little work run
 * in every turn. */
#pragma once

#include "proto/buf.h"
#include "server/system/gate.h"
#include "server/system/timer.h"

#include <stdbool.h>
#include <stdint.h>

/* The time for deferred tasks and events; yielded tasks get the same time again. A request that comes when a thousand others
 * have just come waits for about two turns. */
enum { LOOP_TURN_NS = 250 * 1000 };

struct source {
    int fd;
    void (*ready)(struct source *source, uint32_t events); /* epoll's events */
    bool shares; /* `ready` can share the world; else the loop is alone in it */
};

/* Something to run later; embedded in the object that it works on. */
struct task {
    struct list_link link; /* first: in a queue of the loop */
    void (*run)(struct task *task);
    bool shares; /* as in a source */
};

static inline bool task_is_queued(const struct task *task)
{
    return list_holds(&task->link);
}

struct loop {
    int epoll;
    struct gate *world; /* borrows; NULL: there are no other loops */
    unsigned lane;      /* of this loop */
    bool inside;        /* it shares the world, or is alone in it */
    bool alone;         /* it is alone in the world */
    /* turn_end is due: it has been alone in this turn, or has called loop_end_alone */
    bool changed;
    bool asleep;        /* it waits for events; only changed by who may change the loop */
    struct source wake; /* an eventfd by which other loops end that */
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
    void (*tick)(struct loop *loop); /* once a second; may be NULL */
    void (*turn_end)(
        struct loop *loop); /* at the end of every turn that has changed the world; may be NULL */
    struct buf spare_in,
        spare_out; /* large blocks that connections borrow while they have data to process */
};

/* world NULL: there is no other loop. False, with errno, if there are no descriptors. */
bool loop_init(struct loop *loop, struct gate *world, unsigned lane);
/* Runs the tasks that are left, and frees everything. The other loops have ended. */
void loop_clear(struct loop *loop);

/* Comes into the world, unless it is there already, and shares it; leaves it. For the loop's own thread, while the loop does not
 * run. */
void loop_enter(struct loop *loop);
void loop_leave(struct loop *loop);

/* Is alone in the world from now on: waits until no other loop is in it. Cost: about as long as their current requests; 10 ns
 * without other loops. This and loop_share do nothing for a loop that is outside: then the thread of another loop, which
 * is alone, acts for it. */
void loop_alone(struct loop *loop);
/* Whether it shares the world now, so that nothing but its own may be changed. */
static inline bool loop_is_sharing(const struct loop *loop)
{
    return loop->inside && !loop->alone;
}

/* Shares the world from now on. If another loop waits to be alone, it comes first. After a call of either, nothing that
 * was known about the world needs to hold any more. */
void loop_share(struct loop *loop);

/* This turn ends with a call of turn_end, for which the loop is alone, although it may only share the world before. */
static inline void loop_end_alone(struct loop *loop)
{
    loop->changed = true;
}

/* Runs turns until loop_stop. The calling thread is outside of the world, or alone in it. */
void loop_run(struct loop *loop);
void loop_stop(struct loop *loop);

bool loop_watch(struct loop *loop, struct source *source, uint32_t events);
void loop_change(struct loop *loop, struct source *source, uint32_t events);
void loop_forget(struct loop *loop, struct source *source);

/* Runs the task at the beginning of the next turn, or of a later one if there are very many. Does nothing if the task is queued
 * already. */
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
void loop_at(struct loop *loop, struct timer *t, int64_t at_ms);

/* Milliseconds of the monotonic clock. */
int64_t clock_ms(void);
/* The same in nanoseconds. */
int64_t clock_ns(void);
