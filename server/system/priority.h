/* priority.h - hints about threads for the scheduler. They need no privilege, do not change a thread's share
 * of the processor, and are ignored by kernels that do not know them. */
#pragma once

/* The calling thread works in short pieces, and clients wait for each: it requests short time slices,
 * so that it runs sooner after it wakes up (Linux 6.12 and later). */
void priority_prompt(void);

/* The calling thread computes for a long time: it does not preempt others when it wakes up. */
void priority_patient(void);
