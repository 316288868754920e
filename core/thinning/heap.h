/* heap.h - finds the facet that has the worst point of all. The next few facets are in order. A binary heap [Knuth, TAOCP 3, sec.
 * 5.2.3] has those that are off by less, and the others lie behind it, in no order.
 *
 *     next:  the first ones, the worst one first
 *     v:     | heap, off >= limit | pile, off < limit | free |
 *
 * Most entries are of facets that are replaced before they could be the worst one. In the pile such entries cost nothing. An
 * empty heap takes about an eighth of the pile. The data that the next insertions will read can be fetched ahead. */
#pragma once

#include "core/thinning/samples.h"

struct dt_heaped {
    double off;
    uint32_t facet, worst; /* its worst point */
};

enum { DT_HEAP_NEXT = 8 };

struct dt_heap {
    struct dt_heaped next[DT_HEAP_NEXT];
    uint32_t nexts;
    struct dt_heaped *v; /* owns cap */
    size_t heaped, n, cap;
    double limit;
};

/* Makes room. DT_NOMEM. */
enum dt_status dt_heap_reserve(struct dt_heap *h, size_t cap);
void dt_heap_clear(struct dt_heap *h);

/* There is room. s: the samples, whose places decide between equal distances, as below. Cost: constant for the pile, else O(log n). */
void dt_heap_push(struct dt_heap *h, const struct dt_sample *s, struct dt_heaped e);

/* Moves the worst entry of the heap to the end of `next`, where there is room; false: there is none. Cost: O(log n); O(n) for an empty
 * heap, amortised over entries O(1) expected. */
bool dt_heap_advance(struct dt_heap *h, const struct dt_sample *s);

/* Drops the first one of `next`. */
void dt_heap_drop(struct dt_heap *h);

/* All entries of v become entries of the pile: the first n, which have been chosen from them. */
void dt_heap_pile(struct dt_heap *h, size_t n);
