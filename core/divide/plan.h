/* plan.h - the remaining work on points that divide.h has sorted: the blocks and merges of a build,
 * recorded in the order in which they are done.
 *
 *     vertex    0 1 2 | 3 4 | 5 6 7 8 | 9 ...       a block begins at 0, 3, 5, 9 ...
 *     points    3       2     4         1
 *     merges        0     1         0   2           after the block 3 4, it is merged with the one at 0; after the
 *                                                   block at 9, it with the one at 5, and then all with what is before
 *
 * A merge cuts between the last vertex of one part and the first of the next, so there is one for each block but the
 * first, which remembers the axis. So a cut can be recorded before the blocks and cuts on its two sides. */
#pragma once

#include "core/delaunay.h"

/* In the name of a point: there is another one at its place, with a smaller name. */
#define DT_COINCIDENT (1u << 31)

/* step[]: by place in the order, 0 at first. At the first point of a block: the number of its points, and the axis of the
 * cut before it << 3. At the last point of a block: the number of merges after it << 4. same[]: by name, for each point
 * that gets DT_COINCIDENT, the smallest name at its place. */
struct dt_plan {
    uint16_t *step;
    uint32_t *same;
};

#define DT_STEP_POINTS(step) ((step)&7u)
#define DT_STEP_AXIS(step) ((step) >> 3 & 1u)
#define DT_STEP_MERGES(step) ((uint32_t)(step) >> 4)

/* The points lo .. mid - 1 will be joined with the points mid .. hi - 1, unless there are none on one side. */
static inline void dt_plan_cut(const struct dt_plan *w, uint32_t lo, uint32_t mid, uint32_t hi,
                               unsigned axis)
{
    if (lo == mid || mid == hi)
        return;
    w->step[mid] = (uint16_t)(w->step[mid] | axis << 3);
    w->step[hi - 1] = (uint16_t)(w->step[hi - 1] + (1u << 4));
}

/* Moves the steps of the point at `from` to the place `to`, after points before it were left out. If it is left out itself,
 * the next point moves to `to`: a block then begins with that point, or ends with the point before `to`. */
static inline void dt_plan_move(uint16_t *step, uint32_t from, uint32_t to, bool left_out)
{
    uint32_t s = step[from];
    step[from] = 0;
    step[to] = (uint16_t)(step[to] | (s & 15u));
    if (s > 15)
        step[to - left_out] = (uint16_t)(step[to - left_out] | (s & ~15u));
}

/* At most DT_FEW points become one block, or two. Here as in dt_plan_place, the names in from[] of points that coincide
 * with others get DT_COINCIDENT, and -0 becomes 0. */
void dt_plan_few(const struct dt_plan *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                 uint32_t n);

/* n > 0 points at one place become a block of one. */
void dt_plan_place(const struct dt_plan *w, struct dt_point *p, uint32_t *from, uint32_t lo,
                   uint32_t n);
