/* loop.h - the event loop: epoll, level-triggered, one thread.
 *
 * A turn is: run what was deferred, wait for events, tell each source about its own, run yielded tasks
 * for a millisecond, run the timers that are due, bury what was closed. A source is never freed
 * within a turn, only buried at its end, so that no event of the batch points to freed memory.
 *
 * A task with more work than it may do at once yields: it goes to the end of a queue that is served
 * round robin. So a turn is short however many tasks have much work, and those with little work run
 * in every turn. */
#ifndef SERVER_LOOP_H
#define SERVER_LOOP_H

#include "proto/buf.h"
#include "server/system/timer.h"

#include <stdbool.h>
#include <stdint.h>

/* For deferred tasks and events; the same again for yielded tasks. */
enum { LOOP_TURN_NS = 1000 * 1000 };

struct source {
    int fd;
    void (*ready)(struct source *source, uint32_t events); /* epoll's events */
};

/* Something to run later; part of whatever it is about. */
struct task {
    void (*run)(struct task *task);
    struct task *next;
    bool queued;
};

struct task_list {
    struct task *first, *last;
};

struct loop {
    int epoll;
    bool stopped;
    struct task_list deferred, yielded, burials;
    bool in_yielded; /* yielded tasks are running */
    int64_t turn_ns; /* monotonic; of this turn's beginning */
    struct timers timers;
    int64_t now_ms; /* monotonic; of this turn's beginning */
    int64_t next_tick_ms;
    void (*tick)(struct loop *loop);     /* once a second; may be NULL */
    void (*turn_end)(struct loop *loop); /* at the end of every turn; may be NULL */
    struct buf spare_in,
        spare_out; /* large blocks that connections borrow while they have something in hand */
};

/* False, with errno, if the system gives no epoll descriptor. */
bool loop_init(struct loop *loop);
void loop_clear(struct loop *loop);

/* Runs turns until loop_stop. */
void loop_run(struct loop *loop);
void loop_stop(struct loop *loop);

bool loop_watch(struct loop *loop, struct source *source, uint32_t events);
void loop_change(struct loop *loop, struct source *source, uint32_t events);
void loop_forget(struct loop *loop, struct source *source);

/* Runs the task at the beginning of the next turn. A task that is queued already is not queued
 * twice. */
void loop_defer(struct loop *loop, struct task *task);

/* Queues the task behind the others that have yielded: it runs in this turn or a later one. */
void loop_yield(struct loop *loop, struct task *task);

/* Whether this turn has taken so long already that whoever has much to do should yield at once; now is
 * clock_ns(). Yielded tasks have their own time. */
static inline bool loop_is_late(const struct loop *loop, int64_t now)
{
    return !loop->in_yielded && now - loop->turn_ns > LOOP_TURN_NS;
}

/* Runs the task at the end of this turn. */
void loop_bury(struct loop *loop, struct task *task);

/* Runs the timer when the moment of the monotonic clock has come; timer_clear takes that back. */
static inline void loop_at(struct loop *loop, struct timer *t, int64_t at_ms)
{
    timers_set(&loop->timers, t, at_ms);
}

/* Milliseconds of the monotonic clock. */
int64_t clock_ms(void);
/* The same in nanoseconds. */
int64_t clock_ns(void);

#endif
