/* near.c - see near.h. */
#include "core/query/near.h"

#include <math.h>
#include <stdlib.h>

enum { SPARE = 64 }; /* points, so that small searches cut nothing */

struct dt_near dt_near_of(struct dt_point q, const uint32_t *id, size_t wanted)
{
    return (struct dt_near){.q = q, .id = id, .wanted = wanted, .limit = HUGE_VAL};
}

void dt_near_clear(struct dt_near *h)
{
    free(h->heap);
    h->heap = NULL;
}

static inline bool before(const struct dt_near *h, const struct dt_seen *a, const struct dt_seen *b)
{
    int sign = dt_near_compare(h, a, b);
    if (sign != 0)
        return sign < 0;
    return h->id == NULL ? a->key < b->key : h->id[a->key] < h->id[b->key];
}

struct dt_seen dt_near_pop(struct dt_near *h)
{
    struct dt_seen top = h->heap[0], last = h->heap[--h->n];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < h->n; i = child) {
        if (child + 1 < h->n && before(h, &h->heap[child + 1], &h->heap[child]))
            child++;
        if (!before(h, &h->heap[child], &last))
            break;
        h->heap[i] = h->heap[child];
    }
    h->heap[i] = last;
    return top;
}

/* Cuts the heap down to the results still wanted, which is less than half of it: the nearest ones are popped
 * into the room that they leave at its end, then brought to the front, where their order is a heap. */
static enum dt_status cut(struct dt_near *h, struct dt_stop *work)
{
    size_t n = h->n, keep = h->wanted;
    enum dt_status st = DT_OK;
    for (size_t i = 0; st == DT_OK && i < keep; i++) {
        struct dt_seen c = dt_near_pop(h);
        h->heap[h->n] = c;
        if ((i & DT_WORK_MASK) == DT_WORK_MASK)
            st = dt_work(work, DT_WORK_BLOCK);
    }
    for (size_t i = 0; st == DT_OK && i < keep; i++)
        h->heap[i] = h->heap[n - 1 - i];
    h->n = keep;
    h->limit = h->heap[keep - 1].d * (1 + 4 * DT_DISTANCE_BOUND);
    return st;
}

static size_t next_cap(size_t cap)
{
    return 2 * cap + 32;
}

size_t dt_near_room(const struct dt_near *h, size_t more)
{
    size_t most = 2 * h->wanted + SPARE + 1, cap = h->cap;
    while (cap < h->n + more && cap < most)
        cap = next_cap(cap);
    return cap * sizeof *h->heap;
}

static enum dt_status grow(struct dt_near *h)
{
    size_t cap = next_cap(h->cap);
    struct dt_seen *heap = realloc(h->heap, cap * sizeof *heap);
    if (heap == NULL)
        return DT_NOMEM;
    h->heap = heap;
    h->cap = cap;
    return DT_OK;
}

enum dt_status dt_near_push(struct dt_near *h, struct dt_seen c, struct dt_stop *work)
{
    if (h->n == h->cap && grow(h) != DT_OK)
        return DT_NOMEM;
    size_t i = h->n++;
    for (; i > 0 && before(h, &c, &h->heap[(i - 1) / 2]); i = (i - 1) / 2)
        h->heap[i] = h->heap[(i - 1) / 2];
    h->heap[i] = c;
    return h->n > 2 * h->wanted + SPARE ? cut(h, work) : DT_OK;
}
