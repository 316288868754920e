/* pages.c - regions from malloc, for systems without mmap; see core/memory/pages.h. A keeper keeps nothing. */
#include "core/memory/pages.h"

#include <stdlib.h>

struct dt_pages {
    size_t limit; /* no effect: nothing is kept */
};

void *dt_region_take(struct dt_pages *p, size_t bytes)
{
    return malloc(bytes);
}

void *dt_region_grow(struct dt_pages *p, void *region, size_t bytes, size_t want)
{
    return realloc(region, want);
}

void *dt_region_shrink(struct dt_pages *p, void *region, size_t bytes, size_t keep)
{
    void *smaller = realloc(region, keep);
    return smaller != NULL ? smaller : region;
}

void dt_region_give(struct dt_pages *p, void *region, size_t bytes)
{
    free(region);
}

struct dt_pages *dt_pages_new(size_t limit)
{
    struct dt_pages *p = malloc(sizeof *p);
    if (p != NULL)
        p->limit = limit;
    return p;
}

void dt_pages_free(struct dt_pages *p)
{
    free(p);
}

void dt_pages_limit(struct dt_pages *p, size_t limit)
{
    p->limit = limit;
}

size_t dt_pages_trim(struct dt_pages *p, size_t bytes)
{
    return 0;
}

size_t dt_pages_prepare(struct dt_pages *p, size_t bytes)
{
    return 0;
}

void dt_pages_summary(const struct dt_pages *p, struct dt_pages_summary *out)
{
    *out = (struct dt_pages_summary){0};
}
