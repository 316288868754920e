/* priority.c - see priority.h. EEVDF is a scheduler that gives each thread a deadline by the length of its slice. It
 * runs the thread with the shortest slice first. So the clients of a reactor do not
 * wait for the end of a worker's slice of three milliseconds.
 *
 * A short slice for a reactor is not enough. If two workers share a processor, the waiting one falls behind its
 * share. Once its slice is due, a reactor is not the next to run: the running worker is not interrupted until the next
 * clock tick, which may be four milliseconds later. The slice of a worker is therefore several ticks long, so
 * that it is rarely due so soon. That
 * does not reduce a worker's share of the processor. */
#include "server/system/priority.h"

#include <sched.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

enum {
    SHORT_NS = 100 * 1000, /* the shortest slice that the kernel grants */
    LONG_NS = 20 * 1000 * 1000
};

/* The kernel's struct sched_attr, of which libc has none yet; see sched_setattr(2). */
struct attributes {
    uint32_t size, policy;
    uint64_t flags;
    int32_t nice;
    uint32_t priority;
    uint64_t runtime, deadline, period;
};

/* Does nothing if the daemon was started with a policy other than the default. A kernel without
 * slices takes only the policy. */
static void choose(uint32_t policy, uint64_t slice_ns)
{
    struct attributes a = {.size = sizeof a};
    if (syscall(SYS_sched_getattr, 0, &a, (unsigned)sizeof a, 0u) != 0 || a.policy != SCHED_OTHER)
        return;
    a.policy = policy;
    a.runtime = slice_ns;
    a.flags = 0;
    syscall(SYS_sched_setattr, 0, &a, 0u);
}

void priority_prompt(void)
{
    choose(SCHED_OTHER, SHORT_NS);
}

void priority_patient(void)
{
    choose(SCHED_BATCH, LONG_NS);
}
