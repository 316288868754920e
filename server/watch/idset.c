/* idset.c - see idset.h. */
#include "server/watch/idset.h"

#include <stdlib.h>
#include <string.h>

static bool make_room(struct idset *s, uint32_t id, uint32_t ids)
{
    uint32_t need = id / 64 + 1, words = ids / 64 + 1;
    if (need <= s->words)
        return true;
    words = words > need ? words : need;
    uint64_t *larger = realloc(s->bits, words * sizeof *larger);
    if (larger == NULL)
        return false;
    memset(larger + s->words, 0, (words - s->words) * sizeof *larger);
    s->bits = larger;
    s->words = words;
    return true;
}

bool idset_add(struct idset *s, uint32_t id, uint32_t ids)
{
    if (!make_room(s, id, ids))
        return false;
    uint64_t bit = (uint64_t)1 << id % 64;
    s->count += (s->bits[id / 64] & bit) == 0;
    s->bits[id / 64] |= bit;
    return true;
}

bool idset_has(const struct idset *s, uint32_t id)
{
    return id / 64 < s->words && (s->bits[id / 64] >> id % 64 & 1) != 0;
}

bool idset_remove(struct idset *s, uint32_t id)
{
    if (!idset_has(s, id))
        return false;
    s->bits[id / 64] &= ~((uint64_t)1 << id % 64);
    s->count--;
    return true;
}

uint32_t idset_take(struct idset *s)
{
    if (s->cursor >= s->words)
        s->cursor = 0;
    while (s->bits[s->cursor] == 0)
        s->cursor = s->cursor + 1 == s->words ? 0 : s->cursor + 1;
    uint64_t *word = &s->bits[s->cursor];
    uint32_t id = 64 * s->cursor + (uint32_t)__builtin_ctzll(*word);
    *word &= *word - 1;
    s->count--;
    return id;
}

bool idset_fill(struct idset *s, uint32_t ids)
{
    if (ids == 0)
        return true;
    if (!make_room(s, ids - 1, ids))
        return false;
    memset(s->bits, 0xff, ids / 64 * sizeof *s->bits);
    if (ids % 64 != 0)
        s->bits[ids / 64] |= ((uint64_t)1 << ids % 64) - 1;
    s->count = 0;
    for (uint32_t i = 0; i < s->words; i++)
        s->count += (uint32_t)__builtin_popcountll(s->bits[i]);
    return true;
}

bool idset_copy(struct idset *to, const struct idset *from)
{
    if (from->words == 0)
        return true;
    to->bits = malloc(idset_memory(from));
    if (to->bits == NULL)
        return false;
    memcpy(to->bits, from->bits, idset_memory(from));
    to->words = from->words;
    to->count = from->count;
    to->cursor = from->cursor;
    return true;
}

void idset_clear(struct idset *s)
{
    free(s->bits);
    *s = (struct idset){.count = 0};
}
