/* stop.h - the reasons to end a call early: the caller's cancel flag, the caller's limit of steps, or a failure in one of the
 * threads. All threads of a computation share one and poll it at regular intervals; unfinished results are discarded.
 *
 * A pass over an array polls (dt_stopped). A call that may take a limited number of steps counts them as well, in one
 * thread; there it is called `work`, and a long loop does
 *
 *     if ((i & DT_WORK_MASK) == 0 && (status = dt_work(work, DT_WORK_BLOCK)) != DT_OK)
 *         return status;
 */
#pragma once

#include "core/delaunay.h"

/* How many steps are done between two polls: cheap steps, such as points of a pass; steps that wait for memory;
 * and steps each of which may be the first to touch a huge page, which the system then clears. */
#define DT_POLL (1u << 16)
#define DT_POLL_MISSES (1u << 12)
#define DT_POLL_FAULTS 128u

/* Steps that are counted at once. */
#define DT_WORK_BLOCK 256u
#define DT_WORK_MASK (DT_WORK_BLOCK - 1)

struct dt_stop {
    const atomic_bool *cancel; /* borrowed; NULL: never cancelled */
    atomic_int status; /* enum dt_status: the first reason to stop, DT_OK while there is none */
    uint64_t left;     /* steps; more than UINT32_MAX: no limit */
};

/* For a call with these options, which may be NULL: no end. */
static inline struct dt_stop dt_stop_of(const struct dt_options *opt)
{
    if (opt == NULL)
        return (struct dt_stop){.left = UINT64_MAX};
    return (struct dt_stop){.cancel = opt->cancel,
                            .left = opt->steps == 0 ? UINT64_MAX : opt->steps};
}

/* Polls: whether there is a reason to stop. Once true, it stays true. NULL: never. */
bool dt_stopped(struct dt_stop *s);

/* Records a reason, unless there is one already. */
void dt_stop_because(struct dt_stop *s, enum dt_status why);

/* The reason that is known so far, without a poll. */
static inline enum dt_status dt_stop_status(const struct dt_stop *s)
{
    return (enum dt_status)atomic_load_explicit(&s->status, memory_order_relaxed);
}

/* ---- steps ---- */

/* Whether there is a limit. NULL: no. */
static inline bool dt_work_is_limited(const struct dt_stop *work)
{
    return work != NULL && work->left <= UINT32_MAX;
}

/* Whether at least `steps` steps are left. NULL: no end. */
static inline bool dt_work_allows(const struct dt_stop *work, uint64_t steps)
{
    return work == NULL || steps <= work->left;
}

/* Subtracts the steps from what is left. DT_CANCELLED, DT_TOOLONG: the call must end. NULL: never. */
static inline enum dt_status dt_work(struct dt_stop *work, uint64_t steps)
{
    if (work == NULL)
        return DT_OK;
    if (work->cancel != NULL && atomic_load_explicit(work->cancel, memory_order_relaxed))
        return DT_CANCELLED;
    if (steps > work->left)
        return DT_TOOLONG;
    work->left -= steps;
    return DT_OK;
}

/* ---- a pass in pieces ---- */

/* Copies n items of `size` bytes, and polls. from and to may be NULL if n is 0. */
void dt_copy(void *to, const void *from, size_t n, size_t size, struct dt_stop *stop);

/* The items a .. b - 1 of a pass that ends before `end`. */
struct dt_piece {
    uint32_t a, b, end;
};

/* A pass that has not begun: its first piece is the next one. */
static inline struct dt_piece dt_pieces(uint32_t begin, uint32_t end)
{
    return (struct dt_piece){begin, begin, end};
}

/* Polls and advances to the next piece, of at most `items` items; false: the pass is over, or stopped. */
static inline bool dt_next_piece_of(struct dt_stop *s, uint32_t items, struct dt_piece *at)
{
    at->a = at->b;
    at->b = at->end - at->a < items ? at->end : at->a + items;
    return at->a < at->end && !dt_stopped(s);
}

static inline bool dt_next_piece(struct dt_stop *s, struct dt_piece *at)
{
    return dt_next_piece_of(s, DT_POLL, at);
}
