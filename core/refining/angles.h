/* angles.h - the least and the largest angle of triangles.
 *
 *             r                An angle is compared by its cotangent, which falls from infinity to minus infinity between 0 and
 *            / \               180 degrees. With u = p - r and v = q - r:
 *           /   \
 *          p --- q                 cotangent = dot / cross,   dot = u . v,   cross = u x v > 0
 *
 * A cotangent is a double word: it errs by less than 2^-88 of the cotangent and of 1. */
#pragma once

#include "core/exact/double2.h"
#include "core/refining/quality.h"

/* Start with {0}. */
struct dt_angles {
    struct dt_double2 least, largest; /* cotangents, if there is any */
    bool any;
};

/* The three angles of a triangle more. The result depends on the triangles alone, not on their order or their corners' order. */
void dt_angles_add(struct dt_angles *a, const struct dt_shape *s);

/* The angle with this cotangent in degrees, from 0 to 180. It has equal bytes everywhere, since it takes sums, products, quotients and
 * square roots alone. The nearest double, unless the angle is within 2^-86 of the middle of two. */
double dt_degrees(struct dt_double2 cotangent);
