/* machine.h - what the machine, its administrator and its control groups allow this process. */
#ifndef SERVER_MACHINE_H
#define SERVER_MACHINE_H

#include <stddef.h>

/* Processors that are online, at least 1. */
unsigned machine_processors(void);

/* Raises the soft limit of open descriptors to the hard one: best effort. */
void machine_raise_descriptors(void);

/* How many descriptors this process may have; UINT_MAX: any number. */
unsigned machine_descriptors(void);

/* Bytes of memory: those of the machine, or those that the control groups leave of it. */
size_t machine_memory(void);

/* Bytes of this process that are in memory; 0 if the system does not say. */
size_t machine_resident(void);

/* The least memory limit of the control groups that `groups` (/proc/self/cgroup) names and of their
 * parents, versions 1 and 2, below `mount` (/sys/fs/cgroup); SIZE_MAX: there is none. */
size_t machine_group_memory(const char *groups, const char *mount);

#endif
