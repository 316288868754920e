/* stamps.c - see stamps.h. */
#include "server/watch/stamps.h"

#include <stdlib.h>
#include <string.h>

void stamps_clear(struct stamps *s)
{
    for (uint32_t i = 0; i < s->blocks; i++)
        free(s->block[i]);
    free(s->block);
    *s = (struct stamps){.blocks = 0};
}

static bool make_room(struct stamps *s, uint32_t block)
{
    uint32_t blocks = block + 1 > 2 * s->blocks ? block + 1 : 2 * s->blocks;
    if (block < s->blocks)
        return true;
    uint32_t **larger = realloc(s->block, blocks * sizeof *larger);
    if (larger == NULL)
        return false;
    memset(larger + s->blocks, 0, (blocks - s->blocks) * sizeof *larger);
    s->block = larger;
    s->blocks = blocks;
    return true;
}

static uint32_t *block_of(struct stamps *s, uint32_t id)
{
    uint32_t at = id / STAMPS_IN_BLOCK;
    if (!make_room(s, at))
        return NULL;
    if (s->block[at] == NULL) {
        s->block[at] = calloc(STAMPS_IN_BLOCK, sizeof **s->block);
        s->used += s->block[at] != NULL;
    }
    return s->block[at];
}

bool stamps_put(struct stamps *s, uint32_t id, uint64_t tick)
{
    uint32_t *block = tick - s->base > UINT32_MAX ? NULL : block_of(s, id);
    if (block == NULL) {
        stamps_clear(s);
        s->base = tick - 1;
        return false;
    }
    block[id % STAMPS_IN_BLOCK] = (uint32_t)(tick - s->base);
    return true;
}
