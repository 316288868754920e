/* pages.h - regions of whole huge pages for large arrays, taken from a keeper (dt_pages) that has kept
 * some, or from the system.
 *
 * Fresh pages are expensive: the system clears them, and under a hypervisor it may have to find them first.
 * So the pages that one array releases are kept for the next one, in pieces of any size. A region can be cut
 * at every huge page. A large region is put together from small ones by moving their pages.
 *
 * pages.c does this on Linux. plain/pages.c is for systems without mmap, such as WebAssembly: regions are from malloc, and
 * nothing is kept. A program contains one of the two. */
#pragma once

#include "core/delaunay.h"

#define DT_HUGE_PAGE ((size_t)2 << 20)

/* The bytes of all huge pages that `bytes` <= SIZE_MAX / 2 touch. */
static inline size_t dt_huge_pages(size_t bytes)
{
    return (bytes + DT_HUGE_PAGE - 1) & ~(DT_HUGE_PAGE - 1);
}

/* A region of that size (whole huge pages, not 0), aligned to a huge page; its contents are anything.
 * p may be NULL: then the region comes from the system, and returns to it. NULL: out of memory. The caller owns it. */
void *dt_region_take(struct dt_pages *p, size_t bytes);

/* Grows the region to `want` > bytes. Keeps its first `bytes`; it may move. NULL: out of memory, it is
 * unchanged. Cost: O(pages), unless the system refuses to move them. */
void *dt_region_grow(struct dt_pages *p, void *region, size_t bytes, size_t want);

/* Gives back the bytes behind the first `keep` bytes, 0 < keep < bytes. Returns the region, which may have moved. */
void *dt_region_shrink(struct dt_pages *p, void *region, size_t bytes, size_t keep);

/* p: where it was taken. */
void dt_region_give(struct dt_pages *p, void *region, size_t bytes);
