/* credit.h - how much time the events of a set may take.
 *
 * While a set is edited, its events get one part of CREDIT_SHARE of the processor time, and some of the loop's idle time.
 * So a watcher slows edits down by little. Changes that have not been sent yet are merged. Isolated edits never wait,
 * because there is credit after a pause. Times are in nanoseconds. */
#pragma once

#include <stdint.h>

enum { CREDIT_SHARE = 12, CREDIT_MOST = 2000 * 1000, CREDIT_DEBT = 5000 * 1000 };

struct credit {
    int64_t ns;                 /* that may be spent; less than 0: owed */
    int64_t processor, idle_ns; /* the clocks up to which it has been earned */
};

/* Credits the time until now, on the clocks of the thread's processor time and of the loop's idle time. */
void credit_earn(struct credit *c, int64_t processor, int64_t idle_ns);

void credit_spend(struct credit *c, int64_t ns);
