/* queue.c - see queue.h. */
#include "core/refining/queue.h"

#include <string.h>

#include "core/memory/memory.h"

void dt_queue_init(struct dt_queue *q)
{
    memset(q, 0, sizeof *q);
    q->free_list = DT_NONE;
}

void dt_queue_clear(struct dt_queue *q)
{
    dt_array_free(q->item);
    dt_queue_init(q);
}

enum dt_status dt_queue_reserve(struct dt_queue *q, uint32_t n)
{
    if (n <= q->cap - q->n)
        return DT_OK;
    size_t cap = dt_array_room(q->cap, (size_t)q->n + n, DT_NONE - 1);
    if (!dt_array_resize(NULL, &q->item, q->end, cap, sizeof *q->item))
        return DT_NOMEM;
    q->cap = (uint32_t)cap;
    return DT_OK;
}

void dt_queue_push(struct dt_queue *q, uint32_t level, const struct dt_waiting *w)
{
    uint32_t i = q->free_list;
    if (i == DT_NONE)
        i = q->end++;
    else
        q->free_list = q->item[i].next;
    q->item[i] = *w;
    q->item[i].next = DT_NONE;
    uint64_t bit = (uint64_t)1 << (level & 63);
    if ((q->filled[level >> 6] & bit) != 0)
        q->item[q->last[level]].next = i;
    else
        q->first[level] = i;
    q->last[level] = i;
    q->filled[level >> 6] |= bit;
    q->any |= (uint64_t)1 << (level >> 6);
    q->n++;
}

static uint32_t highest(uint64_t bits)
{
    return 63 - (uint32_t)__builtin_clzll(bits);
}

bool dt_queue_pop(struct dt_queue *q, struct dt_waiting *w)
{
    if (q->n == 0)
        return false;
    uint32_t k = highest(q->any), bit = highest(q->filled[k]), level = 64 * k + bit;
    uint32_t i = q->first[level];
    *w = q->item[i];
    if (w->next == DT_NONE)
        q->filled[k] ^= (uint64_t)1 << bit;
    else
        q->first[level] = w->next;
    if (q->filled[k] == 0)
        q->any ^= (uint64_t)1 << k;
    q->item[i].next = q->free_list;
    q->free_list = i;
    q->n--;
    return true;
}
