/* idmap.h - a paged map from ids to 32-bit values: which vertex or alias an id is.
 *
 * Ids are assigned in ascending order and never reused, so the ids of a set that is edited for a long time
 * keep growing. The map consists of pages, and pages whose ids are all dead are freed: its memory is
 * proportional to the live ids, not to the largest one. If many ids are added at once, their pages are in
 * blocks; each block is a huge page of the system and is freed as a whole. Looking up any of millions of ids
 * then costs one cache miss, without another one for the address of its page. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay.h"
#include "core/memory/memory.h"

#define DT_ID_PAGE 1024u /* 4 KiB: what a small set takes */

#define DT_ID_BLOCK 512u /* pages; the first one's number is a multiple of it */

struct dt_id_page {
    uint32_t *value; /* owns DT_ID_PAGE words, alone or in a block; NULL: no id of it is live */
    uint32_t live;   /* ids of the page that have a value */
    bool in_block;
};

struct dt_idmap {
    struct dt_pages *keeper; /* borrows; where blocks come from; NULL: the system */
    struct dt_id_page *page; /* owns */
    uint32_t pages, cap;
    uint32_t held;  /* pages that are there */
    uint32_t empty; /* of them: perhaps without a live id; 0 after dt_idmap_trim */
};

/* It keeps its keeper. */
void dt_idmap_clear(struct dt_idmap *m);

/* The value of id, DT_NONE if it has none. Cost: constant. */
static inline uint32_t dt_idmap_get(const struct dt_idmap *m, uint32_t id)
{
    uint32_t page = id / DT_ID_PAGE;
    if (page >= m->pages || m->page[page].value == NULL)
        return DT_NONE;
    return m->page[page].value[id % DT_ID_PAGE];
}

/* Fetches the word that dt_idmap_get of the id will read. */
static inline void dt_idmap_fetch(const struct dt_idmap *m, uint32_t id)
{
    uint32_t page = id / DT_ID_PAGE;
    if (page < m->pages && m->page[page].value != NULL)
        dt_fetch(&m->page[page].value[id % DT_ID_PAGE]);
}

/* Makes room for the ids first .. first + n - 1, so that setting them before the next dt_idmap_trim
 * cannot fail. DT_NOMEM: nothing changes, except that empty pages may be added. */
enum dt_status dt_idmap_reserve(struct dt_idmap *m, uint32_t first, size_t n);

/* Gives a reserved or live id a value other than DT_NONE. */
void dt_idmap_set(struct dt_idmap *m, uint32_t id, uint32_t value);

/* The address of the value of a live id, for writing values other than DT_NONE. Threads may write at the same time for
 * different ids. If reserved ids get values in this way, dt_idmap_count must follow. */
static inline uint32_t *dt_idmap_at(struct dt_idmap *m, uint32_t id)
{
    return &m->page[id / DT_ID_PAGE].value[id % DT_ID_PAGE];
}

/* Counts ids as live: those that have a value among `first` and the n - 1 ids after it. None of these was live before. */
void dt_idmap_count(struct dt_idmap *m, uint32_t first, size_t n);

/* Removes the value of a live id. */
void dt_idmap_unset(struct dt_idmap *m, uint32_t id);

/* Frees pages and blocks without a live id if there may be more than a few. Cost: amortised constant. */
void dt_idmap_trim(struct dt_idmap *m);

/* Removes the values of the largest ids, up to n pages of them, from a map that has no blocks; false: there were
 * none left. */
bool dt_idmap_drop(struct dt_idmap *m, uint32_t n);

/* The smallest id >= from that has a value, DT_NONE if none. */
uint32_t dt_idmap_next(const struct dt_idmap *m, uint32_t from);

/* Returns an id with about n live ids from `from` up to it. The number is exact if the live ids of a page are spread evenly
 * over the page. DT_NONE if there are fewer. Cost: O(pages between the two). */
uint32_t dt_idmap_after(const struct dt_idmap *m, uint32_t from, uint32_t n);

/* DT_OK, or DT_NOMEM, and *copy is cleared. If it is stopped, values are missing; stop may be NULL. */
enum dt_status dt_idmap_copy(const struct dt_idmap *m, struct dt_idmap *copy, struct dt_stop *stop);
size_t dt_idmap_memory(const struct dt_idmap *m);
