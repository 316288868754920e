/* timer.h - things to do at a moment, for the loop: a wheel of slots, each a list of timers.
 *
 * The moment of a timer, in grains of GRAIN ms, is its slot modulo their number; when the clock
 * passes a slot, the timers in it run whose moment has come, and those of later rounds stay. So
 * setting and clearing cost O(1) and allocate nothing. A timer runs up to a grain late. */
#ifndef SERVER_TIMER_H
#define SERVER_TIMER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Part of whatever it is about. All zero: it is not set. */
struct timer {
    struct timer *prev, *next;
    int64_t at_ms;
    void (*run)(struct timer *t);
};

enum { TIMER_SLOTS = 256, TIMER_GRAIN_MS = 8 };

struct timers {
    struct timer slot[TIMER_SLOTS]; /* heads of circular lists */
    int64_t passed;                 /* the last grain that has been looked at */
    int64_t earliest_ms;            /* no timer is due before; INT64_MAX: none is set */
};

void timers_init(struct timers *w, int64_t now_ms);

/* Has t run once the clock has reached at_ms; if it is set already, instead of then. */
void timers_set(struct timers *w, struct timer *t, int64_t at_ms);

/* Does nothing if it is not set. */
void timer_clear(struct timer *t);

static inline bool timer_is_set(const struct timer *t)
{
    return t->next != NULL;
}

/* Runs what is due. A timer that runs may set and clear itself and others. */
void timers_run(struct timers *w, int64_t now_ms);

#endif
