/* batch.h - the addition of many points: their order, and searches side by side, which overlap their cache misses.
 *
 * An insertion spends most of its time waiting for memory: for a cell of the grid, the triangle that is in it,
 * its corners, and so on. So the points of a batch are put in the order of the plane, and the next DT_AHEAD
 * points are searched side by side, as the questions of a pipeline are (core/query/prefetch.h). Then each point is
 * inserted, starting at the triangle in which it was found or at one nearby. Without a triangulation, points are
 * looked up in the table of places (core/points/places.h), in the order of arrival. */
#pragma once

#include "core/control/stop.h"
#include "core/set/set.h"

struct dt_batch {
    const struct dt_point *q; /* borrows until dt_batch_end */
    uint32_t *order;          /* owns: which point comes when; NULL: as they are */
    uint32_t n;
    uint32_t near[DT_AHEAD]; /* by turn: a half edge near the point, DT_NONE: not known */
};

/* Chooses the order for n points to be added to t. They are sorted by the cells of a grid. Points at the same place
 * keep their order, so that the smallest id represents them. With a tolerance the order of arrival matters, so
 * nothing is sorted. DT_NOMEM, DT_CANCELLED: nothing to undo. */
enum dt_status dt_batch_begin(struct dt_batch *b, const struct dt *t, const struct dt_point *q,
                              uint32_t n, struct dt_stop *stop);
void dt_batch_end(struct dt_batch *b);

/* Returns the index of the point that has turn i. */
static inline uint32_t dt_batch_index(const struct dt_batch *b, uint32_t i)
{
    return b->order == NULL ? i : b->order[i];
}

/* Call it for every turn, 0, 1, ..., before its point is inserted; nothing but these points
 * may be inserted, and nothing deleted, in between. Returns a half edge near the point, DT_NONE if
 * none is known. */
uint32_t dt_batch_turn(struct dt *t, struct dt_batch *b, uint32_t i);
