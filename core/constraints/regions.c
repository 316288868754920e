/* regions.c - see regions.h. */
#include "core/constraints/regions.h"

#include <stdlib.h>

void dt_regions_clear(struct dt_regions *r)
{
    free(r->region);
    free(r->range);
    free(r->sorted);
    free(r->start);
    free(r->inside);
    *r = (struct dt_regions){0};
}

size_t dt_regions_memory(const struct dt_regions *r)
{
    return r->n * (sizeof *r->region + sizeof *r->start) +
           r->ranges * (sizeof *r->range + sizeof *r->sorted) + r->faces * sizeof *r->inside;
}

static int compare_numbers(const void *key, const void *region)
{
    uint32_t a = *(const uint32_t *)key, b = ((const struct dt_region *)region)->number;
    return (a > b) - (a < b);
}

const struct dt_region *dt_regions_find(const struct dt_regions *r, uint32_t number)
{
    return r->n == 0 ? NULL : bsearch(&number, r->region, r->n, sizeof *r->region, compare_numbers);
}

/* A list with room for some, and how many there would be. */
struct list {
    uint32_t *v, room, n;
};

/* Searches the ranges lo .. hi - 1: a search tree whose root is the one in the middle. `most` is the largest end below a node
 * [Cormen et al., Introduction to Algorithms, sec. 14.3]. */
static void search(const struct dt_regions *r, uint32_t lo, uint32_t hi, uint32_t face,
                   struct list *out)
{
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        const struct dt_region_range *range = &r->range[mid];
        if (range->most <= face)
            return;
        search(r, lo, mid, face, out);
        if (range->first > face)
            return;
        if (range->end > face && out->n++ < out->room)
            out->v[out->n - 1] = range->region;
        lo = mid + 1;
    }
}

uint32_t dt_regions_of(const struct dt_regions *r, uint32_t face, uint32_t *out, uint32_t room)
{
    struct list list = {out, room, 0};
    search(r, 0, r->ranges, face, &list);
    return list.n;
}

bool dt_regions_has(const struct dt_regions *r, uint32_t region, uint32_t face)
{
    uint32_t lo = r->start[region], hi = r->start[region + 1];
    while (lo < hi) { /* the last range that does not begin behind the face is before hi */
        uint32_t mid = lo + (hi - lo) / 2;
        const struct dt_region_range *range = &r->range[r->sorted[mid]];
        if (range->first <= face && face < range->end)
            return true;
        if (range->first > face)
            hi = mid;
        else
            lo = mid + 1;
    }
    return false;
}
