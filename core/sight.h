/* sight.h - what the base l-r of a merge (merge.c) sees of two points at once: a candidate of the
 * left part in one lane, one of the right part in the other.
 *
 * The candidates of one base are compared by the in-circle test of (l, r, c, x), whose determinant
 * in coordinates relative to l and r is
 *
 *     det(c, x) = dt(c) cr(x) - dt(x) cr(c),  cr(c) = (r - l) x (c - l),  dt(c) = (c - l).(c - r)
 *
 * cr(c) is the orientation of l, r, c as well, and cr and dt are computed once per candidate: half
 * the work of testing anew. (cr / dt is the tangent of the angle at which c sees l-r; the test
 * compares these angles.)
 *
 * Filter. Let D be the longer side of the box of both parts and u = 2^-53. All differences of
 * coordinates are at most D with a relative error of u, so each product of two carries an error of
 * at most 3 u D^2 (+ O(u^2)), and with the final rounding
 *
 *     |err cr| <= 2 * 3 u D^2 + 2 u D^2 = 8 u D^2 < 8.9e-16 D^2,    |err dt| the same.
 *
 * With |cr| <= D^2 (twice the area of a triangle in a square) and |dt| <= 2 D^2
 *
 *     |err det| <= 2 (2 * 8 u + 8 u + 2 u) D^4 + 4 u D^4 = 56 u D^4 < 6.3e-15 D^4.
 *
 * The bounds used are 1e-15 D^2 and 1e-14 D^4, which leaves room for the rounding of D itself. What
 * they leave open goes to sight.c. No product under- or overflows for the coordinates that
 * dt_coordinate_ok accepts. */
#ifndef DT_SIGHT_H
#define DT_SIGHT_H

#include <math.h>

#include "core/knit.h"
#include "core/lanes.h"

/* The lanes, and the bits that answers have for them. */
enum { SIGHT_LEFT = 1, SIGHT_RIGHT = 2 };

/* The base, each coordinate in both lanes. */
struct sight_base {
    dt_lanes lx, ly, rx, ry;
};

/* Two points, and cr and dt of either. */
struct sight {
    dt_lanes x, y, cr, dt;
};

/* The same answers where the filters are in doubt; p is all points by vertex. */
int dt_sight_above(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v);
int dt_sight_below(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v);
int dt_sight_better(const struct dt_point *p, uint32_t l, uint32_t r, int sides,
                    const uint32_t c[2], const uint32_t x[2]);
bool dt_sight_left_wins(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v);

INLINE struct sight_base sight_base_of(struct dt_point l, struct dt_point r)
{
    return (struct sight_base){{l.x, l.x}, {l.y, l.y}, {r.x, r.x}, {r.y, r.y}};
}

/* Makes the point seen on the left the left end of the base, or the one on the right the right. */
INLINE void sight_from_left(struct sight_base *at, const struct sight *c)
{
    at->lx = dt_lanes_first(c->x, c->x);
    at->ly = dt_lanes_first(c->y, c->y);
}

INLINE void sight_from_right(struct sight_base *at, const struct sight *c)
{
    at->rx = dt_lanes_second(c->x, c->x);
    at->ry = dt_lanes_second(c->y, c->y);
}

/* Vertices u and v as the base sees them. */
INLINE struct sight sight_of(const struct dt_point *p, const struct sight_base *at, size_t u,
                             size_t v)
{
    dt_lanes pu = dt_lanes_load(&p[u].x), pv = dt_lanes_load(&p[v].x);
    struct sight c = {.x = dt_lanes_first(pu, pv), .y = dt_lanes_second(pu, pv)};
    dt_lanes ux = c.x - at->lx, uy = c.y - at->ly;
    c.cr = (at->rx - at->lx) * uy - (at->ry - at->ly) * ux;
    c.dt = ux * (c.x - at->rx) + uy * (c.y - at->ry);
    return c;
}

INLINE dt_lanes sight_both(double a)
{
    return (dt_lanes){a, a};
}

/* Which of the points in view lie above, strictly on the left of, the line from l to r. */
INLINE int sight_above(const struct knitting *w, uint32_t l, uint32_t r, uint32_t u, uint32_t v,
                       const struct sight *c)
{
    int above = dt_lanes_bits(c->cr > sight_both(w->cr_bound));
    int not_above = dt_lanes_bits(c->cr < sight_both(-w->cr_bound));
    if (__builtin_expect((above | not_above) != (SIGHT_LEFT | SIGHT_RIGHT), 0))
        return dt_sight_above(w->p, l, r, u, v);
    return above;
}

INLINE int sight_below(const struct knitting *w, uint32_t l, uint32_t r, uint32_t u, uint32_t v,
                       const struct sight *c)
{
    int below = dt_lanes_bits(c->cr < sight_both(-w->cr_bound));
    int not_below = dt_lanes_bits(c->cr > sight_both(w->cr_bound));
    if (__builtin_expect((below | not_below) != (SIGHT_LEFT | SIGHT_RIGHT), 0))
        return dt_sight_below(w->p, l, r, u, v);
    return below;
}

/* On which of `sides` the point in view as *in_x, vertex x[side], lies in the circle of l, r and the
 * one in view as *in_c, c[side]. */
INLINE int sight_better(const struct knitting *w, uint32_t l, uint32_t r, int sides,
                        const uint32_t c[2], const uint32_t x[2], const struct sight *in_c,
                        const struct sight *in_x)
{
    dt_lanes det = in_c->dt * in_x->cr - in_x->dt * in_c->cr;
    int better = sides & dt_lanes_bits(det > sight_both(w->det_bound));
    int not_better = sides & dt_lanes_bits(det < sight_both(-w->det_bound));
    if (__builtin_expect((better | not_better) != sides, 0))
        return dt_sight_better(w->p, l, r, sides, c, x);
    return better;
}

/* Whether the next base is u-r rather than l-v: u is above the base, and v is not, or lies outside
 * the circle of l, r and u. */
INLINE bool sight_left_wins(const struct knitting *w, uint32_t l, uint32_t r, int above, uint32_t u,
                            uint32_t v, const struct sight *c)
{
    const int both = SIGHT_LEFT | SIGHT_RIGHT;
    double det = c->dt[0] * c->cr[1] - c->dt[1] * c->cr[0];
    if (__builtin_expect((above == both) & (fabs(det) <= w->det_bound), 0))
        return dt_sight_left_wins(w->p, l, r, u, v);
    return above & SIGHT_LEFT &
           ((det < 0) | (~above >> 1)); /* without a branch: above == LEFT, or det < 0 */
}

#endif
