/* sight.h - predicates of a merge (merge.c) on its base l-r and two points at once. One lane has a candidate of the left
 * part, the other lane a candidate of the right part.
 *
 * The candidates of one base are compared by the in-circle test of (l, r, c, x), whose determinant
 * in coordinates relative to l and r is
 *
 *     det(c, x) = dt(c) cr(x) - dt(x) cr(c),  cr(c) = (r - l) x (c - l),  dt(c) = (c - l).(c - r)
 *
 * cr(c) is the orientation of l, r, c as well, and cr and dt are computed once per candidate: half
 * the work of a new test. (cr / dt is the tangent of the angle at which c sees l-r; the test
 * compares these angles.)
 *
 * Filters (bounds.h). The wide one knows only the longer side of the box of both parts. On circles and thin
 * strips, and at the last merges of many points, that bound is far too large for the four at hand. The close
 * one looks at them: at the sums CR and DT of the magnitudes of the products in cr and dt.
 *
 * A merge uses one of the two, and calls sight.c where that one cannot decide. It reports how often the close
 * one would have avoided that call, so that the next merge, of a part with a larger box, chooses better. */
#pragma once

#include <math.h>

#include "core/divide/part.h"
#include "core/exact/lanes.h"

/* The lanes, and the bits that answers have for them; SIGHT_SETTLED comes with answers of sight.c that
 * the close filter has given. */
enum { SIGHT_LEFT = 1, SIGHT_RIGHT = 2, SIGHT_BOTH = 3, SIGHT_SETTLED = 4 };

/* The state of a merge's filters. */
struct sight_filter {
    bool close;       /* known when compiled */
    uint32_t settled; /* how often sight.c was asked what the close filter knows */
};

/* The base, each coordinate in both lanes. */
struct sight_base {
    dt_lanes lx, ly, rx, ry;
};

/* Two points, cr and dt of either, and for the close filter CR and DT. */
struct sight {
    dt_lanes x, y, cr, dt, cr_size, dt_size;
};

/* The same answers where the filters are in doubt; p is all points by vertex. The last one's is
 * SIGHT_LEFT for yes. */
int dt_sight_side(const struct dt_point *p, bool above, uint32_t l, uint32_t r, uint32_t u,
                  uint32_t v);
int dt_sight_better(const struct dt_point *p, uint32_t l, uint32_t r, int sides,
                    const uint32_t c[2], const uint32_t x[2]);
int dt_sight_left_wins(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v);

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
    dt_lanes left = (at->rx - at->lx) * uy, right = (at->ry - at->ly) * ux;
    dt_lanes in_x = ux * (c.x - at->rx), in_y = uy * (c.y - at->ry);
    c.cr = left - right;
    c.dt = in_x + in_y;
    c.cr_size = dt_lanes_abs(left) + dt_lanes_abs(right);
    c.dt_size = dt_lanes_abs(in_x) + dt_lanes_abs(in_y);
    return c;
}

/* Returns the lanes whose point lies strictly above the line from l to r, that is, to its left; or strictly below. */
INLINE int sight_side(const struct dt_merging *w, bool above, uint32_t l, uint32_t r, uint32_t u,
                      uint32_t v, const struct sight *c)
{
    int doubt = dt_lanes_bits(dt_lanes_abs(c->cr) <= dt_lanes_both(w->bound.cr));
    if (__builtin_expect(doubt != 0, 0))
        return dt_sight_side(w->p, above, l, r, u, v);
    int below = dt_lanes_bits((dt_lanes_holds)c->cr); /* the signs */
    return above ? SIGHT_BOTH ^ below : below;
}

/* The close filter's bound of det(c, x). */
INLINE dt_lanes sight_close(const struct sight *c, const struct sight *x)
{
    return dt_lanes_both(DT_CLOSE_DET_BOUND) * (c->dt_size * x->cr_size + x->dt_size * c->cr_size);
}

/* The close filter's bound of det(u, v) for the two points that *c has in view. */
INLINE double sight_close_of_pair(const struct sight *c)
{
    return DT_CLOSE_DET_BOUND * (c->dt_size[0] * c->cr_size[1] + c->dt_size[1] * c->cr_size[0]);
}

/* Takes an answer of sight.c, and counts it if the close filter has settled it. */
INLINE int sight_learn(struct sight_filter *f, int answer)
{
    f->settled += (answer & SIGHT_SETTLED) != 0;
    return answer & SIGHT_BOTH;
}

/* On which of `sides` the point in view as *in_x, vertex x[side], lies in the circle of l, r and the
 * one in view as *in_c, c[side]. */
INLINE int sight_better(const struct dt_merging *w, struct sight_filter *f, uint32_t l, uint32_t r,
                        int sides, const uint32_t c[2], const uint32_t x[2],
                        const struct sight *in_c, const struct sight *in_x)
{
    dt_lanes det = in_c->dt * in_x->cr - in_x->dt * in_c->cr;
    dt_lanes bound = f->close ? sight_close(in_c, in_x) : dt_lanes_both(w->bound.det);
    int doubt = dt_lanes_bits(dt_lanes_abs(det) <= bound);
    if (__builtin_expect((doubt & sides) != 0, 0))
        return sight_learn(f, dt_sight_better(w->p, l, r, sides, c, x));
    return sides & ~dt_lanes_bits((dt_lanes_holds)det);
}

/* Whether the next base is u-r rather than l-v: u is above the base, and v is not, or lies outside
 * the circle of l, r and u. */
INLINE bool sight_left_wins(const struct dt_merging *w, struct sight_filter *f, uint32_t l,
                            uint32_t r, int above, uint32_t u, uint32_t v, const struct sight *c)
{
    double det = c->dt[0] * c->cr[1] - c->dt[1] * c->cr[0];
    double bound = f->close ? sight_close_of_pair(c) : w->bound.det;
    if (__builtin_expect((above == SIGHT_BOTH) & (fabs(det) <= bound), 0))
        return sight_learn(f, dt_sight_left_wins(w->p, l, r, u, v));
    return above & SIGHT_LEFT &
           ((det < 0) | (~above >> 1)); /* without a branch: above == LEFT, or det < 0 */
}
