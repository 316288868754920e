/* timer_test.c - the timer wheel: no timer is early, none is lost. */
#include "server/system/timer.h"
#include "tests/test.h"

#include <stddef.h>

static struct timers wheel;
static int64_t now;

struct alarm {
    struct timer timer; /* first */
    int64_t rang_ms;    /* 0: not yet */
    struct alarm *clears, *sets;
};

static void ring(struct timer *t)
{
    struct alarm *a = (struct alarm *)t;
    CHECK(a->rang_ms == 0 && !timer_is_set(t));
    a->rang_ms = now;
    if (a->clears != NULL)
        timer_clear(&a->clears->timer);
    if (a->sets != NULL)
        timers_set(&wheel, &a->sets->timer, now + 1);
}

static void go_on_to(int64_t ms)
{
    now = ms;
    timers_run(&wheel, now);
}

TEST(timers_run_when_they_are_due_and_less_than_two_grains_later)
{
    enum { ALARMS = 3000, SPAN = 10000 };
    static struct alarm alarm[ALARMS];
    now = 123456;
    timers_init(&wheel, now);
    for (int i = 0; i < ALARMS; i++) {
        alarm[i].timer.run = ring;
        timers_set(&wheel, &alarm[i].timer, now - 10 + test_below(SPAN));
        if (i % 3 == 0) /* set to another time */
            timers_set(&wheel, &alarm[i].timer, now + test_below(SPAN));
        if (i % 5 == 0)
            timer_clear(&alarm[i].timer);
    }
    for (int64_t end = now + SPAN + 20; now < end;)
        go_on_to(now + 1 + test_below(6));
    CHECK(wheel.earliest_ms == INT64_MAX);
    for (int i = 0; i < ALARMS; i++) {
        struct alarm *a = &alarm[i];
        CHECK((a->rang_ms == 0) == (i % 5 == 0) && !timer_is_set(&a->timer));
        CHECK(a->rang_ms == 0 || (a->rang_ms >= a->timer.at_ms &&
                                  a->rang_ms <= a->timer.at_ms + 10 + 2 * TIMER_GRAIN_MS));
    }
}

TEST(timers_that_a_long_turn_has_missed_run_after_it)
{
    struct alarm alarm[4] = {{.rang_ms = 0}};
    now = 7;
    timers_init(&wheel, now);
    for (int i = 0; i < 4; i++) {
        alarm[i].timer.run = ring;
        timers_set(&wheel, &alarm[i].timer, 10 + 3000 * i);
    }
    CHECK(wheel.earliest_ms >= 10 && wheel.earliest_ms < 10 + 2 * TIMER_GRAIN_MS);
    go_on_to(100000);
    for (int i = 0; i < 4; i++)
        CHECK(alarm[i].rang_ms == 100000);
}

TEST(timers_may_clear_and_set_each_other)
{
    struct alarm a = {.timer.run = ring}, b = a, c = a;
    now = 50;
    timers_init(&wheel, now);
    timers_set(&wheel, &a.timer, 100);
    timers_set(&wheel, &b.timer, 100);
    a.clears = &b; /* due, too, but cleared */
    a.sets = &c;
    go_on_to(200);
    CHECK(a.rang_ms == 200 && b.rang_ms == 0 && c.rang_ms == 0);
    go_on_to(200 + 2 * TIMER_GRAIN_MS);
    CHECK(c.rang_ms > 200 && b.rang_ms == 0);
}

TEST(loop_that_waits_for_a_later_round_wakes_rarely)
{
    struct alarm a = {.timer.run = ring};
    int64_t end = 1000 * 1000;
    now = 0;
    timers_init(&wheel, now);
    timers_set(&wheel, &a.timer, end);
    int wakes = 0;
    for (; a.rang_ms == 0; wakes++)
        go_on_to(wheel.earliest_ms);
    CHECK(a.rang_ms < end + 2 * TIMER_GRAIN_MS);
    CHECK(wakes <= end / (TIMER_SLOTS * TIMER_GRAIN_MS) + 2);
}
