/* pairs.h - sets of pairs of a tile and a local id, which say what is sent where. */
#pragma once

#include "core/delaunay.h"

struct dt_pairs {
    uint64_t *v; /* owns `cap`; each is tile << 32 | local id */
    size_t n, cap;
};

static inline uint64_t dt_pair(uint32_t tile, uint32_t local)
{
    return (uint64_t)tile << 32 | local;
}

/* Frees the memory; *p can be used again. */
void dt_pairs_clear(struct dt_pairs *p);

/* Adds a pair, which may be there already. The pairs are then in no order. DT_NOMEM: *p is unchanged as a set. Cost: amortised
 * constant. The memory is proportional to the number of different pairs. */
enum dt_status dt_pairs_add(struct dt_pairs *p, uint64_t pair);

/* Sorts the pairs, and leaves each once. */
void dt_pairs_sort(struct dt_pairs *p);

/* Removes those of *p that *other has; both are sorted. Cost: linear. */
void dt_pairs_subtract(struct dt_pairs *p, const struct dt_pairs *other);

/* *p becomes the union of both, which are sorted and have no pair in common. DT_NOMEM: *p is unchanged. Cost: linear. */
enum dt_status dt_pairs_merge(struct dt_pairs *p, const struct dt_pairs *other);
