/* priority.c - see priority.h. A scheduler that gives each thread a deadline by the length of its slice
 * (EEVDF) lets the thread with the shortest one run first, so the clients of the I/O thread do not
 * wait for the end of a worker's slice of three milliseconds. */
#include "server/priority.h"

#include <sched.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { SLICE_NS = 100 * 1000 }; /* the shortest that the kernel grants */

/* The kernel's struct sched_attr, of which libc has none yet; see sched_setattr(2). */
struct attributes {
    uint32_t size, policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime, deadline, period;
};

void priority_prompt(void)
{
    struct attributes a = {.size = sizeof a, .policy = SCHED_OTHER, .runtime = SLICE_NS};
    if (syscall(SYS_sched_getattr, 0, &a, (unsigned)sizeof a, 0u) != 0 || a.policy != SCHED_OTHER)
        return; /* whoever started the daemon has chosen something else */
    a.runtime = SLICE_NS;
    a.flags = 0;
    syscall(SYS_sched_setattr, 0, &a, 0u);
}

void priority_patient(void)
{
    struct sched_param none = {0};
    if (sched_getscheduler(0) == SCHED_OTHER)
        sched_setscheduler(0, SCHED_BATCH, &none);
}
