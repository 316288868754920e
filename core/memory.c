/* memory.c - small arrays from malloc, large ones mapped on their own; see memory.h.
 *
 *      | header | items ...     the header says how the block was obtained; it takes a cache line,
 *      0        64              so that records of half a line do not straddle two */
#include "core/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)
#define HEADER 64

struct header {
    size_t mapped; /* bytes, header included; 0: from malloc */
};

static struct header *header_of(void *p)
{
    return (void *)((char *)p - HEADER);
}

static size_t round_up(size_t bytes)
{
    return (bytes + HUGE_PAGE - 1) & ~(HUGE_PAGE - 1);
}

/* Address space of that size (whole huge pages), aligned to a huge page; NULL: there is none. */
static char *map_aligned(size_t bytes)
{
    char *all = mmap(NULL, bytes + HUGE_PAGE, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED)
        return NULL;
    char *start = all + (round_up((uintptr_t)all) - (uintptr_t)all);
    if (start > all)
        munmap(all, (size_t)(start - all));
    munmap(start + bytes, (size_t)(all + HUGE_PAGE - start));
    (void)madvise(start, bytes,
                  MADV_HUGEPAGE); /* a wish: without it everything works, only slower */
    return start;
}

static void *new_mapped(size_t bytes)
{
    struct header *h = (void *)map_aligned(round_up(bytes));
    if (h == NULL)
        return NULL;
    h->mapped = round_up(bytes);
    return (char *)h + HEADER;
}

void *dt_array_new(size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX / 2 - HEADER) / size)
        return NULL;
    size_t bytes = n * size + HEADER;
    if (bytes >= 2 * HUGE_PAGE)
        return new_mapped(bytes);
    struct header *h = malloc(bytes);
    if (h == NULL)
        return NULL;
    h->mapped = 0;
    return (char *)h + HEADER;
}

/* Moves the pages of a mapped array to a larger range. */
static void *grow_mapped(void *p, size_t bytes)
{
    struct header *h = header_of(p);
    size_t want = round_up(bytes);
    if (want <= h->mapped)
        return p;
    char *to = map_aligned(want);
    if (to == NULL)
        return NULL;
    h = mremap(h, h->mapped, want, MREMAP_MAYMOVE | MREMAP_FIXED, to);
    if (h == MAP_FAILED) {
        munmap(to, want);
        return NULL;
    }
    (void)madvise(h, want, MADV_HUGEPAGE);
    h->mapped = want;
    return (char *)h + HEADER;
}

void *dt_array_grow(void *p, size_t used, size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX / 2 - HEADER) / size)
        return NULL;
    if (p != NULL && header_of(p)->mapped != 0)
        return grow_mapped(p, n * size + HEADER);
    void *larger = dt_array_new(n, size);
    if (larger == NULL)
        return NULL;
    if (p != NULL && used > 0)
        memcpy(larger, p, used * size);
    dt_array_free(p);
    return larger;
}

void dt_array_free(void *p)
{
    if (p == NULL)
        return;
    struct header *h = header_of(p);
    if (h->mapped != 0)
        munmap(h, h->mapped);
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
