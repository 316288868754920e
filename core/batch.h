/* batch.h - many points on their way into a live set, in an order and with a lead that keep memory
 * busy.
 *
 * An insertion waits for memory most of its time: for a cell of the grid, the triangle that is in
 * it, its corners, and so on. So every point of a batch goes through stages, some points before its
 * own insertion each, which do what they can with what the stage before has fetched:
 *
 *     13 before   the point itself is fetched
 *     10 before   the cell of the grid
 *      7 before   the triangle that the cell names, and the vertices around it
 *      4 before   the point is located, and the neighbours of its triangle are fetched
 *      2 before   what lies around those
 *
 * and is then inserted from the triangle that it was found in or one nearby. */
#ifndef DT_BATCH_H
#define DT_BATCH_H

#include "core/set.h"
#include "core/stop.h"

enum { DT_BATCH_RING = 16 };

struct dt_batch {
    const struct dt_point *q; /* borrows until dt_batch_end */
    uint32_t *order;          /* owns: which point comes when; NULL: as they are */
    uint32_t n;
    uint32_t near[DT_BATCH_RING]; /* by turn: a half edge near the point, DT_NONE: not known */
    uint32_t vertex, record;      /* what is free and will be used some points later */
};

/* Chooses the order for n points to be added to t: by the cells of a grid, but points at the same
 * place as they come, so that the smallest id represents them; with a tolerance the order of
 * arrival matters, so nothing is sorted. DT_NOMEM, DT_CANCELLED: nothing to undo. */
enum dt_status dt_batch_begin(struct dt_batch *b, const struct dt *t, const struct dt_point *q,
                              uint32_t n, struct dt_stop *stop);
void dt_batch_end(struct dt_batch *b);

/* Which point has turn i. */
static inline uint32_t dt_batch_index(const struct dt_batch *b, uint32_t i)
{
    return b->order == NULL ? i : b->order[i];
}

/* To be called for every turn, 0, 1, ..., before its point is inserted; nothing but these points
 * may be inserted, and nothing deleted, in between. Returns a half edge near the point, DT_NONE if
 * none is known. */
uint32_t dt_batch_turn(struct dt *t, struct dt_batch *b, uint32_t i);

#endif
