/* hull_walk.h - the hull now or at the moment of a view, from point to point.
 *
 * The position of a walk is a point, given by its id, so that the walk can be resumed at that point after edits. On a
 * line, which has two directions, the previous point is needed as well. */
#pragma once

#include "core/set/view_stars.h"

struct dt_hull_walk {
    const struct dt *t;
    const struct dt_view *v; /* NULL: now */
    bool line, back;
    uint32_t before;     /* the point before; DT_NONE at the end of a line */
    uint32_t id;         /* the point */
    struct dt_star star; /* its star */
    uint32_t ghost;      /* its ghost; DT_NONE: the walk goes on by the star */
};

/* Returns the id at which the hull begins in canonical order, cw or not: as dt_hull_first. DT_NONE if there is no point.
 * v may be NULL: now. Cost: O(hull). */
uint32_t dt_hull_start(const struct dt *t, const struct dt_view *v, bool cw);

/* A walk, clockwise or not (on a line away from `before`), at the point of this id. */
struct dt_hull_walk dt_hull_walk_at(const struct dt *t, const struct dt_view *v, bool cw,
                                    uint32_t id, uint32_t before);

void dt_hull_walk_step(struct dt_hull_walk *w);

/* On a line: the ring of the point, the next one before the last one, into ring[2]; then a step. Returns its length. */
uint32_t dt_hull_walk_ring(struct dt_hull_walk *w, uint32_t *ring);
