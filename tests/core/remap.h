/* remap.h - mremap as it is on other systems than this one, or under a system that refuses: the test binary
 * has it come through here. Where a call fails after it has unmapped its target, another thread is quick to
 * map something of its own there, which nobody else may write to or unmap. */
#ifndef REMAP_H
#define REMAP_H

#include <stdbool.h>

/* From now on it moves one mapping at a time, as Linux before 6.17 does. */
void remap_one_mapping_only(void);

/* It does not know MREMAP_DONTUNMAP, as Linux before 5.7. */
void remap_without_dontunmap(void);

/* The n-th move from now on fails for want of memory, when its target has been unmapped. n = 0: none. */
void remap_refuse(long n);

/* As it is here again. Returns how many calls have failed as above since it was told to behave otherwise, or
 * -1 if what the other thread has mapped is not as it was. */
int remap_end(void);

#endif
