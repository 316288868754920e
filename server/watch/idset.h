/* idset.h - a set of ids: a bit for each. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Start with {0}: empty, and without memory. */
struct idset {
    uint64_t *bits; /* owns */
    uint32_t words;
};

/* Adds an id; `ids` is one more than the largest that is expected. False: out of memory; it is unchanged. */
bool idset_add(struct idset *s, uint32_t id, uint32_t ids);
bool idset_has(const struct idset *s, uint32_t id);
/* Whether the id was in it. */
bool idset_remove(struct idset *s, uint32_t id);
/* Adds all ids below `ids`. */
bool idset_fill(struct idset *s, uint32_t ids);
/* Removes all and frees its memory. */
void idset_clear(struct idset *s);

static inline size_t idset_memory(const struct idset *s)
{
    return s->words * sizeof *s->bits;
}
