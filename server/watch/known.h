/* known.h - points that a watcher of a box may know. They are few of a large set, so their ids are in a hash table. If that
 * would be larger than half a bit for each id of the set, there is a bit for each id instead. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Start with {0}: empty, and without memory. */
struct known {
    uint32_t *slot; /* owns `slots`, a power of two; each an id + 1, or 0 */
    uint32_t slots, count;
    uint64_t *bits; /* owns `words`; if there are any, all ids are there */
    uint32_t words;
};

/* Adds an id; `ids` is one more than the largest that is expected. False: out of memory; it is unchanged. */
bool known_add(struct known *k, uint32_t id, uint32_t ids);
bool known_has(const struct known *k, uint32_t id);
/* Whether the id was in it. */
bool known_remove(struct known *k, uint32_t id);
/* Adds all ids below `ids`. False: out of memory; it is unchanged. */
bool known_fill(struct known *k, uint32_t ids);
/* Removes all and frees its memory. */
void known_clear(struct known *k);

static inline size_t known_memory(const struct known *k)
{
    return k->slots * sizeof *k->slot + k->words * sizeof *k->bits;
}
