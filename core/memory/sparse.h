/* sparse.h - an ordered map from a few ids among many to 32-bit values.
 *
 * The ids are cut into pages of 4096. A page has a bit for each of its ids and the values of those that
 * are in the map, one after the other:
 *
 *      bits      0 1 0 0 | 1 0 1 0 | ...     ids 1, 4 and 6 of the page
 *      before    0       | 1       | ...     bits set in the words before
 *      value     v1 v4 v6
 *
 * So memory follows the ids that are in the map, about 7 bytes each where they are one in a dozen, and the
 * next one is found by looking at bits (core/points/idmap.h is for ids most of which have a value). */
#ifndef DT_SPARSE_H
#define DT_SPARSE_H

#include "core/delaunay.h"

#define DT_SPARSE_PAGE 4096u

struct dt_sparse_page {
    uint64_t bits[DT_SPARSE_PAGE / 64];
    uint16_t before[DT_SPARSE_PAGE / 64];
    uint32_t *value; /* owns cap */
    uint32_t n, cap;
};

/* Start with {0}. */
struct dt_sparse {
    struct dt_sparse_page **page; /* owns `pages`; NULL: no id of it is in the map */
    uint32_t pages;
    uint32_t n;    /* ids in the map */
    size_t memory; /* bytes of the pages */
};

void dt_sparse_clear(struct dt_sparse *m);
size_t dt_sparse_memory(const struct dt_sparse *m);

/* Whether the map has the id; if so, *value is its value. Cost: constant. */
static inline bool dt_sparse_get(const struct dt_sparse *m, uint32_t id, uint32_t *value)
{
    uint32_t i = id / DT_SPARSE_PAGE, word = id % DT_SPARSE_PAGE / 64;
    if (i >= m->pages || m->page[i] == NULL)
        return false;
    const struct dt_sparse_page *p = m->page[i];
    uint64_t bit = (uint64_t)1 << id % 64;
    if ((p->bits[word] & bit) == 0)
        return false;
    *value = p->value[p->before[word] + (uint32_t)__builtin_popcountll(p->bits[word] & (bit - 1))];
    return true;
}

/* Gives an id its value. DT_NOMEM: as before. Cost: the number of ids of a page. */
enum dt_status dt_sparse_set(struct dt_sparse *m, uint32_t id, uint32_t value);

/* Removes an id that is in the map. Cost: as dt_sparse_set. */
void dt_sparse_unset(struct dt_sparse *m, uint32_t id);

/* Takes the largest ids out of the map, up to n pages of them. Returns how many pages: fewer than n when the map
 * is empty. Cost: O(pages of the table that are passed). */
uint32_t dt_sparse_drop(struct dt_sparse *m, uint32_t n);

/* The smallest id >= from in the map, DT_NONE if there is none. Cost: O(pages between the two). */
uint32_t dt_sparse_next(const struct dt_sparse *m, uint32_t from);

/* As dt_idmap_after: an id with about n ids of the map from `from` up to it, DT_NONE if there are fewer.
 * Cost: O(pages between the two). */
uint32_t dt_sparse_after(const struct dt_sparse *m, uint32_t from, uint32_t n);

#endif
