/* memory.h - arrays that may be large.
 *
 * Fresh memory in small pages costs as much as the work done in it, so arrays of several MiB use huge pages
 * where the system has them. They grow by moving pages, not bytes. */
#pragma once

#include "core/delaunay.h"

#include <string.h>

/* Asks for the cache line at p, which need not be a valid address, ahead of its use. The empty asm statement is
 * needed: without it gcc removes a function that only prefetches. */
static inline void dt_fetch(const void *p)
{
    __builtin_prefetch(p);
    __asm__ volatile("");
}

/* n items of size bytes each, not initialised, aligned to 16; NULL when out of memory or when n *
 * size overflows. A large one comes from the keeper of pages (core/delaunay.h), which may be NULL.
 * Release it by dt_array_free, which finds the keeper. */
void *dt_array_new_in(struct dt_pages *pages, size_t n, size_t size);

/* Makes room for n >= used items in the array p, keeps the first `used`, and releases the excess of large
 * arrays; p may be NULL if used is 0. Returns the array, which may have moved. NULL: out of memory, p is
 * unchanged. An array has one keeper all its life. Cost: O(used) for a small array, else O(pages). */
void *dt_array_grow_in(struct dt_pages *pages, void *p, size_t used, size_t n, size_t size);

/* dt_array_grow_in for the array whose pointer, of any type, `array` points to. False: out of memory. */
bool dt_array_resize(struct dt_pages *pages, void *array, size_t used, size_t n, size_t size);

/* Both without a keeper. */
static inline void *dt_array_new(size_t n, size_t size)
{
    return dt_array_new_in(NULL, n, size);
}

static inline void *dt_array_grow(void *p, size_t used, size_t n, size_t size)
{
    return dt_array_grow_in(NULL, p, used, n, size);
}

/* Nothing for NULL. */
void dt_array_free(void *p);

/* The bytes that an array of n elements takes, of whole huge pages if it is large. */
size_t dt_array_bytes(size_t n, size_t size);

/* The capacity to grow to so that it holds `need` items and appending costs amortised constant
 * time; at most `limit`. */
size_t dt_array_room(size_t cap, size_t need, size_t limit);

/* Makes room for `need` items of `size` bytes in a growing array from malloc. `array` points to the pointer to the array, which may
 * have any type, and be NULL; *cap is the number of items for which there is room. The caller frees the array. DT_NOMEM: nothing is
 * changed. Appending costs amortised constant time. */
enum dt_status dt_items_reserve(void *array, size_t need, size_t *cap, size_t size);

/* Appends an item to such an array of *n items. DT_NOMEM: nothing is changed. Cost: constant, amortised. */
static inline enum dt_status dt_items_append(void *array, size_t *n, size_t *cap, const void *item,
                                             size_t size)
{
    char *items;
    enum dt_status s = *n < *cap ? DT_OK : dt_items_reserve(array, *n + 1, cap, size);
    if (s != DT_OK)
        return s;
    memcpy(&items, array, sizeof items);
    memcpy(items + (*n)++ * size, item, size);
    return DT_OK;
}

/* Makes room for `more` ids after the existing ones; DT_NOMEM leaves *ids unchanged. */
static inline enum dt_status dt_ids_reserve(struct dt_ids *ids, size_t more)
{
    return dt_items_reserve(&ids->v, ids->n + more, &ids->cap, sizeof *ids->v);
}

/* Appends one; DT_NOMEM leaves *ids unchanged. Cost: constant, amortised. */
static inline enum dt_status dt_ids_append(struct dt_ids *ids, uint32_t value)
{
    return dt_items_append(&ids->v, &ids->n, &ids->cap, &value, sizeof value);
}
