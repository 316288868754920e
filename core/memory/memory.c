/* memory.c - small arrays from malloc, large ones in regions of their own (core/memory/pages.h); see memory.h.
 *
 *      | header | items ...     the header says where the block is from; it takes a cache line, so
 *      0        64              that records of half a line do not straddle two */
#include "core/memory/memory.h"

#include <stdint.h>
#include <stdlib.h>

#include "core/memory/pages.h"

#define LARGE (DT_HUGE_PAGE / 2 * 3)
#define HEADER 64

struct header {
    size_t region; /* bytes of its region, header included; 0: from malloc */
    struct dt_pages *pages;
};

static struct header *header_of(void *p)
{
    return (void *)((char *)p - HEADER);
}

void *dt_array_new_in(struct dt_pages *pages, size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX / 2 - HEADER) / size)
        return NULL;
    size_t bytes = n * size + HEADER, region = bytes >= LARGE ? dt_huge_pages(bytes) : 0;
    struct header *h = region > 0 ? dt_region_take(pages, region) : malloc(bytes);
    if (h == NULL)
        return NULL;
    *h = (struct header){region, pages};
    return (char *)h + HEADER;
}

static void *resize_region(struct header *h, size_t bytes)
{
    size_t want = dt_huge_pages(bytes), have = h->region;
    if (want < have)
        h = dt_region_shrink(h->pages, h, have, want);
    else if (want > have)
        h = dt_region_grow(h->pages, h, have, want);
    if (h == NULL)
        return NULL;
    h->region = want;
    return (char *)h + HEADER;
}

void *dt_array_grow_in(struct dt_pages *pages, void *p, size_t used, size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX / 2 - HEADER) / size)
        return NULL;
    if (p != NULL && header_of(p)->region != 0)
        return resize_region(header_of(p), n * size + HEADER);
    void *larger = dt_array_new_in(pages, n, size);
    if (larger == NULL)
        return NULL;
    if (p != NULL && used > 0)
        memcpy(larger, p, used * size);
    dt_array_free(p);
    return larger;
}

bool dt_array_resize(struct dt_pages *pages, void *array, size_t used, size_t n, size_t size)
{
    void *items;
    memcpy(&items, array, sizeof items);
    items = dt_array_grow_in(pages, items, used, n, size);
    if (items != NULL)
        memcpy(array, &items, sizeof items);
    return items != NULL;
}

size_t dt_array_bytes(size_t n, size_t size)
{
    size_t bytes = n * size + HEADER;
    return bytes >= LARGE ? dt_huge_pages(bytes) : bytes;
}

void dt_array_free(void *p)
{
    if (p == NULL)
        return;
    struct header *h = header_of(p);
    if (h->region != 0)
        dt_region_give(h->pages, h, h->region);
    else
        free(h);
}

size_t dt_array_room(size_t cap, size_t need, size_t limit)
{
    size_t room = cap + cap / 2;
    if (room < need)
        room = need;
    if (room < 16)
        room = 16;
    return room > limit ? limit : room;
}

enum dt_status dt_items_reserve(void *array, size_t need, size_t *cap, size_t size)
{
    void *items;
    if (need <= *cap)
        return DT_OK;
    size_t room = dt_array_room(*cap, need, SIZE_MAX / size);
    memcpy(&items, array, sizeof items);
    items = need > room ? NULL : realloc(items, room * size);
    if (items == NULL)
        return DT_NOMEM;
    memcpy(array, &items, sizeof items);
    *cap = room;
    return DT_OK;
}

/* ---- arrays of callers of the core ---- */

void *dt_pages_grow(struct dt_pages *p, void *array, size_t used, size_t bytes)
{
    return dt_array_grow_in(p, array, used, bytes, 1);
}

void dt_pages_release(void *array)
{
    dt_array_free(array);
}
