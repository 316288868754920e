/* plane.h - how far points are off the plane of a triangle: rounded, and exactly where rounding could hide which side of
 * the bound they are on.
 *
 *     z(q) = z + dx (q.x - x) + dy (q.y - y)        (x, y), z: the corner whose place is the least
 *
 * Let f be m^2 / D, m the longer side from that corner, D twice the area, and Z the largest difference of values from the
 * corner's; u = 2^-53.
 *
 * 1. D errs by 4 u m^2, which is 4 f u of itself; a numerator of a slope by 4 u 2 m Z.
 * 2. The sides of q are at most m. The products of slopes and sides err by 16 f u Z from the numerators, and by 4 f u Z from D.
 *    Quotients, sides and products add 4 u of each product, which is at most 2 f Z. The sum adds 4 f u Z. All this is
 *    below 48 f u Z.
 * 3. z(q), its sum and the difference to a value err by 4 u of the largest value, and by u of the result.
 *
 * `doubt` exceeds the sum: 64 f u Z + 16 u times the largest value. */
#pragma once

#include "core/thinning/samples.h"

#include <math.h>

struct dt_plane {
    struct dt_point at;
    double z, dx, dy; /* z: infinite if a corner has no value */
    double doubt;     /* the largest error of dt_plane_off */
    bool level;       /* all corners have the value z */
};

/* A vertex of the surface. */
struct dt_corner {
    struct dt_point at;
    double z; /* nan: it has no value */
};

/* The corners of a triangle, counterclockwise from the least place; or the two ends of an edge of points on one line,
 * ascending. */
struct dt_corners {
    struct dt_corner first, second, third;
    bool on_line; /* there is no third one */
};

/* largest: the largest magnitude of any value. */
struct dt_plane dt_plane_of(const struct dt_corners *c, double largest);

/* Whether q, with a value, is off by more than the bound: exactly, for corners that have values. */
bool dt_plane_exceeds(const struct dt_corners *c, const struct dt_sample *q, double bound);

/* How far q is off: the nearest double, for corners that have values. */
double dt_plane_nearest_off(const struct dt_corners *c, const struct dt_sample *q);

/* Bounds of how far q is off, rounded to the nearest double, for corners that have values. They differ by at most 2^-44 of the largest
 * value at the corners and at q. In triangles whose area is below 2^-60 of the square of a side they may differ by more. Cost: some
 * 100 operations. */
struct dt_off_range {
    double least, most;
};

struct dt_off_range dt_plane_off_range(const struct dt_corners *c, const struct dt_sample *q);

/* How far q is off, rounded. */
static inline double dt_plane_off(const struct dt_plane *p, const struct dt_sample *q)
{
    return fabs(p->z + (p->dx * (q->at.x - p->at.x) + p->dy * (q->at.y - p->at.y)) - q->z);
}

/* Whether that does not decide if q is off by more than the bound. */
static inline bool dt_plane_doubts(const struct dt_plane *p, double off, double bound)
{
    return !(fabs(off - bound) > p->doubt) && !(p->level && off == 0);
}
