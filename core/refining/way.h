/* way.h - the straight way from a triangle to a place, as far as no fixed edge crosses it.
 *
 * The place is the centre of a circle or an off-centre (refiner.h), which is seen from the corner with the largest angle through
 * the opposite edge, or lies in the triangle. */
#pragma once

#include "core/mesh/mesh.h"

struct dt_way_end {
    enum dt_where where; /* DT_OUTSIDE: the way does not lead there */
    /* as of dt_walk; else the fixed edge that the way would cross, DT_NONE if that is unknown */
    uint32_t half;
};

/* Where the way from the triangle with base half edge h to q ends. It leaves the hull only through fixed edges. DT_OUTSIDE with
 * DT_NONE: q is beyond two edges of the triangle, as rounding may have it where the triangle is thin. Exact. Cost: the triangles on
 * the way. */
struct dt_way_end dt_way(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                         struct dt_point q);
