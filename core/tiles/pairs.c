/* pairs.c - see pairs.h. */
#include "core/tiles/pairs.h"

#include <string.h>

#include "core/memory/memory.h"
#include "core/memory/sort.h"

void dt_pairs_clear(struct dt_pairs *p)
{
    dt_array_free(p->v);
    *p = (struct dt_pairs){0};
}

void dt_pairs_sort(struct dt_pairs *p)
{
    p->n = dt_sort_unique_keys(p->v, p->n);
}

/* Makes room for n pairs. */
static enum dt_status reserve(struct dt_pairs *p, size_t n)
{
    if (n <= p->cap)
        return DT_OK;
    if (!dt_array_resize(NULL, &p->v, p->n, n, sizeof *p->v))
        return DT_NOMEM;
    p->cap = n;
    return DT_OK;
}

/* A full array grows only if it is at least half full of different pairs. */
enum dt_status dt_pairs_add(struct dt_pairs *p, uint64_t pair)
{
    enum { FIRST = 256 };
    if (p->n > 0 && p->v[p->n - 1] == pair)
        return DT_OK;
    if (p->n == p->cap) {
        dt_pairs_sort(p);
        if (2 * p->n >= p->cap && reserve(p, p->cap == 0 ? FIRST : 2 * p->cap) != DT_OK)
            return DT_NOMEM;
    }
    p->v[p->n++] = pair;
    return DT_OK;
}

void dt_pairs_subtract(struct dt_pairs *p, const struct dt_pairs *other)
{
    size_t kept = 0;
    for (size_t i = 0, k = 0; i < p->n; i++) {
        while (k < other->n && other->v[k] < p->v[i])
            k++;
        if (k == other->n || other->v[k] != p->v[i])
            p->v[kept++] = p->v[i];
    }
    p->n = kept;
}

/* From the largest pair down, so that nothing is overwritten before it is read. */
enum dt_status dt_pairs_merge(struct dt_pairs *p, const struct dt_pairs *other)
{
    size_t i = p->n, k = other->n, at = p->n + other->n;
    if (reserve(p, at) != DT_OK)
        return DT_NOMEM;
    p->n = at;
    while (k > 0)
        p->v[--at] = i > 0 && p->v[i - 1] > other->v[k - 1] ? p->v[--i] : other->v[--k];
    return DT_OK;
}
