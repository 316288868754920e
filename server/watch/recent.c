/* recent.c - see recent.h. Out of memory means that less is remembered. */
#include "server/watch/recent.h"

#include <stdlib.h>

enum { FIRST = 64 };

void recent_clear(struct recent *r)
{
    free(r->key);
    free(r->mark);
    *r = (struct recent){.keys = 0};
}

/* Doubles a ring of `size` elements; those from `first` to `end` stay. Returns the new size; 0: out of memory. */
static uint32_t grow(void **ring, uint32_t size, size_t width, uint64_t first, uint64_t end)
{
    uint32_t larger = size == 0 ? FIRST : 2 * size;
    char *to = malloc(larger * width);
    const char *from = *ring;
    if (to == NULL)
        return 0;
    for (uint64_t i = first; i < end; i++)
        for (size_t k = 0; k < width; k++)
            to[(i & (larger - 1)) * width + k] = from[(i & (size - 1)) * width + k];
    free(*ring);
    *ring = to;
    return larger;
}

/* Forgets marks whose keys are overwritten. */
static void trim(struct recent *r)
{
    while (r->mark_first < r->mark_end &&
           r->key_end - r->mark[r->mark_first & (r->marks - 1)].at > r->keys)
        r->mark_first++;
}

void recent_restart(struct recent *r, uint64_t version, uint32_t ids, uint64_t altered)
{
    r->mark_first = r->mark_end;
    recent_mark(r, version, ids, altered);
}

/* Makes room for n more keys behind `oldest`, as far as the ring may grow. */
static void make_room(struct recent *r, uint64_t oldest, size_t n)
{
    while (r->key_end - oldest + n > r->keys && r->keys < RECENT_KEYS) {
        void *ring = r->key;
        uint32_t larger = grow(&ring, r->keys, sizeof *r->key, oldest, r->key_end);
        if (larger == 0)
            return;
        r->key = ring;
        r->keys = larger;
    }
}

void recent_put(struct recent *r, const uint64_t *key, size_t n)
{
    bool marked = r->mark_first < r->mark_end;
    make_room(r, marked ? r->mark[r->mark_first & (r->marks - 1)].at : r->key_end, n);
    for (size_t i = 0; r->keys > 0 && i < n; i++)
        r->key[(r->key_end + i) & (r->keys - 1)] = key[i];
    r->key_end += n;
    trim(r);
}

void recent_mark(struct recent *r, uint64_t version, uint32_t ids, uint64_t altered)
{
    if (r->mark_end - r->mark_first == r->marks && r->marks < RECENT_MARKS) {
        void *ring = r->mark;
        uint32_t larger = grow(&ring, r->marks, sizeof *r->mark, r->mark_first, r->mark_end);
        r->mark = ring;
        r->marks = larger > 0 ? larger : r->marks;
    }
    uint64_t at = r->mark_end++;
    if (r->mark_end - r->mark_first > r->marks)
        r->mark_first++;
    if (r->marks > 0)
        r->mark[at & (r->marks - 1)] = (struct recent_mark){version, r->key_end, altered, ids};
}

uint64_t recent_find(const struct recent *r, uint64_t version)
{
    uint64_t low = r->mark_first, high = r->mark_end;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (recent_at(r, middle + 1)->version <= version)
            low = middle + 1;
        else
            high = middle;
    }
    return low > r->mark_first ? low : 0;
}
