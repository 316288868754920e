/* pace.h - how far a piece of a reply may go: a bound of steps, and the flag that ends it.
 *
 *     tries rows within the bound  --- one alone exceeds it --->  slow: makes that one, however long it takes
 *                                  <---------------------------
 *
 * The flag is polled in both states. Work that makes a slow row must not occupy the last worker (WORK_SLOW). */
#pragma once

#include "core/delaunay.h"

struct pace {
    const dt_atomic_bool *cancel; /* borrows; NULL: never cancelled */
    uint32_t steps;               /* the bound; 0: that of a worker */
    bool slow;
};

/* Whether the caller does not need the rows any more. */
static inline bool pace_is_cancelled(const struct pace *p)
{
    return p->cancel != NULL && atomic_load_explicit(p->cancel, memory_order_relaxed);
}

/* The options of a call of the core that makes rows, given the bound of a worker. */
static inline struct dt_options pace_options(const struct pace *p, uint32_t of_worker)
{
    uint32_t steps = p->steps > 0 ? p->steps : of_worker;
    return (struct dt_options){.cancel = p->cancel, .steps = p->slow ? 0 : steps};
}

/* Takes note of the call's result, with which it has made `done` rows. True: the piece ends here. */
static inline bool pace_ends(struct pace *p, enum dt_status status, size_t done)
{
    p->slow = status == DT_TOOLONG && done == 0;
    return status != DT_OK;
}
