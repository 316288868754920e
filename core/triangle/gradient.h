/* gradient.h - the slopes of the plane through three points with values. */
#pragma once

#include "core/delaunay.h"

struct dt_gradient {
    double dx, dy; /* how much the value grows for a unit of x, and of y */
};

/* Of a counterclockwise triangle that is not flat, and finite values: either slope is the nearest double, ties to even; infinite
 * from halfway between the largest double and 2^1024 on. Cost: constant; some hundred times as much for very thin triangles. */
struct dt_gradient dt_gradient_of(const struct dt_point p[3], const double z[3]);
