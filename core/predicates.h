/* predicates.h - the exact signs that all topology branches on.
 *
 * Every function returns the sign of a polynomial of the coordinates, evaluated exactly: a floating-point filter first,
 * exact arithmetic where the filter cannot decide [Shewchuk 1997]. Exact for all coordinates that dt_coordinate_ok
 * accepts. No state, no allocation. */
#ifndef DT_PREDICATES_H
#define DT_PREDICATES_H

#include "core/delaunay.h"

/* > 0 if a, b, c turn counterclockwise (c left of a->b), 0 if they are collinear, < 0 if clockwise. */
int dt_orient2d(struct dt_point a, struct dt_point b, struct dt_point c);

/* a, b, c counterclockwise: > 0 if d lies inside their circumcircle, 0 if on it, < 0 if outside. */
int dt_incircle(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d);

/* The same with ties broken: never 0 for four distinct points of which a, b, c are counterclockwise. On a tie, the
 * lifted height x^2 + y^2 of each point is raised by an infinitesimal that is larger, by orders of magnitude, for
 * the lexicographically greater point [Devillers & Teillaud 2003; PROTOCOL.md, section 3]. */
int dt_incircle_perturbed(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d);

/* The sign of |a - q|^2 - |b - q|^2: < 0 if a is nearer to q than b. */
int dt_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b);

/* The sign of |a - b|^2 - r^2, r >= 0: <= 0 if a and b are at most r apart. */
int dt_compare_radius(struct dt_point a, struct dt_point b, double r);

/* Lexicographic order, x then y: < 0, 0 or > 0. */
static inline int dt_compare_xy(struct dt_point a, struct dt_point b)
{
    if (a.x != b.x)
        return a.x < b.x ? -1 : 1;
    return a.y < b.y ? -1 : a.y > b.y;
}

#endif
