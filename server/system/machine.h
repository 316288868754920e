/* machine.h - the limits that the machine, its administrator and its control groups set for this process. */
#pragma once

#include <stddef.h>

/* Processors that are online, at least 1. */
unsigned machine_processors(void);

/* Descriptors 0, 1 and 2 that are closed become /dev/null: no other file gets such a number and then messages. To be called
 * first. */
void machine_open_standard(void);

/* Raises the soft limit of open descriptors to the hard one: best effort. */
void machine_raise_descriptors(void);

/* How many descriptors this process may have; UINT_MAX: no limit. */
unsigned machine_descriptors(void);

/* If the process may have less than 1 GiB: from now on malloc returns large blocks to the system as soon as they are freed. To be
 * called before there are threads. */
void machine_return_blocks(size_t limit);

/* Bytes of memory: the machine's, or the limit of the control groups if that is lower. */
size_t machine_memory(void);

/* Resident bytes of this process; 0 if the system does not report them. */
size_t machine_resident(void);

/* The lowest memory limit of the control groups in the file `groups` (/proc/self/cgroup) and of their
 * parents, versions 1 and 2, below `mount` (/sys/fs/cgroup); SIZE_MAX: none. */
size_t machine_group_memory(const char *groups, const char *mount);
