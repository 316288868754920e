/* exactly.h - how far a point is off the surface between some corners: exactly, and as the core rounds it. */
#pragma once

#include "core/delaunay.h"

struct corner {
    struct dt_point at;
    double z;
};

/* The sign of |weighted mean of the values at 2 or 3 corners - z| - bound for a place q between them. Exact. */
int exact_side(const struct corner *k, int corners, struct dt_point q, double z, double bound);

/* The double nearest to the distance. */
double nearest_off(const struct corner *k, int corners, struct dt_point q, double z);

/* The distance as doubles have it, from the least corner on; in thin triangles the nearest double. */
double rounded_off(const struct corner *k, int corners, struct dt_point q, double z);
