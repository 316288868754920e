/* mremap_shim.h - simulates mremap of other systems, or of one where it fails: the test binary redirects
 * it here. If a call fails after it has unmapped its target, another thread immediately maps its
 * own memory there, which no other thread may write to or unmap. */
#pragma once

#include <stdbool.h>

/* From now on it moves one mapping at a time, as Linux before 6.17 does. */
void remap_one_mapping_only(void);

/* It does not know MREMAP_DONTUNMAP, as Linux before 5.7. */
void remap_without_dontunmap(void);

/* The n-th move from now on fails with ENOMEM after its target has been unmapped. n = 0: none. */
void remap_refuse(long n);

/* Restores the system's mremap. Returns how many calls have failed as above, or -1 if the other
 * thread's memory was changed. */
int remap_end(void);
