/* timer.h - timers of the event loop: a wheel of slots, each a list of timers.
 *
 * The slot of a timer is its time, in grains of GRAIN ms, modulo the number of slots. When the clock
 * passes a slot, the timers in it that are due run, and the timers of later rounds stay. So setting and
 * clearing cost O(1) and allocate nothing. A timer runs up to one grain late. */
#pragma once

#include "server/system/list.h"

#include <stdint.h>

/* Embedded in the object that it works on. All zero: not set. */
struct timer {
    struct list_link link; /* first: in a slot */
    int64_t at_ms;
    void (*run)(struct timer *t);
};

enum { TIMER_SLOTS = 256, TIMER_GRAIN_MS = 8 };

struct timers {
    struct list slot[TIMER_SLOTS];
    int64_t passed;      /* the last grain that has been processed */
    int64_t earliest_ms; /* no timer is due before this; INT64_MAX: none is set */
};

void timers_init(struct timers *w, int64_t now_ms);

/* Runs t once the clock has reached at_ms. If t is set already, this replaces its time. */
void timers_set(struct timers *w, struct timer *t, int64_t at_ms);

/* Does nothing if t is not set. */
void timer_clear(struct timer *t);

static inline bool timer_is_set(const struct timer *t)
{
    return list_holds(&t->link);
}

/* Runs the timers that are due. A timer that runs may set and clear itself and others. */
void timers_run(struct timers *w, int64_t now_ms);
