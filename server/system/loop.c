/* loop.c - see loop.h. */
#include "server/system/loop.h"

#include <errno.h>
#include <stddef.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

enum {
    EVENTS_PER_WAIT = 128, /* those that are late only read and yield, 2 us each */
    TICK_MS = 1000,
    LATE_NS = 100 * 1000 *
              1000 /* a turn that is later than that has not been awake for the rest of the time */
};

int64_t clock_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

int64_t clock_ms(void)
{
    return clock_ns() / 1000000;
}

static void on_wake(struct source *source, uint32_t events)
{
    eventfd_t count;
    eventfd_read(source->fd, &count);
}

bool loop_init(struct loop *loop, struct gate *world, unsigned lane)
{
    int64_t now = clock_ns();
    *loop = (struct loop){.turn_ns = now, .now_ms = now / 1000000, .awake_ms = now / 1000000};
    loop->awake_ns = now;
    loop->next_tick_ms = loop->now_ms + TICK_MS;
    timers_init(&loop->timers, loop->now_ms);
    loop->world = world;
    loop->lane = lane;
    loop->alone = loop->inside = world == NULL;
    loop->wake = (struct source){-1, on_wake, .shares = true};
    loop->epoll = epoll_create1(EPOLL_CLOEXEC);
    if (loop->epoll < 0 || world == NULL)
        return loop->epoll >= 0;
    loop->wake.fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return loop->wake.fd >= 0 && loop_watch(loop, &loop->wake, EPOLLIN);
}

/* ---- the world ---- */

void loop_enter(struct loop *loop)
{
    if (!loop->inside)
        gate_enter(loop->world, loop->lane);
    loop->inside = true;
}

void loop_leave(struct loop *loop)
{
    if (loop->world == NULL || !loop->inside)
        return;
    bool alone = loop->alone;
    loop->inside = loop->alone = false; /* while that is nobody else's to see */
    if (alone)
        gate_open(loop->world);
    else
        gate_leave(loop->world, loop->lane);
}

void loop_alone(struct loop *loop)
{
    if (!loop->inside)
        return;
    if (!loop->alone) {
        loop_leave(loop);
        gate_close(loop->world);
        loop->inside = loop->alone = true;
    }
    loop->changed = true;
}

void loop_share(struct loop *loop)
{
    if (loop->world == NULL || !loop->inside)
        return;
    if (loop->alone) {
        gate_open_and_enter(loop->world, loop->lane);
        loop->alone = false;
    } else if (gate_is_closed(loop->world)) {
        loop_leave(loop);
        loop_enter(loop);
    }
}

/* Enters the state in which something can run. */
static void enter(struct loop *loop, bool shares)
{
    if (shares)
        loop_share(loop);
    else
        loop_alone(loop);
}

/* Has the loop look at its tasks and timers. Others do so only while they are alone. */
static void wake(struct loop *loop)
{
    if (loop->asleep)
        eventfd_write(loop->wake.fd, 1);
    loop->asleep = false;
}

/* ---- tasks ---- */

static void push(struct loop *loop, struct list *list, struct task *task)
{
    if (task_is_queued(task))
        return;
    list_append(list, &task->link);
    wake(loop);
}

static void run(struct loop *loop, struct task *task)
{
    enter(loop, task->shares);
    task->run(task);
}

/* Runs the tasks that are in the list now; those that they add wait for the next time. */
static void run_all(struct loop *loop, struct list *list)
{
    struct list now = {0};
    list_move(&now, list);
    for (struct task *task; (task = list_pop(&now)) != NULL;)
        run(loop, task);
}

/* Runs tasks in order until their time is over. */
static void run_some(struct loop *loop, struct list *list)
{
    if (list_is_empty(list))
        return;
    int64_t end = clock_ns() + LOOP_TURN_NS;
    do {
        struct task *task = list_pop(list);
        run(loop, task);
    } while (!list_is_empty(list) && clock_ns() < end);
}

void loop_defer(struct loop *loop, struct task *task)
{
    push(loop, &loop->deferred, task);
}

void loop_yield(struct loop *loop, struct task *task)
{
    push(loop, &loop->yielded, task);
}

void loop_dispose(struct loop *loop, struct task *task)
{
    push(loop, &loop->disposals, task);
}

void loop_clear(struct loop *loop)
{
    loop->world = NULL;
    loop->alone = loop->inside = true;
    while (!list_is_empty(&loop->disposals)) {
        run_all(loop, &loop->deferred);
        run_all(loop, &loop->yielded);
        run_all(loop, &loop->disposals);
    }
    buf_free(&loop->spare_in);
    buf_free(&loop->spare_out);
    if (loop->wake.fd >= 0)
        close(loop->wake.fd);
    if (loop->epoll >= 0)
        close(loop->epoll);
    loop->wake.fd = loop->epoll = -1;
}

void loop_at(struct loop *loop, struct timer *t, int64_t at_ms)
{
    timers_set(&loop->timers, t, at_ms);
    wake(loop);
}

/* ---- sources ---- */

bool loop_watch(struct loop *loop, struct source *source, uint32_t events)
{
    struct epoll_event e = {.events = events, .data.ptr = source};
    return epoll_ctl(loop->epoll, EPOLL_CTL_ADD, source->fd, &e) == 0;
}

void loop_change(struct loop *loop, struct source *source, uint32_t events)
{
    struct epoll_event e = {.events = events, .data.ptr = source};
    epoll_ctl(loop->epoll, EPOLL_CTL_MOD, source->fd, &e);
}

void loop_forget(struct loop *loop, struct source *source)
{
    epoll_ctl(loop->epoll, EPOLL_CTL_DEL, source->fd, NULL);
}

/* ---- turns ---- */

static void tick_if_due(struct loop *loop)
{
    if (loop->now_ms < loop->next_tick_ms)
        return;
    loop->next_tick_ms = loop->now_ms + TICK_MS;
    if (loop->tick == NULL)
        return;
    loop_alone(loop);
    loop->tick(loop);
}

/* Reads the clock; wait_ms: how long the loop has wanted to wait. */
static void begin_turn(struct loop *loop, int wait_ms)
{
    int64_t now = clock_ns(), passed = now - loop->turn_ns,
            most = (int64_t)wait_ms * 1000000 + LATE_NS;
    loop->turn_ns = now;
    loop->now_ms = now / 1000000;
    loop->awake_ns += passed < most ? passed : most;
    loop->awake_ms = loop->awake_ns / 1000000;
}

/* Waits for events outside of the world, until a timer is due, or not at all if there are tasks. Begins the turn. */
static int wait_for(struct loop *loop, struct epoll_event *event)
{
    int64_t first = loop->timers.earliest_ms, now = 0;
    int wait_ms = 0;
    if (list_is_empty(&loop->deferred) && list_is_empty(&loop->yielded) &&
        list_is_empty(&loop->disposals)) {
        now = clock_ns();
        if (first > loop->next_tick_ms)
            first = loop->next_tick_ms;
        wait_ms = first > now / 1000000 ? (int)(first - now / 1000000) : 0;
    }
    loop->asleep = loop->world != NULL;
    loop_leave(loop);
    int n = epoll_wait(loop->epoll, event, EVENTS_PER_WAIT, wait_ms);
    loop_enter(loop);
    loop->asleep = false;
    loop->changed = loop->world == NULL;
    begin_turn(loop, wait_ms);
    if (wait_ms > 0)
        loop->idle_ns += loop->turn_ns - now;
    return n;
}

/* Tasks that are left run in the next turn. */
static void run_yielded(struct loop *loop)
{
    loop->in_yielded = true;
    run_some(loop, &loop->yielded);
    loop->in_yielded = false;
}

/* The same for others. Tasks that they add wait for the next turn, behind the rest. */
static void run_part(struct loop *loop, struct list *list)
{
    struct list mine = {0};
    list_move(&mine, list);
    run_some(loop, &mine);
    list_move(&mine, list);
    list_move(list, &mine);
}

static void deliver(struct loop *loop, struct source *source, uint32_t events)
{
    enter(loop, source->shares);
    if (source->fd >= 0) /* not closed earlier in this batch, or by another loop */
        source->ready(source, events);
}

static void run_timers(struct loop *loop)
{
    if (loop->timers.earliest_ms > loop->now_ms)
        return;
    loop_alone(loop);
    timers_run(&loop->timers, loop->now_ms);
}

static void end_turn(struct loop *loop)
{
    if (loop->turn_end == NULL || !loop->changed)
        return;
    loop_alone(loop);
    loop->turn_end(loop);
}

void loop_run(struct loop *loop)
{
    struct epoll_event event[EVENTS_PER_WAIT];
    loop_enter(loop);
    while (!loop->stopped) {
        int n = wait_for(loop, event);
        /* Deferred tasks come before new events: they have waited longer. */
        run_part(loop, &loop->deferred);
        for (int i = 0; i < n; i++)
            deliver(loop, event[i].data.ptr, event[i].events);
        run_yielded(loop);
        run_timers(loop);
        tick_if_due(loop);
        end_turn(loop);
        run_part(loop, &loop->disposals);
    }
}

void loop_stop(struct loop *loop)
{
    loop->stopped = true;
    wake(loop);
}
