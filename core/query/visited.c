/* visited.c - open addressing with linear probing, at most half full; Fibonacci hashing [Knuth,
 * TAOCP 3, sec. 6.4]. */
#include "core/query/visited.h"

#include <stdlib.h>
#include <string.h>

static void empty(uint32_t *slot, uint32_t bits)
{
    memset(slot, 0xFF, sizeof *slot << bits);
}

void dt_visited_init(struct dt_visited *s, size_t expected)
{
    _Static_assert(DT_VISITED_SMALL == 1 << 7, "the small table has 2^7 slots");
    s->slot = s->small;
    s->n = 0;
    s->bits = expected <= DT_VISITED_SMALL / 4 ? 6 : 7;
    empty(s->slot, s->bits);
}

void dt_visited_clear(struct dt_visited *s)
{
    if (s->slot != s->small)
        free(s->slot);
    s->slot = NULL;
}

/* The slot that has key or is the place for it. */
static uint32_t *find(uint32_t *slot, uint32_t bits, uint32_t key)
{
    uint32_t i = key * 0x9E3779B9u >> (32 - bits);
    while (slot[i] != key && slot[i] != DT_NONE)
        i = (i + 1) & ((1u << bits) - 1);
    return &slot[i];
}

static enum dt_status grow(struct dt_visited *s)
{
    uint32_t bits = s->bits + 2;
    uint32_t *slot =
        bits > 31 || SIZE_MAX >> bits < sizeof *slot ? NULL : malloc(sizeof *slot << bits);
    if (slot == NULL)
        return DT_NOMEM;
    empty(slot, bits);
    for (uint32_t i = 0; i < 1u << s->bits; i++)
        if (s->slot[i] != DT_NONE)
            *find(slot, bits, s->slot[i]) = s->slot[i];
    if (s->slot != s->small)
        free(s->slot);
    s->slot = slot;
    s->bits = bits;
    return DT_OK;
}

enum dt_status dt_visited_add(struct dt_visited *s, uint32_t key, bool *fresh)
{
    uint32_t *at = find(s->slot, s->bits, key);
    *fresh = *at != key;
    if (!*fresh)
        return DT_OK;
    if (s->n >= 1u << (s->bits - 1)) {
        enum dt_status st = grow(s);
        if (st != DT_OK)
            return st;
        at = find(s->slot, s->bits, key);
    }
    *at = key;
    s->n++;
    return DT_OK;
}
