/* memory.c - small arrays from malloc, large ones mapped on their own; see memory.h.
 *
 *      | header | items ...     the header says how the block was obtained; it takes a cache line,
 *      0        64              so that records of half a line do not straddle two */
#include "core/memory.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)
#define HEADER 64
#define SPARES 32u
#define SPARE_BYTES ((size_t)512 << 20) /* all spare ranges together */

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

/* ---- spare ranges: freed, still mapped, whole huge pages ---- */

struct spare {
    char *at;
    size_t bytes;
};

static struct {
    pthread_mutex_t lock;
    struct spare range[SPARES]; /* the longest kept first */
    unsigned n;
    size_t bytes;
} spares = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* Takes range i out of the list; the lock is held. */
static struct spare take_spare(unsigned i)
{
    struct spare s = spares.range[i];
    spares.bytes -= s.bytes;
    spares.n--;
    memmove(&spares.range[i], &spares.range[i + 1], (spares.n - i) * sizeof s);
    return s;
}

/* A range of that size, cut from the smallest spare one that will do; NULL if there is none. */
static char *find_spare(size_t bytes)
{
    char *at = NULL;
    pthread_mutex_lock(&spares.lock);
    unsigned best = SPARES;
    for (unsigned i = 0; i < spares.n; i++)
        if (spares.range[i].bytes >= bytes &&
            (best == SPARES || spares.range[i].bytes < spares.range[best].bytes))
            best = i;
    if (best < SPARES) {
        struct spare *s = &spares.range[best];
        at = s->at;
        s->at += bytes;
        s->bytes -= bytes;
        spares.bytes -= bytes;
        if (s->bytes == 0)
            take_spare(best);
    }
    pthread_mutex_unlock(&spares.lock);
    return at;
}

/* Keeps a range; those kept for the longest time make way. */
static void keep_spare(char *at, size_t bytes)
{
    struct spare gone[SPARES];
    unsigned n = 0;
    (void)madvise(at, bytes, MADV_FREE); /* the system may have the pages if it needs them */
    pthread_mutex_lock(&spares.lock);
    while (spares.n == SPARES || (spares.n > 0 && spares.bytes + bytes > SPARE_BYTES))
        gone[n++] = take_spare(0);
    spares.range[spares.n++] = (struct spare){at, bytes};
    spares.bytes += bytes;
    pthread_mutex_unlock(&spares.lock);
    while (n-- > 0)
        munmap(gone[n].at, gone[n].bytes);
}

static void drop_spares(void)
{
    struct spare s = {0};
    do {
        pthread_mutex_lock(&spares.lock);
        bool any = spares.n > 0;
        if (any)
            s = take_spare(0);
        pthread_mutex_unlock(&spares.lock);
        if (!any)
            return;
        munmap(s.at, s.bytes);
    } while (true);
}

size_t dt_memory_spare(void)
{
    pthread_mutex_lock(&spares.lock);
    size_t bytes = spares.bytes;
    pthread_mutex_unlock(&spares.lock);
    return bytes;
}

/* ---- arrays ---- */

static void *new_mapped(size_t bytes)
{
    struct header *h = (void *)find_spare(round_up(bytes));
    if (h == NULL)
        h = (void *)map_aligned(round_up(bytes));
    if (h == NULL) {
        drop_spares();
        h = (void *)map_aligned(round_up(bytes));
    }
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
    if (h->mapped == 0)
        free(h);
    else if (h->mapped <= SPARE_BYTES)
        keep_spare((char *)h, h->mapped);
    else
        munmap(h, h->mapped);
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
