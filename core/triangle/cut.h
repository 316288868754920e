/* cut.h - where a straight way cuts an edge, in numbers. */
#pragma once

#include "core/delaunay.h"
#include "core/exact/double2.h"

struct dt_cut {
    struct dt_point at;       /* each coordinate rounded once, as by dt_crossing_place */
    struct dt_double2 along;  /* the share of the way that lies before it, */
    struct dt_double2 across; /* and the share of the edge; relative errors below 2^-70 */
};

/* Of the way from p to q, which crosses the edge from a, on its right, to b, on its left; all four strictly. Cost: constant;
 * some hundred times more for crossings at very small angles or near the middle of two doubles. */
struct dt_cut dt_cut_of(struct dt_point p, struct dt_point q, struct dt_point a, struct dt_point b);
