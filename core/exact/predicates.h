/* predicates.h - the exact signs on which all decisions about topology depend.
 *
 * Every function returns the sign of a polynomial of the coordinates, evaluated exactly: a
 * floating-point filter first, exact arithmetic where the filter cannot decide [Shewchuk 1997].
 * Exact for all coordinates that dt_coordinate_ok accepts. No state, no allocation. The filters are inline; the
 * stages behind them are in predicates.c. */
#pragma once

#ifndef __SIZEOF_INT128__
#error                                                                                             \
    "the core needs a compiler with __int128: on 32-bit machines build it for WebAssembly (make wasm), where clang has it"
#endif

#include "core/delaunay.h"
#include "core/exact/bounds.h"
#include "core/exact/lanes.h"

#include <math.h>

/* The same signs without the filter, and the sign of a tie; for the inline functions below. */
int dt_orient2d_exact(struct dt_point a, struct dt_point b, struct dt_point c);
int dt_incircle_exact(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d);
int dt_incircle_tie(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d);

/* Twice the area of the triangle a b c, rounded. Beyond DT_ORIENT_BOUND of *size it has the right sign. */
static inline double dt_orient2d_rounded(struct dt_point a, struct dt_point b, struct dt_point c,
                                         double *size)
{
    double left = (a.x - c.x) * (b.y - c.y);
    double right = (a.y - c.y) * (b.x - c.x);
    *size = fabs(left) + fabs(right);
    return left - right;
}

/* > 0 if a, b, c turn counterclockwise (c left of a->b), 0 if they are collinear, < 0 if
 * clockwise. */
static inline int dt_orient2d(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double size, det = dt_orient2d_rounded(a, b, c, &size);
    if (fabs(det) > DT_ORIENT_BOUND * size)
        return det > 0 ? 1 : -1;
    return dt_orient2d_exact(a, b, c);
}

/* The determinant of dt_incircle, rounded: dt(c) cr(d) - dt(d) cr(c) of bounds.h for the base a-b, c and d side by
 * side. Beyond DT_CLOSE_DET_BOUND of *size it has the right sign. */
static inline double dt_incircle_rounded(struct dt_point a, struct dt_point b, struct dt_point c,
                                         struct dt_point d, double *size)
{
    dt_lanes x = {c.x, d.x}, y = {c.y, d.y};
    dt_lanes ax = dt_lanes_both(a.x) - x, ay = dt_lanes_both(a.y) - y;
    dt_lanes bx = dt_lanes_both(b.x) - x, by = dt_lanes_both(b.y) - y;
    dt_lanes left = ax * by, right = ay * bx, in_x = ax * bx, in_y = ay * by;
    dt_lanes cr = left - right, cr_size = dt_lanes_abs(left) + dt_lanes_abs(right);
    dt_lanes dt = in_x + in_y, dt_size = dt_lanes_abs(in_x) + dt_lanes_abs(in_y);
    dt_lanes det = dt * dt_lanes_swap(cr), det_size = dt_size * dt_lanes_swap(cr_size);
    *size = det_size[0] + det_size[1];
    return det[0] - det[1];
}

/* a, b, c counterclockwise: > 0 if d lies inside their circumcircle, 0 if on it, < 0 if outside. */
static inline int dt_incircle(struct dt_point a, struct dt_point b, struct dt_point c,
                              struct dt_point d)
{
    double size, det = dt_incircle_rounded(a, b, c, d, &size);
    if (fabs(det) > DT_CLOSE_DET_BOUND * size)
        return det > 0 ? 1 : -1;
    return dt_incircle_exact(a, b, c, d);
}

/* The same with ties broken: never 0 for four distinct points of which a, b, c are counterclockwise.
 * On a tie, the lifted height x^2 + y^2 of each point is raised by an infinitesimal. The infinitesimal is
 * larger, by orders of magnitude, for the lexicographically greater point
 * [Devillers & Teillaud 2003; PROTOCOL.md, section 3]. */
static inline int dt_incircle_perturbed(struct dt_point a, struct dt_point b, struct dt_point c,
                                        struct dt_point d)
{
    int sign = dt_incircle(a, b, c, d);
    return sign != 0 ? sign : dt_incircle_tie(a, b, c, d);
}

/* A point relative to another one, q, and the square of its distance from q: lifted to the paraboloid above q. */
struct dt_lifted {
    double x, y, square;
};

/* Straight above q: with it for c, the determinant below has the sign of a, b and q in dt_orient2d. */
static const struct dt_lifted dt_lifted_infinity = {0, 0, 1};

static inline struct dt_lifted dt_lift(struct dt_point p, struct dt_point q)
{
    double x = p.x - q.x, y = p.y - q.y;
    return (struct dt_lifted){x, y, x * x + y * y};
}

static inline double dt_lifted_cross(struct dt_lifted a, struct dt_lifted b)
{
    return a.x * b.y - a.y * b.x;
}

/* The determinant of a, b, c, of which these are the cross products, rounded: > 0 if q lies inside the circumcircle of a, b,
 * c, counterclockwise. Beyond *bound it has the right sign. For many tests of one q, which share vertices and edges. */
static inline double dt_lifted_det(struct dt_lifted a, struct dt_lifted b, struct dt_lifted c,
                                   double ab, double bc, double ca, double *bound)
{
    double most = a.square > b.square ? a.square : b.square;
    most = c.square > most ? c.square : most;
    *bound = DT_LIFTED_DET_BOUND * (most * most);
    return a.square * bc + b.square * ca + c.square * ab;
}

/* The square of the distance of a and b, rounded (DT_DISTANCE_BOUND); 0 only for equal points. */
static inline double dt_square_distance(struct dt_point a, struct dt_point b)
{
    double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y;
}

/* Whether rounded squares of distances, da and db, compare as the distances do. */
static inline bool dt_squares_decide(double da, double db)
{
    return fabs(da - db) > DT_DISTANCE_BOUND * (da + db);
}

/* The sign of |a - q|^2 - |b - q|^2: < 0 if a is nearer to q than b. Exact, as is the next one. */
int dt_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b);

/* The sign of |a - b|^2 - r^2, r >= 0: <= 0 if a and b are at most r apart. */
int dt_compare_radius(struct dt_point a, struct dt_point b, double r);

/* The sign of (a - o) . (b - o): > 0 if a and b are within a right angle as seen from o, 0 if at one. Exact. */
int dt_dot_exact(struct dt_point o, struct dt_point a, struct dt_point b);

static inline int dt_dot(struct dt_point o, struct dt_point a, struct dt_point b)
{
    double x = (a.x - o.x) * (b.x - o.x), y = (a.y - o.y) * (b.y - o.y), dot = x + y;
    if (fabs(dot) > DT_ORIENT_BOUND * (fabs(x) + fabs(y)))
        return dot > 0 ? 1 : -1;
    return dt_dot_exact(o, a, b);
}

/* The sign of R - r for the circumradius R of a, b, c, which are not on one line, and r >= 0. Exact. */
int dt_compare_circumradius(struct dt_point a, struct dt_point b, struct dt_point c, double r);

/* Whether p and q are opposite corners of the axis-parallel rectangle whose other corners are r and s:
 * then the four lie on one circle. */
static inline bool dt_is_rectangle(struct dt_point p, struct dt_point q, struct dt_point r,
                                   struct dt_point s)
{
    return (p.x == r.x && q.x == s.x && p.y == s.y && q.y == r.y) ||
           (p.x == s.x && q.x == r.x && p.y == r.y && q.y == s.y);
}

/* Lexicographic order, x then y: < 0, 0 or > 0. */
static inline int dt_compare_xy(struct dt_point a, struct dt_point b)
{
    if (a.x != b.x)
        return a.x < b.x ? -1 : 1;
    return a.y < b.y ? -1 : a.y > b.y;
}

/* ---- the stages behind the filters, for tests: 0 where one cannot decide, but for the last ---- */

/* Three points as seen from one of the two closest to each other, p and q; in the order of a, b, c. */
struct dt_near_corner {
    struct dt_point p, q, s;
};

/* Four points, as predicates.c has them. */
struct dt_near_base {
    struct dt_point p, q, s, t;
    struct dt_point nearer; /* p or s, to t */
    int sign;               /* of the determinant beside that of a, b, c, d */
};

struct dt_near_corner dt_near_corner_of(struct dt_point a, struct dt_point b, struct dt_point c);
int dt_orient2d_double2(const struct dt_near_corner *k);
int dt_orient2d_big(const struct dt_near_corner *k);

struct dt_near_base dt_near_base_of(struct dt_point a, struct dt_point b, struct dt_point c,
                                    struct dt_point d);
int dt_incircle_double2(const struct dt_near_base *k);
int dt_incircle_big(const struct dt_near_base *k);
