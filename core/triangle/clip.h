/* clip.h - what is between a triangle and another one below it, in a box. */
#pragma once

#include "core/delaunay.h"

struct dt_slab {
    struct dt_point p[3]; /* counterclockwise, not on one line */
    double top[3], base[3];
};

/* value 2^exponent, at least 0. */
struct dt_scaled {
    double value;
    int exponent;
};

struct dt_slab_parts {
    struct dt_scaled above,
        below;             /* six times the volumes where the top is above the base, and below */
    struct dt_scaled area; /* twice the area */
};

/* Of the part in the closed box lo to hi. Both volumes err by less than 2^-48 of their sum, and the area by as much of itself.
 * They depend on the slab and the box alone. Cost: constant; some hundred times as much where they are very small beside those of
 * the whole slab. */
struct dt_slab_parts dt_slab_clip(const struct dt_slab *s, struct dt_point lo, struct dt_point hi);
