/* memory.h - arrays that may be large.
 *
 * Fresh memory costs as much as the work done in it when the system hands it out in small pages, so
 * arrays of several MiB are aligned for huge pages and ask for them. All are released with free().
 */
#ifndef DT_MEMORY_H
#define DT_MEMORY_H

#include <stddef.h>

/* n items of size bytes each, not initialised; NULL when out of memory or when n * size overflows.
 * At least one byte. */
void *dt_array_new(size_t n, size_t size);

/* Replaces the array p of `used` items (NULL if used is 0) by one with room for `n` >= used items
 * and frees the old one. NULL: out of memory, p is unchanged. */
void *dt_array_grow(void *p, size_t used, size_t n, size_t size);

/* The capacity to grow to so that it holds `need` items and appending costs amortised constant
 * time; at most `limit`. */
size_t dt_array_room(size_t cap, size_t need, size_t limit);

#endif
