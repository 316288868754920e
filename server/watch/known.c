/* known.c - see known.h. The table is probed linearly. */
#include "server/watch/known.h"

#include <stdlib.h>
#include <string.h>

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

/* ---- bits ---- */

static bool make_room(struct known *k, uint32_t id, uint32_t ids)
{
    uint32_t need = id / 64 + 1, words = ids / 64 + 1;
    if (need <= k->words)
        return true;
    words = words > need ? words : need;
    uint64_t *larger = realloc(k->bits, words * sizeof *larger);
    if (larger == NULL)
        return false;
    memset(larger + k->words, 0, (words - k->words) * sizeof *larger);
    k->bits = larger;
    k->words = words;
    return true;
}

static bool set_bit(struct known *k, uint32_t id, uint32_t ids)
{
    bool room = make_room(k, id, ids);
    if (room)
        k->bits[id / 64] |= (uint64_t)1 << id % 64;
    return room;
}

static bool move_to_bits(struct known *k, uint32_t ids)
{
    struct known bits = {.words = 0};
    bool good = make_room(&bits, 0, ids); /* even if there is no id */
    for (uint32_t i = 0; good && i < k->slots; i++)
        good = k->slot[i] == 0 || set_bit(&bits, k->slot[i] - 1, ids);
    known_clear(good ? k : &bits);
    if (good)
        *k = bits;
    return good;
}

/* ---- both ---- */

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
    if (k->words == 0 && 4 * ((uint64_t)k->count + 1) > 3 * (uint64_t)k->slots && !grow(k, ids))
        return false;
    if (k->words > 0)
        return set_bit(k, id, ids);
    k->slot[find(k, id)] = id + 1;
    k->count++;
    return true;
}

bool known_has(const struct known *k, uint32_t id)
{
    if (k->words > 0)
        return id / 64 < k->words && (k->bits[id / 64] >> id % 64 & 1) != 0;
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
    if (!known_has(k, id))
        return false;
    if (k->words > 0) {
        k->bits[id / 64] &= ~((uint64_t)1 << id % 64);
        return true;
    }
    uint32_t at = find(k, id);
    k->slot[at] = 0;
    k->count--;
    move_up(k, at);
    return true;
}

bool known_fill(struct known *k, uint32_t ids)
{
    if ((k->words == 0 && !move_to_bits(k, ids)) || (ids > 0 && !make_room(k, ids - 1, ids)))
        return false;
    memset(k->bits, 0xff, ids / 64 * sizeof *k->bits);
    if (ids % 64 != 0)
        k->bits[ids / 64] |= ((uint64_t)1 << ids % 64) - 1;
    return true;
}

void known_clear(struct known *k)
{
    free(k->slot);
    free(k->bits);
    *k = (struct known){.words = 0};
}
