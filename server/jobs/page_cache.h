/* page_cache.h - the page cache (dt_pages): freed pages of large arrays that the server keeps for reuse, and when
 * they are returned to the system.
 *
 * Kept pages count as free memory in the budget (budget.h): they are returned when that memory is reserved for
 * something else. If the process is larger than --max-memory nevertheless, a worker returns free memory of the heap. When the cache has not
 * been used for a while, a worker returns all of it, a piece at a time.
 *
 * A set needs pages as soon as its points have been loaded, and new pages are expensive. So while points
 * arrive, a worker prefaults pages, as many as the points so far will need. */
#pragma once

#include "server/jobs/server.h"

/* Points that are being received will need `more` bytes of large arrays, and `less` of those that were announced
 * before: workers prefault pages meanwhile. */
void page_cache_expect(struct server *s, size_t more, size_t less);

/* To be called once a second. */
void page_cache_tick(struct server *s);

/* To be called at the end of each turn of the loop: returns the pages that exceed the limit. */
void page_cache_turn_end(struct server *s);
