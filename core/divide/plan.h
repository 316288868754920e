/* plan.h - what remains to be done with points that divide.h has sorted: the blocks and merges of a build,
 * recorded in the order in which they are done.
 *
 *     vertex    0 1 2 | 3 4 | 5 6 7 8 | 9 ...       a block begins at 0, 3, 5, 9 ...
 *     step[]    3         2   4         1
 *               0 merges  1   0         2           after the block at 3, it is merged with the one at 0; after the
 *                                                   block at 9, it with the one at 5, and then all with what is before
 *
 * A merge cuts between the last vertex of one part and the first of the next, so there is one for each block but the
 * first, which remembers the axis. Between the beginnings of blocks, the record is 0. */
#ifndef DT_PLAN_H
#define DT_PLAN_H

#include "core/delaunay.h"

/* In the name of a point: there is another one at its place, with a smaller name. */
#define DT_COINCIDENT (1u << 31)

/* step[]: by place in the order; where a block begins, its points, the axis of the cut before it << 3, and
 * the merges after it << 4. same[]: by name, of points that get DT_COINCIDENT, the smallest
 * name at their place. */
struct dt_plan {
    uint16_t *step;
    uint32_t *same;
};

#define DT_STEP_POINTS(step) ((step)&7u)
#define DT_STEP_AXIS(step) ((step) >> 3 & 1u)
#define DT_STEP_MERGES(step) ((uint32_t)(step) >> 4)

/* Neighbouring blocks that will be joined to one part: the number of their places, where the first one begins, and the
 * last one. */
struct dt_blocks {
    uint32_t n, first, last;
};

/* At most DT_FEW points become one block, or two. Here as in dt_plan_place, the names in from[] of points that coincide
 * with others get DT_COINCIDENT, and -0 becomes 0. */
struct dt_blocks dt_plan_few(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                             uint32_t lo, uint32_t n);

/* n > 0 points at one place become a block of one. */
struct dt_blocks dt_plan_place(const struct dt_plan *w, struct dt_point *p, uint32_t *from,
                               uint32_t lo, uint32_t n);

/* They will be joined. */
struct dt_blocks dt_plan_join(const struct dt_plan *w, struct dt_blocks a, struct dt_blocks b,
                              unsigned axis);

#endif
