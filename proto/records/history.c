/* history.c - see history.h. */
#include "proto/records/history.h"

#include <inttypes.h>
#include <stdio.h>

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

/* Reads digits of that base up to `end`, of a number that is at most `most`. */
static bool read_number(const char **at, const char *end, unsigned base, uint64_t most, uint64_t *v)
{
    const char *from = *at;
    for (*v = 0; *at < end; ++*at) {
        char c = **at;
        unsigned digit = c >= '0' && c <= '9' ? (unsigned)(c - '0') : (unsigned)(c - 'a') + 10;
        if (digit >= base || *v > (most - digit) / base)
            break;
        *v = *v * base + digit;
    }
    return *at > from;
}

bool history_read(const char *text, size_t n, struct history *h)
{
    const char *at = text, *end = text + n;
    uint64_t origin, generation, nonce;
    if (!read_number(&at, end, 16, UINT64_MAX, &origin) || at == end || *at++ != '.' ||
        !read_number(&at, end, 10, UINT32_MAX, &generation) || at == end || *at++ != '.' ||
        !read_number(&at, end, 16, UINT32_MAX, &nonce) || at != end)
        return false;
    *h = (struct history){
        .origin = origin, .generation = (uint32_t)generation, .nonce = (uint32_t)nonce};
    return true;
}
