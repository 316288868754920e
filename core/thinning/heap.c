/* heap.c - see heap.h. */
#include "core/thinning/heap.h"

#include "core/exact/predicates.h"
#include "core/memory/memory.h"

#include <math.h>
#include <string.h>

enum dt_status dt_heap_reserve(struct dt_heap *h, size_t cap)
{
    if (!dt_array_resize(NULL, &h->v, h->n, cap, sizeof *h->v))
        return DT_NOMEM;
    h->cap = cap;
    return DT_OK;
}

void dt_heap_clear(struct dt_heap *h)
{
    dt_array_free(h->v);
    *h = (struct dt_heap){0};
}

/* Whether a point comes before another one: it is off more, or equally far and has the lesser place. */
static bool precedes(const struct dt_sample *s, const struct dt_heaped *a,
                     const struct dt_heaped *b)
{
    return a->off > b->off ||
           (a->off == b->off && dt_compare_xy(s[a->worst].at, s[b->worst].at) < 0);
}

/* Puts e at `at`, or above. */
static void sift_up(struct dt_heap *h, const struct dt_sample *s, size_t at, struct dt_heaped e)
{
    for (; at > 0 && precedes(s, &e, &h->v[(at - 1) / 2]); at = (at - 1) / 2)
        h->v[at] = h->v[(at - 1) / 2];
    h->v[at] = e;
}

/* Puts e at `at`, or below. */
static void sift_down(struct dt_heap *h, const struct dt_sample *s, size_t at, struct dt_heaped e)
{
    for (size_t child; (child = 2 * at + 1) < h->heaped; at = child) {
        if (child + 1 < h->heaped && precedes(s, &h->v[child + 1], &h->v[child]))
            child++;
        if (!precedes(s, &h->v[child], &e))
            break;
        h->v[at] = h->v[child];
    }
    h->v[at] = e;
}

/* Puts an entry that precedes the last one of `next` into `next`, in order. Returns whether there was no room for the last one, which
 * *e becomes. */
static bool put_next(struct dt_heap *h, const struct dt_sample *s, struct dt_heaped *e)
{
    const bool full = h->nexts == DT_HEAP_NEXT;
    const struct dt_heaped last = h->next[h->nexts - 1];
    uint32_t at = full ? h->nexts - 1 : h->nexts++;
    for (; at > 0 && precedes(s, e, &h->next[at - 1]); at--)
        h->next[at] = h->next[at - 1];
    h->next[at] = *e;
    *e = last;
    return full;
}

void dt_heap_push(struct dt_heap *h, const struct dt_sample *s, struct dt_heaped e)
{
    if (h->nexts > 0 && precedes(s, &e, &h->next[h->nexts - 1]) && !put_next(h, s, &e))
        return;
    if (e.off >= h->limit) {
        h->v[h->n++] = h->v[h->heaped];
        sift_up(h, s, h->heaped++, e);
    } else {
        h->v[h->n++] = e;
    }
}

static void pop(struct dt_heap *h, const struct dt_sample *s)
{
    const struct dt_heaped last = h->v[--h->heaped];
    if (h->heaped > 0)
        sift_down(h, s, 0, last);
    h->v[h->heaped] = h->v[--h->n];
}

/* Of SAMPLES entries of the pile, or of as many as there are, TAKEN are off by at least that. */
static double limit_of(const struct dt_heap *h)
{
    enum { SAMPLES = 64, TAKEN = SAMPLES / 8 };
    double top[TAKEN] = {0};
    const size_t step = h->n / SAMPLES + 1, taken = h->n < TAKEN ? h->n : TAKEN;
    for (size_t i = 0; i < h->n; i += step) {
        int k = TAKEN - 1;
        for (double off = h->v[i].off; k >= 0 && off > top[k]; k--) {
            if (k + 1 < TAKEN)
                top[k + 1] = top[k];
            top[k] = off;
        }
    }
    return top[taken - 1];
}

/* Moves the part of the pile that is off by the limit or more into the empty heap. */
static void fill(struct dt_heap *h, const struct dt_sample *s)
{
    h->limit = limit_of(h);
    for (size_t i = 0; i < h->n; i++)
        if (h->v[i].off >= h->limit) {
            const struct dt_heaped e = h->v[i];
            h->v[i] = h->v[h->heaped];
            h->v[h->heaped++] = e;
        }
    for (size_t i = h->heaped / 2; i-- > 0;)
        sift_down(h, s, i, h->v[i]);
}

bool dt_heap_advance(struct dt_heap *h, const struct dt_sample *s)
{
    if (h->heaped == 0 && h->n > 0)
        fill(h, s);
    if (h->heaped == 0)
        return false;
    h->next[h->nexts++] = h->v[0];
    pop(h, s);
    return true;
}

void dt_heap_drop(struct dt_heap *h)
{
    h->nexts--;
    memmove(h->next, h->next + 1, h->nexts * sizeof *h->next);
}

void dt_heap_pile(struct dt_heap *h, size_t n)
{
    h->n = n;
    h->heaped = 0;
    h->limit = HUGE_VAL;
}
