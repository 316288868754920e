/* stop.h - what ends a long computation early: the caller's cancel flag, or a failure in one
 * of its threads. All threads of the computation share one and poll it at regular intervals; unfinished results are
 * discarded. */
#ifndef DT_STOP_H
#define DT_STOP_H

#include "core/delaunay.h"

/* How many steps are done between two polls: cheap steps, such as points of a pass; steps that wait for memory;
 * and steps each of which may be the first to touch a huge page, which the system then clears. */
#define DT_POLL (1u << 16)
#define DT_POLL_MISSES (1u << 12)
#define DT_POLL_FAULTS 128u

struct dt_stop {
    const atomic_bool *cancel; /* borrowed; NULL: never cancelled */
    atomic_int status; /* enum dt_status: the first reason to stop, DT_OK while there is none */
};

/* For a computation with these options, which may be NULL. */
static inline struct dt_stop dt_stop_of(const struct dt_options *opt)
{
    return (struct dt_stop){.cancel = opt == NULL ? NULL : opt->cancel};
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

/* Polls and advances to the next piece, of so many items; false: the pass is over, or stopped. */
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

#endif
