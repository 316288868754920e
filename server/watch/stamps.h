/* stamps.h - when each id of a set changed last. A time is a tick: a number that increases with each change that is noted.
 *
 * The stamps are in blocks of consecutive ids. A block exists once one of its ids has changed: 4 bytes for each of its ids. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { STAMPS_IN_BLOCK = 256 };

/* Start with {0}: nothing has changed. */
struct stamps {
    uint32_t **block; /* owns them; NULL: no id of it has changed */
    uint32_t blocks, used;
    uint64_t base; /* a stamp is a tick less base; 0: the id has not changed */
};

/* The id has changed at a tick > 0 that is not less than those before. False: out of memory, or the ticks span more than 2^32;
 * then all stamps are removed. */
bool stamps_put(struct stamps *s, uint32_t id, uint64_t tick);

/* Whether the id has changed after the tick. */
static inline bool stamps_after(const struct stamps *s, uint32_t id, uint64_t tick)
{
    const uint32_t *block =
        id / STAMPS_IN_BLOCK < s->blocks ? s->block[id / STAMPS_IN_BLOCK] : NULL;
    uint32_t stamp = block == NULL ? 0 : block[id % STAMPS_IN_BLOCK];
    return stamp != 0 && s->base + stamp > tick;
}

static inline size_t stamps_memory(const struct stamps *s)
{
    return s->blocks * sizeof *s->block + (size_t)s->used * STAMPS_IN_BLOCK * sizeof **s->block;
}

void stamps_clear(struct stamps *s);
