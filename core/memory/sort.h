/* sort.h - ids, keys and other items in ascending order; numbers for samples and pivots. */
#pragma once

#include "core/control/stop.h"

/* Sorts n ids. If it is stopped, they are in some order, and some may be missing; stop may be NULL. Cost: O(n), and
 * 4 bytes for each meanwhile, from pages, which may be NULL; without that memory O(n log n), and no poll. */
void dt_sort_ids(uint32_t *ids, size_t n, struct dt_pages *pages, struct dt_stop *stop);

/* The same, and leaves each id once. Returns how many are left. */
size_t dt_sort_unique(uint32_t *ids, size_t n, struct dt_pages *pages, struct dt_stop *stop);

/* Sorts n keys. Cost: O(n), and 8 bytes for each meanwhile; without that memory O(n log n). */
void dt_sort_keys(uint64_t *key, size_t n);

/* The same, and leaves each key once. Returns how many are left. */
size_t dt_sort_unique_keys(uint64_t *key, size_t n);

/* Sorts n items of `size` bytes, as qsort does; equal ones are in any order. If it is stopped, some may be missing; stop may be
 * NULL. Cost: O(n log n), and the bytes of all items meanwhile; without that memory, or for few items, no poll. */
void dt_sort_items(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
                   struct dt_stop *stop);

/* Whether id is one of n ascending ids. Cost: O(log n). */
bool dt_sorted_have(const uint32_t *ids, size_t n, uint32_t id);

/* A number below n > 0 from a deterministic sequence, which may begin with any state. [Knuth, MMIX] */
static inline uint32_t dt_random_below(uint64_t *state, uint32_t n)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*state >> 32) * n >> 32);
}
