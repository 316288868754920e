/* effort.h - what a shelling has cost so far, counted in cheap steps of about a nanosecond. It is given up when it
 * costs too much, and polls after so many steps, not after so many rounds, because one round may be very long. */
#ifndef DT_EFFORT_H
#define DT_EFFORT_H

#include "core/control/stop.h"

/* All zero: no limit, never stopped. */
struct dt_effort {
    struct dt_stop *stop; /* borrows */
    uint64_t limit;       /* of spent, beyond which the reason to stop is DT_TOOBIG */
    uint64_t spent;
    uint64_t next; /* spent, when the next poll is due */
};

/* For dt_effort_spend. */
bool dt_effort_poll(struct dt_effort *e);

/* Adds steps. True: the computation must stop; stays true. */
static inline bool dt_effort_spend(struct dt_effort *e, uint64_t steps)
{
    e->spent += steps;
    return e->spent >= e->next && dt_effort_poll(e);
}

/* Advances to the next piece of a pass, with so many steps for each item; false: the pass is over or must stop. */
static inline bool dt_effort_piece(struct dt_effort *e, unsigned steps, struct dt_piece *at)
{
    return dt_next_piece(NULL, at) && !dt_effort_spend(e, (uint64_t)steps * (at->b - at->a));
}

/* The reason to stop that is known so far. */
static inline enum dt_status dt_effort_status(const struct dt_effort *e)
{
    return e->stop == NULL ? DT_OK : dt_stop_status(e->stop);
}

#endif
