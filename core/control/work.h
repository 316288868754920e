/* work.h - how much work a call may still do: until the caller's flag is set, and as many steps as
 * the caller allows (struct dt_options).
 *
 * A long loop polls now and then:
 *
 *     if ((i & DT_WORK_MASK) == 0 && (status = dt_work(w, DT_WORK_BLOCK)) != DT_OK)
 *         return status;
 */
#ifndef DT_WORK_H
#define DT_WORK_H

#include "core/control/stop.h"

/* Steps between two polls of the flag. */
#define DT_WORK_BLOCK 256u
#define DT_WORK_MASK (DT_WORK_BLOCK - 1)

struct dt_work {
    const atomic_bool *cancel; /* borrows; NULL: never set */
    uint64_t left;             /* steps; more than UINT32_MAX: no limit */
};

/* opt may be NULL: no end. */
static inline struct dt_work dt_work_of(const struct dt_options *opt)
{
    struct dt_work w = {NULL, UINT64_MAX};
    if (opt != NULL)
        w = (struct dt_work){opt->cancel, opt->steps == 0 ? UINT64_MAX : opt->steps};
    return w;
}

/* For passes that look at the flag only. w may be NULL. */
static inline struct dt_stop dt_work_stop(const struct dt_work *w)
{
    return (struct dt_stop){.cancel = w == NULL ? NULL : w->cancel};
}

/* Whether there is a limit of steps. w may be NULL. */
static inline bool dt_work_is_limited(const struct dt_work *w)
{
    return w != NULL && w->left <= UINT32_MAX;
}

/* Whether so many steps are left. w may be NULL: no end. */
static inline bool dt_work_allows(const struct dt_work *w, uint64_t steps)
{
    return w == NULL || steps <= w->left;
}

/* Subtracts the steps from what is left. DT_CANCELLED, DT_TOOLONG: the call must end. w may be NULL. */
static inline enum dt_status dt_work(struct dt_work *w, uint64_t steps)
{
    if (w == NULL)
        return DT_OK;
    if (w->cancel != NULL && atomic_load_explicit(w->cancel, memory_order_relaxed))
        return DT_CANCELLED;
    if (steps > w->left)
        return DT_TOOLONG;
    w->left -= steps;
    return DT_OK;
}

#endif
