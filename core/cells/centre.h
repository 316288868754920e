/* centre.h - places of the Voronoi diagram, each coordinate rounded once: the double nearest to the exact value, of
 * two equally near ones that with an even significand.
 *
 * So a place does not depend on the points that it is computed from. All triangles of a cocircular polygon have the same
 * circumcentre, bit by bit, and neighbouring cells have the same corners. Rounding is monotone: a place left of, below
 * or on a line along an axis at a double is not on the line's other side after rounding.
 *
 * Exact for all coordinates that dt_coordinate_ok accepts, and sides of boxes up to 2^203: a coordinate of a
 * circumcentre is 0 or between 2^-990 and 2^1015. Zero is positive. */
#pragma once

#include "core/delaunay.h"

/* The circumcentre of three points that are not on one line. Cost: constant; hundreds of times higher if double words
 * do not decide. */
struct dt_point dt_centre(struct dt_point a, struct dt_point b, struct dt_point c);

/* The circumcentres of two triangles, in half of the time: the vectors of a machine have room for both. */
void dt_centre_two(const struct dt_point p[3], const struct dt_point q[3], struct dt_point *of_p,
                   struct dt_point *of_q);

/* dt_bisector_y: the y at which the line x = at meets the perpendicular bisector of p and q, whose y differ.
 * dt_bisector_x: the x at which the line y = at meets it, if their x differ. */
double dt_bisector_y(struct dt_point p, struct dt_point q, double at);
double dt_bisector_x(struct dt_point p, struct dt_point q, double at);
