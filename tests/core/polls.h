/* polls.h - how often, and after how much work, a computation polls whether to stop
 * (core/control/stop.h): the test binary redirects dt_stopped here. */
#pragma once

#include <stdint.h>

/* Counts from now on. */
void polls_begin(void);

/* Polls so far, of all threads. */
uint64_t polls_count(void);

/* The longest time, in ms, that a thread has computed between two of its polls, or since polls_begin if
 * that was called on the thread. Waiting, and the work of other processes, does not
 * count. */
double polls_longest_ms(void);

/* The work since the calling thread's last poll counts, too: to be called at the end. */
void polls_end(void);

/* The n-th poll from now on, and all later ones, see the flag set: n = 0, none. */
void polls_cancel_at(uint64_t n);
