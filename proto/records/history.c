/* history.c - see history.h. */
#include "proto/records/history.h"

#include "proto/number.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

struct history history_begin(uint64_t random)
{
    uint32_t nonce = (uint32_t)(random >> 32) ^ (uint32_t)random;
    return (struct history){.origin = random == 0 ? 1 : random, .generation = 1, .nonce = nonce};
}

struct history history_next(const struct history *h, uint32_t random)
{
    struct history next = *h;
    next.generation++;
    next.parent = h->nonce;
    next.nonce = random;
    return next;
}

enum history_relation history_relation(const struct history *h, const struct history *own)
{
    if (h->origin != own->origin || h->origin == 0)
        return HISTORY_DIFFERENT;
    if (h->generation != own->generation)
        return h->generation > own->generation ? HISTORY_NEWER : HISTORY_OLDER;
    return h->nonce == own->nonce ? HISTORY_SAME : HISTORY_BESIDE;
}

void history_write(char text[HISTORY_TEXT], const struct history *h)
{
    snprintf(text, HISTORY_TEXT, "%016" PRIx64 ".%" PRIu32 ".%08" PRIx32, h->origin, h->generation,
             h->nonce);
}

bool history_read(const char *text, size_t n, struct history *h)
{
    const char *end = text + n, *dot = memchr(text, '.', n);
    const char *last = dot == NULL ? NULL : memchr(dot + 1, '.', (size_t)(end - dot - 1));
    uint64_t origin, nonce;
    uint32_t generation = 0;
    if (last == NULL || !proto_read_hex(text, (size_t)(dot - text), &origin) ||
        !proto_read_u32(dot + 1, (size_t)(last - dot - 1), &generation) ||
        !proto_read_hex(last + 1, (size_t)(end - last - 1), &nonce) || nonce > UINT32_MAX)
        return false;
    *h = (struct history){.origin = origin, .generation = generation, .nonce = (uint32_t)nonce};
    return true;
}
