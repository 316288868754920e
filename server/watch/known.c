/* known.c - see known.h. The table is probed linearly. */
#include "server/watch/known.h"

#include <stdlib.h>

enum { FIRST_SLOTS = 64, IDS_FOR_BYTE = 16 };

static uint32_t home_of(const struct known *k, uint32_t id)
{
    return (uint32_t)(id * UINT64_C(0x9e3779b97f4a7c15) >> 32) & (k->slots - 1);
}

/* The slot of the id, or the empty one where it would be; there is one. */
static uint32_t find(const struct known *k, uint32_t id)
{
    uint32_t at = home_of(k, id);
    while (k->slot[at] != 0 && k->slot[at] != id + 1)
        at = (at + 1) & (k->slots - 1);
    return at;
}

static void free_table(struct known *k)
{
    free(k->slot);
    k->slot = NULL;
    k->slots = k->count = 0;
}

static bool move_to_bits(struct known *k, uint32_t ids)
{
    struct idset bits = {.words = 0};
    bool good = idset_add(&bits, 0, ids); /* for memory even if there is no id */
    idset_remove(&bits, 0);
    for (uint32_t i = 0; good && i < k->slots; i++)
        good = k->slot[i] == 0 || idset_add(&bits, k->slot[i] - 1, ids);
    if (!good) {
        idset_clear(&bits);
        return false;
    }
    free_table(k);
    k->bits = bits;
    return true;
}

static bool grow(struct known *k, uint32_t ids)
{
    uint32_t slots = k->slots == 0 ? FIRST_SLOTS : 2 * k->slots;
    if (slots * sizeof *k->slot > ids / IDS_FOR_BYTE)
        return move_to_bits(k, ids);
    struct known larger = {
        .slot = calloc(slots, sizeof *larger.slot), .slots = slots, .count = k->count};
    if (larger.slot == NULL)
        return false;
    for (uint32_t i = 0; i < k->slots; i++)
        if (k->slot[i] != 0)
            larger.slot[find(&larger, k->slot[i] - 1)] = k->slot[i];
    free(k->slot);
    *k = larger;
    return true;
}

bool known_add(struct known *k, uint32_t id, uint32_t ids)
{
    if (known_has(k, id))
        return true;
    if (k->bits.words == 0 && 4 * ((uint64_t)k->count + 1) > 3 * (uint64_t)k->slots &&
        !grow(k, ids))
        return false;
    if (k->bits.words > 0)
        return idset_add(&k->bits, id, ids);
    k->slot[find(k, id)] = id + 1;
    k->count++;
    return true;
}

bool known_has(const struct known *k, uint32_t id)
{
    if (k->bits.words > 0)
        return idset_has(&k->bits, id);
    return k->slots > 0 && k->slot[find(k, id)] != 0;
}

/* Those behind an emptied slot move up, so that each is found from its home:
 *
 *     | a | - | c | d |      c, whose home is that of a, moves up; d stays, if its home is where it is */
static void move_up(struct known *k, uint32_t empty)
{
    uint32_t mask = k->slots - 1;
    for (uint32_t at = (empty + 1) & mask; k->slot[at] != 0; at = (at + 1) & mask) {
        uint32_t home = home_of(k, k->slot[at] - 1);
        if (((at - home) & mask) < ((at - empty) & mask))
            continue;
        k->slot[empty] = k->slot[at];
        k->slot[at] = 0;
        empty = at;
    }
}

bool known_remove(struct known *k, uint32_t id)
{
    if (k->bits.words > 0)
        return idset_remove(&k->bits, id);
    if (!known_has(k, id))
        return false;
    uint32_t at = find(k, id);
    k->slot[at] = 0;
    k->count--;
    move_up(k, at);
    return true;
}

bool known_fill(struct known *k, uint32_t ids)
{
    if (k->bits.words == 0 && !move_to_bits(k, ids))
        return false;
    return idset_fill(&k->bits, ids);
}

void known_clear(struct known *k)
{
    free_table(k);
    idset_clear(&k->bits);
}
