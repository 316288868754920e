/* polls.c - see polls.h. */
#include "tests/core/polls.h"

#include <stdatomic.h>
#include <time.h>

#include "core/control/stop.h"

bool __real_dt_stopped(struct dt_stop *s);
bool __wrap_dt_stopped(struct dt_stop *s);

static atomic_uint_least64_t count, longest_ns, cancel_at;
static _Thread_local uint64_t last_ns; /* 0: this thread has not polled yet */

static uint64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void note(void)
{
    uint64_t now = now_ns(), longest = longest_ns, since = last_ns == 0 ? 0 : now - last_ns;
    while (since > longest && !atomic_compare_exchange_weak(&longest_ns, &longest, since))
        continue;
    last_ns = now;
}

void polls_begin(void)
{
    count = longest_ns = cancel_at = 0;
    last_ns = now_ns();
}

uint64_t polls_count(void)
{
    return count;
}

double polls_longest_ms(void)
{
    return (double)longest_ns / 1e6;
}

void polls_end(void)
{
    note();
}

void polls_cancel_at(uint64_t n)
{
    cancel_at = n == 0 ? 0 : count + n;
}

bool __wrap_dt_stopped(struct dt_stop *s)
{
    if (s == NULL)
        return false;
    uint64_t nth = ++count;
    note();
    if (cancel_at != 0 && nth >= cancel_at)
        dt_stop_because(s, DT_CANCELLED);
    return __real_dt_stopped(s);
}
