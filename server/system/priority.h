/* priority.h - what the system's scheduler is told about a thread. No privilege is needed, no share of
 * the processor is given up, and a kernel that does not know the wish ignores it. */
#ifndef SERVER_PRIORITY_H
#define SERVER_PRIORITY_H

/* The calling thread works in short pieces and somebody waits for each: it asks for short slices,
 * which come sooner after it wakes (Linux 6.12 and later). */
void priority_prompt(void);

/* The calling thread computes for long: it pushes nobody aside when it wakes. */
void priority_patient(void);

#endif
