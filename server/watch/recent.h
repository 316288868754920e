/* recent.h - the last changes of a set, for clients that come back and know one of its last versions.
 *
 *     marks   version 5, 7 ids | version 8, 7 ids | version 9, 9 ids
 *     keys    ----2----6---------------7-----1-------------- now
 *
 * The keys behind a mark are the changes since its version. Both are rings: the oldest ones are overwritten. Marks are
 * numbered from 1: the number of the last one is the tick of the set (stamps.h). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { RECENT_KEYS = 32768, RECENT_MARKS = 8192 }; /* powers of two; 0.5 MB in all */

struct recent_mark {
    uint64_t version, at; /* how many keys there had been, */
    uint64_t altered;     /* and how many changes of constraints (altered.h) */
    uint32_t ids;         /* the next id */
};

/* Start with {0}. */
struct recent {
    uint64_t *key; /* owns `keys`, a power of two */
    struct recent_mark *mark;
    uint32_t keys, marks; /* sizes of the rings */
    uint64_t key_end, mark_first, mark_end;
};

/* Everything may have changed up to this version. */
void recent_restart(struct recent *r, uint64_t version, uint32_t ids, uint64_t altered);

/* These keys have changed since the last mark, and there is a new mark. */
void recent_put(struct recent *r, const uint64_t *key, size_t n);
void recent_mark(struct recent *r, uint64_t version, uint32_t ids, uint64_t altered);

/* The tick of the last mark whose version is not later; 0: the changes since then are unknown. */
uint64_t recent_find(const struct recent *r, uint64_t version);

/* The mark of a tick; NULL: the changes since then are unknown. */
static inline const struct recent_mark *recent_at(const struct recent *r, uint64_t tick)
{
    bool known = tick > r->mark_first && tick <= r->mark_end;
    return known ? &r->mark[(tick - 1) & (r->marks - 1)] : NULL;
}

static inline uint64_t recent_key(const struct recent *r, uint64_t at)
{
    return r->key[at & (r->keys - 1)];
}

static inline size_t recent_memory(const struct recent *r)
{
    return r->keys * sizeof *r->key + r->marks * sizeof *r->mark;
}

void recent_clear(struct recent *r);
