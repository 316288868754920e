/* sort.h - ids in ascending order. */
#ifndef DT_SORT_H
#define DT_SORT_H

#include "core/stop.h"

/* Sorts n ids. If it is stopped, or out of memory, they are in some order, and some may be missing. Cost:
 * O(n), and 4 bytes for each meanwhile, from pages, which may be NULL. */
enum dt_status dt_sort_ids(uint32_t *ids, size_t n, struct dt_pages *pages, struct dt_stop *stop);

#endif
