/* pages.c - regions in slots, taken and put by compare-and-swap; see pages.h.
 *
 *     slot     | page number | pages |       a kept region in one word, 0: none
 *
 *     take     the smallest region that is large enough; its tail stays in the slot
 *              +--------------+---------+
 *              | taken        | tail    |    one compare-and-swap does it
 *              +--------------+---------+
 *              or, if none is, fresh addresses to which kept pages are moved, as many as there are
 *     give     joined with the kept regions right before and behind it, into an empty slot
 *
 * A slot's word says all about its region, so threads need no lock, and none waits for a thread that was
 * preempted. A successful swap of a region out of its slot transfers ownership. */
#include "core/memory/pages.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { SLOTS = 256 }; /* a region for which there is none is returned to the system */

struct dt_pages {
    atomic_size_t limit; /* of held */
    atomic_size_t held;  /* bytes, kept here or in use */
    atomic_size_t kept;  /* at least those in slots */
    atomic_uint_least64_t fresh, uses;
    atomic_uint_least64_t slot[SLOTS];
};

/* ---- words ---- */

static char *start_of(uint64_t word)
{
    return (char *)((uintptr_t)(word >> 32) * DT_HUGE_PAGE); /* NOLINT: the word was made of one */
}

static size_t bytes_of(uint64_t word)
{
    return (size_t)(uint32_t)word * DT_HUGE_PAGE;
}

static uint64_t word_of(const char *start, size_t bytes)
{
    return bytes == 0 ? 0
                      : (uint64_t)((uintptr_t)start / DT_HUGE_PAGE) << 32 | bytes / DT_HUGE_PAGE;
}

/* ---- the system ---- */

/* Addresses for that many bytes, aligned to a huge page; NULL: there are none. */
static char *map_aligned(size_t bytes)
{
    char *all = mmap(NULL, bytes + DT_HUGE_PAGE, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED)
        return NULL;
    char *start = all + (dt_huge_pages((uintptr_t)all) - (uintptr_t)all);
    if (start > all)
        munmap(all, (size_t)(start - all));
    munmap(start + bytes, (size_t)(all + DT_HUGE_PAGE - start));
    (void)madvise(start, bytes, MADV_HUGEPAGE); /* best effort: without it everything is slower */
    return start;
}

/* Whether these addresses are one mapping of the system: a request to extend it in place fails with EFAULT if
 * they are several; otherwise it succeeds or finds no room. */
static bool is_one_mapping(char *start, size_t bytes)
{
    enum { LONGER = 1 };
    if (mremap(start, bytes, bytes + LONGER, 0) == MAP_FAILED)
        return errno == ENOMEM;
    munmap(start + bytes, LONGER);
    return true;
}

/* The state of a move: the bytes before `done` are at their target. The system has refused the next
 * `lost` bytes, if any, and these are still where they were. Whether their target is ours is then unknown:
 * it may have been unmapped before the failure, and mapped by another thread since. So it must not be accessed
 * or unmapped. */
struct moved {
    size_t done, lost;
};

/* Moves the pages of a region to other addresses, which are ours and hold nothing. Linux before 6.17 cannot
 * move several mappings at a time, and notices that after it has unmapped the target. So they are moved one
 * by one; no piece that is cut off is smaller than a huge page. */
static struct moved move_pages(char *from, char *to, size_t bytes, int flags)
{
    size_t step = is_one_mapping(from, bytes) ? bytes : DT_HUGE_PAGE, done = 0;
    flags |= MREMAP_MAYMOVE | MREMAP_FIXED;
    for (; done < bytes; done += step)
        if (mremap(from + done, step, step, flags, to + done) == MAP_FAILED)
            return (struct moved){done, step};
    return (struct moved){done, 0};
}

/* Unmaps the target of a refused move, except addresses that may belong to another thread by now. */
static void unmap_target(char *to, size_t bytes, struct moved m)
{
    size_t end = m.done + m.lost;
    if (m.done > 0)
        munmap(to, m.done);
    if (end < bytes)
        munmap(to + end, bytes - end);
}

/* Moves the first `bytes` of a region, which it gives up, to `to`, where there is room for `want`. The region
 * stays mapped until all has moved, so that it can be brought back. Returns where all of it is now: at
 * `to`, or, if the system refuses to move it, in a copy. NULL: it is as before, and `to` given up. */
static char *move_content(char *from, char *to, size_t bytes, size_t want)
{
    struct moved m = move_pages(from, to, bytes, MREMAP_DONTUNMAP);
    if (m.lost > 0) {
        memcpy(from, to, m.done);
        unmap_target(to, want, m);
        to = map_aligned(want);
        if (to == NULL)
            return NULL;
        memcpy(to, from, bytes);
    }
    munmap(from, bytes);
    return to;
}

/* ---- slots ---- */

/* The slot of the smallest region of at least `bytes`, else of the largest; -1: all are empty. */
static int choose(struct dt_pages *p, size_t bytes, uint64_t *word)
{
    int best = -1;
    for (int i = 0; i < SLOTS; i++) {
        uint64_t w = atomic_load_explicit(&p->slot[i], memory_order_relaxed);
        if (w == 0)
            continue;
        bool better = best < 0 || (bytes_of(w) >= bytes && bytes_of(w) < bytes_of(*word)) ||
                      (bytes_of(w) > bytes_of(*word) && bytes_of(*word) < bytes);
        if (better) {
            best = i;
            *word = w;
        }
    }
    return best;
}

/* Takes a region of at most `bytes` out of a slot, of all of them if there is one; *got is its size.
 * NULL: nothing is kept. */
static char *cut(struct dt_pages *p, size_t bytes, size_t *got)
{
    uint64_t word = 0;
    for (int i; (i = choose(p, bytes, &word)) >= 0;) {
        size_t tail = bytes_of(word) > bytes ? bytes_of(word) - bytes : 0;
        char *start = start_of(word);
        *got = bytes_of(word) - tail;
        if (atomic_compare_exchange_strong(&p->slot[i], &word, word_of(start + *got, tail))) {
            atomic_fetch_sub(&p->kept, *got);
            return start;
        }
    }
    *got = 0;
    return NULL;
}

/* Joins the region with those that lie beside it, which leave their slots. */
static void join(struct dt_pages *p, char **start, size_t *bytes)
{
    for (int i = 0; i < SLOTS; i++) {
        uint64_t w = atomic_load_explicit(&p->slot[i], memory_order_relaxed);
        if (w == 0 || (start_of(w) + bytes_of(w) != *start && *start + *bytes != start_of(w)) ||
            !atomic_compare_exchange_strong(&p->slot[i], &w, 0))
            continue;
        atomic_fetch_sub(&p->kept, bytes_of(w));
        *start = start_of(w) < *start ? start_of(w) : *start;
        *bytes += bytes_of(w);
        i = -1; /* there may be one beside the larger region */
    }
}

/* False: all slots are full. */
static bool put(struct dt_pages *p, char *start, size_t bytes)
{
    atomic_fetch_add(&p->kept, bytes);
    for (int i = 0; i < SLOTS; i++) {
        uint64_t none = 0;
        if (atomic_load_explicit(&p->slot[i], memory_order_relaxed) == 0 &&
            atomic_compare_exchange_strong(&p->slot[i], &none, word_of(start, bytes)))
            return true;
    }
    atomic_fetch_sub(&p->kept, bytes);
    return false;
}

/* Returns a region that is in no slot to the system. */
static void unmap(struct dt_pages *p, char *start, size_t bytes)
{
    munmap(start, bytes);
    atomic_fetch_sub(&p->held, bytes);
}

/* The number of bytes held beyond the limit. */
static size_t excess(struct dt_pages *p)
{
    size_t held = atomic_load(&p->held), limit = atomic_load(&p->limit);
    return held > limit ? dt_huge_pages(held - limit) : 0;
}

/* Counts `bytes` fresh bytes as in use. */
static void hold(struct dt_pages *p, size_t bytes)
{
    atomic_fetch_add(&p->held, bytes);
    atomic_fetch_add(&p->fresh, bytes);
    (void)dt_pages_trim(p, excess(p));
}

/* ---- regions ---- */

/* Keeps a region that has no owner. */
static void keep(struct dt_pages *p, char *start, size_t bytes)
{
    if (bytes > 0 && !put(p, start, bytes))
        unmap(p, start, bytes);
}

/* Moves kept pages to these addresses, as many as there are. */
static struct moved fill(struct dt_pages *p, char *to, size_t bytes)
{
    size_t done = 0, got;
    char *from;
    while (done < bytes && (from = cut(p, bytes - done, &got)) != NULL) {
        struct moved m = move_pages(from, to + done, got, 0);
        done += m.done;
        if (m.lost > 0) {
            keep(p, from + m.done, got - m.done);
            return (struct moved){done, m.lost};
        }
    }
    return (struct moved){done, 0};
}

/* Addresses for a region, with kept pages, as many as there are, from `used` on: *filled bytes. p may be
 * NULL. NULL: out of memory. */
static char *map_filled(struct dt_pages *p, size_t used, size_t bytes, size_t *filled)
{
    char *to = map_aligned(bytes);
    struct moved m = {0, 0};
    if (to != NULL && p != NULL)
        m = fill(p, to + used, bytes - used);
    *filled = m.lost == 0 ? m.done : 0;
    if (m.lost == 0)
        return to;
    keep(p, to + used, m.done);
    if (used > 0)
        munmap(to, used);
    unmap_target(to + used + m.done, bytes - used - m.done, (struct moved){0, m.lost});
    return map_aligned(bytes);
}

void *dt_region_take(struct dt_pages *p, size_t bytes)
{
    if (p == NULL)
        return map_aligned(bytes);
    atomic_fetch_add_explicit(&p->uses, 1, memory_order_relaxed);
    size_t got, filled;
    char *kept = cut(p, bytes, &got);
    if (got == bytes)
        return kept;
    keep(p, kept, got);
    char *to = map_filled(p, 0, bytes, &filled);
    if (to != NULL)
        hold(p, bytes - filled);
    return to;
}

void *dt_region_grow(struct dt_pages *p, void *region, size_t bytes, size_t want)
{
    size_t filled;
    char *to = map_filled(p, bytes, want, &filled);
    if (to == NULL)
        return NULL;
    char *at = move_content(region, to, bytes, want);
    if (at != to) { /* the kept pages that were moved behind it are lost */
        if (p != NULL)
            atomic_fetch_sub(&p->held, filled);
        filled = 0;
    }
    if (at != NULL && p != NULL) {
        atomic_fetch_add_explicit(&p->uses, 1, memory_order_relaxed);
        hold(p, want - bytes - filled);
    }
    return at;
}

void dt_region_give(struct dt_pages *p, void *region, size_t bytes)
{
    char *start = region;
    if (p == NULL) {
        munmap(start, bytes);
        return;
    }
    atomic_fetch_add_explicit(&p->uses, 1, memory_order_relaxed);
    size_t over = excess(p);
    over = over < bytes ? over : bytes;
    bytes -= over;
    if (over > 0)
        unmap(p, start + bytes, over);
    if (bytes == 0)
        return;
    join(p, &start, &bytes);
    keep(p, start, bytes);
}

void *dt_region_shrink(struct dt_pages *p, void *region, size_t bytes, size_t keep)
{
    dt_region_give(p, (char *)region + keep, bytes - keep);
    return region;
}

/* ---- the keeper ---- */

struct dt_pages *dt_pages_new(size_t limit)
{
    struct dt_pages *p = calloc(1, sizeof *p);
    if (p != NULL)
        atomic_init(&p->limit, limit);
    return p;
}

void dt_pages_free(struct dt_pages *p)
{
    if (p != NULL)
        (void)dt_pages_trim(p, SIZE_MAX);
    free(p);
}

void dt_pages_limit(struct dt_pages *p, size_t limit)
{
    atomic_store(&p->limit, limit);
}

size_t dt_pages_trim(struct dt_pages *p, size_t bytes)
{
    size_t done = 0, got;
    char *start;
    bytes = bytes > SIZE_MAX / 2 ? bytes & ~(DT_HUGE_PAGE - 1) : dt_huge_pages(bytes);
    while (done < bytes && (start = cut(p, bytes - done, &got)) != NULL) {
        unmap(p, start, got);
        done += got;
    }
    return done;
}

/* Bytes that may still be held, in huge pages. */
static size_t room(const struct dt_pages *p)
{
    size_t held = atomic_load(&p->held), limit = atomic_load(&p->limit);
    return (limit > held ? limit - held : 0) & ~(DT_HUGE_PAGE - 1);
}

/* The limit may change meanwhile, and others take memory: so pages are counted before they are written to, and kept one by one. */
size_t dt_pages_prepare(struct dt_pages *p, size_t bytes)
{
    enum { SMALL_PAGE = 4096 }; /* no page is smaller, so each is written to */
    size_t most = room(p), done = 0;
    bytes = bytes < most ? dt_huge_pages(bytes) : most;
    char *start = bytes > 0 ? map_aligned(bytes) : NULL;
    if (start == NULL)
        return 0;
    for (; done < bytes && room(p) > 0; done += DT_HUGE_PAGE) {
        atomic_fetch_add(&p->held, DT_HUGE_PAGE);
        atomic_fetch_add(&p->fresh, DT_HUGE_PAGE);
        for (size_t at = 0; at < DT_HUGE_PAGE; at += SMALL_PAGE)
            start[done + at] = 0;
        dt_region_give(p, start + done, DT_HUGE_PAGE);
    }
    if (done < bytes)
        munmap(start + done, bytes - done);
    return done;
}

void dt_pages_summary(const struct dt_pages *p, struct dt_pages_summary *out)
{
    *out = (struct dt_pages_summary){.held = atomic_load(&p->held),
                                     .kept = atomic_load(&p->kept),
                                     .fresh = atomic_load(&p->fresh),
                                     .uses = atomic_load(&p->uses)};
}
