/* nearest_heap.c - see nearest_heap.h. */
#include "core/query/nearest_heap.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory/memory.h"
#include "core/memory/sort.h"

enum { SPARE = 64 }; /* points, so that small searches cut nothing */

struct dt_nearest_heap dt_nearest_heap_of(struct dt_point q, const uint32_t *id, size_t wanted)
{
    return (struct dt_nearest_heap){.q = q, .id = id, .wanted = wanted, .limit = HUGE_VAL};
}

void dt_nearest_heap_clear(struct dt_nearest_heap *h)
{
    free(h->heap);
    h->heap = NULL;
}

static inline bool before(const struct dt_nearest_heap *h, const struct dt_seen *a,
                          const struct dt_seen *b)
{
    int sign = dt_nearest_heap_compare(h, a, b);
    if (sign != 0)
        return sign < 0;
    return h->id == NULL ? a->key < b->key : h->id[a->key] < h->id[b->key];
}

/* Puts a point at i or below it. */
static void sift_down(struct dt_nearest_heap *h, size_t i, struct dt_seen c)
{
    for (size_t child; (child = 2 * i + 1) < h->n; i = child) {
        if (child + 1 < h->n && before(h, &h->heap[child + 1], &h->heap[child]))
            child++;
        if (!before(h, &h->heap[child], &c))
            break;
        h->heap[i] = h->heap[child];
    }
    h->heap[i] = c;
}

struct dt_seen dt_nearest_heap_pop(struct dt_nearest_heap *h)
{
    struct dt_seen top = h->heap[0];
    h->n--;
    sift_down(h, 0, h->heap[h->n]);
    return top;
}

/* Brings the nearest k points, 0 < k <= n, to the front, the last of them to k - 1 [Hoare, "Algorithm 65: find", CACM
 * 4(7), 1961]. The choice of pivots does not change the result. It depends on addresses in memory, so that no order of
 * points can be made to slow it down. Cost: linear expected. */
static void select_nearest(struct dt_nearest_heap *h, size_t k)
{
    struct dt_seen *v = h->heap;
    uint64_t random = (uintptr_t)v;
    for (size_t lo = 0, hi = h->n - 1; lo < hi;) { /* place k - 1 is among lo .. hi */
        struct dt_seen pivot = v[lo + dt_random_below(&random, (uint32_t)(hi - lo + 1))];
        size_t i = lo, j = hi;
        for (;; i++, j--) {
            while (before(h, &v[i], &pivot))
                i++;
            while (before(h, &pivot, &v[j]))
                j--;
            if (i >= j)
                break;
            struct dt_seen swap = v[i];
            v[i] = v[j];
            v[j] = swap;
        }
        if (k - 1 <= j)
            hi = j;
        else
            lo = j + 1;
    }
}

/* Cuts the heap down to the results still wanted. */
static enum dt_status cut(struct dt_nearest_heap *h, struct dt_stop *work)
{
    size_t keep = h->wanted;
    select_nearest(h, keep);
    h->n = keep;
    h->limit = h->heap[keep - 1].d * (1 + 4 * DT_DISTANCE_BOUND);
    for (size_t i = keep / 2; i-- > 0;)
        sift_down(h, i, h->heap[i]);
    return dt_work(work, keep);
}

size_t dt_nearest_heap_room(const struct dt_nearest_heap *h, size_t more)
{
    size_t most = 2 * h->wanted + SPARE + 1, cap = h->cap;
    while (cap < h->n + more && cap < most)
        cap = dt_array_room(cap, cap + 1, SIZE_MAX);
    return cap * sizeof *h->heap;
}

enum dt_status dt_nearest_heap_push(struct dt_nearest_heap *h, struct dt_seen c,
                                    struct dt_stop *work)
{
    enum dt_status s = dt_items_append(&h->heap, &h->n, &h->cap, &c, sizeof c);
    if (s != DT_OK)
        return s;
    size_t i = h->n - 1;
    for (; i > 0 && before(h, &c, &h->heap[(i - 1) / 2]); i = (i - 1) / 2)
        h->heap[i] = h->heap[(i - 1) / 2];
    h->heap[i] = c;
    return h->n > 2 * h->wanted + SPARE ? cut(h, work) : DT_OK;
}
