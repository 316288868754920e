/* idset.h - a set of ids: a bit for each, from which ids are taken round and round. */
#ifndef SERVER_IDSET_H
#define SERVER_IDSET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Start with {0}: empty, and without memory. */
struct idset {
    uint64_t *bits; /* owns */
    uint32_t words;
    uint32_t count;  /* ids in it */
    uint32_t cursor; /* the word from which the next id is taken */
};

/* Adds an id; `ids` is one more than the largest that is expected. False: out of memory; it is unchanged. */
bool idset_add(struct idset *s, uint32_t id, uint32_t ids);
bool idset_has(const struct idset *s, uint32_t id);
/* Whether the id was in it. */
bool idset_remove(struct idset *s, uint32_t id);
/* Removes some id that is in it; it must not be empty. Cost: a step for 64 ids between one and the next. */
uint32_t idset_take(struct idset *s);

/* Adds all ids below `ids`. */
bool idset_fill(struct idset *s, uint32_t ids);
/* to, which is empty, becomes the same. */
bool idset_copy(struct idset *to, const struct idset *from);
/* Removes all and frees its memory. */
void idset_clear(struct idset *s);

static inline size_t idset_memory(const struct idset *s)
{
    return s->words * sizeof *s->bits;
}

#endif
