/* timer.c - see timer.h. [Varghese & Lauck 1987, scheme 6] */
#include "server/system/timer.h"

void timer_clear(struct timer *t)
{
    list_remove(&t->link);
}

void timers_init(struct timers *w, int64_t now_ms)
{
    *w = (struct timers){.passed = now_ms / TIMER_GRAIN_MS, .earliest_ms = INT64_MAX};
}

/* The grain at whose end a timer for at_ms is due; a grain that has not passed yet. */
static int64_t grain_of(const struct timers *w, int64_t at_ms)
{
    int64_t grain = (at_ms + TIMER_GRAIN_MS - 1) / TIMER_GRAIN_MS;
    return grain > w->passed ? grain : w->passed + 1;
}

void timers_set(struct timers *w, struct timer *t, int64_t at_ms)
{
    int64_t grain = grain_of(w, at_ms);
    timer_clear(t);
    t->at_ms = at_ms;
    list_append(&w->slot[grain % TIMER_SLOTS], &t->link);
    if (grain * TIMER_GRAIN_MS < w->earliest_ms)
        w->earliest_ms = grain * TIMER_GRAIN_MS;
}

/* Moves the due timers of a slot to the list. */
static void take_due(struct list *slot, struct list *due, int64_t now_ms)
{
    for (struct timer *t = list_first(slot), *next; t != NULL; t = next) {
        next = list_next(slot, t);
        if (t->at_ms <= now_ms) {
            timer_clear(t);
            list_append(due, &t->link);
        }
    }
}

/* When the next non-empty slot is passed; its timers may be for a later round. */
static int64_t next_ms(const struct timers *w)
{
    for (int64_t grain = w->passed + 1; grain <= w->passed + TIMER_SLOTS; grain++)
        if (!list_is_empty(&w->slot[grain % TIMER_SLOTS]))
            return grain * TIMER_GRAIN_MS;
    return INT64_MAX;
}

void timers_run(struct timers *w, int64_t now_ms)
{
    struct list due = {0};
    int64_t now = now_ms / TIMER_GRAIN_MS;
    if (now_ms < w->earliest_ms)
        return;
    int64_t from = now - w->passed > TIMER_SLOTS ? now - TIMER_SLOTS : w->passed;
    for (int64_t grain = from + 1; grain <= now; grain++)
        take_due(&w->slot[grain % TIMER_SLOTS], &due, now_ms);
    w->passed = now;
    for (struct timer *t; (t = list_pop(&due)) != NULL;)
        t->run(t);
    w->earliest_ms = next_ms(w);
}
