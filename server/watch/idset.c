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
    s->bits[id / 64] |= (uint64_t)1 << id % 64;
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
    return true;
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
    return true;
}

void idset_clear(struct idset *s)
{
    free(s->bits);
    *s = (struct idset){.words = 0};
}
