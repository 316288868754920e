/* disc.h - discs of circumcircles, and half planes beyond hull edges, against boxes. What is reported as apart is apart.
 *
 * The disc of a, b, c, as seen from a: b and c are now differences from a. The centre is at
 *
 *     x = (|b|^2 c.y - |c|^2 b.y) / (2 b x c),   y = (|c|^2 b.x - |b|^2 c.x) / (2 b x c).
 *
 * The error of the rounded x and y. u = 2^-53; the model and the range are those of bounds.h; size = |b.x c.y| + |b.y c.x|, area = b x c,
 * scale = 1 / (2 area), flat = size |scale|, terms = the sum of the magnitudes of the four products of a square and a coordinate.
 *
 * 1. Differences err by u of themselves, squares by 4 u, the area by 4 u of size: a relative error of at most 8 u flat. (The first two
 *    are of first order; the factors in step 4 are larger by an eighth.)
 * 2. Each product errs by 6 u of itself, so the two numerators together by 7 u terms.
 * 3. The quotients err by 7 u terms |scale|, and by (8 u flat + 2 u) of themselves.
 * 4. So the centre is off by at most e = 8 u terms |scale| + (9 u flat + 2.5 u) (|x| + |y|), in any direction.
 * 5. Let r = |(x, y)|, rounded. If e <= 2^-22 r, then flat < 2^28, and the second-order errors, below 2^-20 of e, are
 *    within the factors of step 4. If anything is nan or e is larger, then the disc is not taken from these formulas.
 * 6. a is on the circle, so the radius is at most r + e, and the disc is within r + 2 e of the rounded centre.
 * 7. Infinite r: every test below says that the disc meets the box.
 *
 * Inside a box. l = (a.x - lo.x) + x, rounded, is the distance of the rounded centre from the side lo.x:
 *
 * 8. l errs by u |a.x - lo.x| + u |l| <= 3 u |l| + 2 u r, since |a.x - lo.x| <= |l| + |x| + u |l| and |x| <= r.
 * 9. If l^2 > (1 + 2^-17) r^2 as rounded, then l > (1 + 2^-19) r. So the exact l exceeds (1 + 2^-20) r > r + 2 e.
 *
 * Apart from a box. d is the rounded distance of the centre and the box, of which each coordinate is computed as l in step 8:
 *
 * 10. d errs by 5 u d + 3 u reach, where reach = (r + 2 e) (1 + 2^-46), as |x|, |y| <= reach.
 * 11. If d^2 > reach^2 as rounded, then d > (1 - 4 u) reach, and the exact distance exceeds (1 - 12 u) reach > r + 2 e.
 *
 * Deep inside a box, without a division: the disc is within the diameter 2 R of a, and (2 R)^2 = |b|^2 |c|^2 |c - b|^2 / area^2. d is the
 * distance of a from the nearest side of the box.
 *
 * 12. If size <= 2^20 |area|, then the area errs by 4 u size < 2^-30 of itself; d errs by u of itself. The product of the three squares
 *     errs by 14 u of itself.
 * 13. So if (1 + 2^-20) |b|^2 |c|^2 |c - b|^2 < d^2 area^2 as rounded, then 2 R < d, if nothing overflows or underflows.
 * 14. If the left side overflows, the test is false. If only the right side does, the inequality holds. If the right side exceeds 2^-900,
 *     then the left side, rounded, errs by at most 2^-1000 more by underflow, which the factor covers.
 *
 * Flat triangles. dt_centre rounds each coordinate of the centre once: it errs by at most u (|x| + |y|) <= e / 2 for e = 2^-52 (|x| + |y|).
 * The distance of a from the rounded centre, of which hypot errs by less than 4 u, takes the place of r in steps 6, 10 and 11. */
#pragma once

#include <math.h>

#include "core/cells/centre.h"
#include "core/exact/bounds.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"

struct dt_disc {
    struct dt_point from; /* the centre is at from + (x, y), which is not rounded */
    double x, y;
    double square; /* of (x, y), rounded */
    double slip;   /* e */
};

#define DT_DISC_SLIP 0x1p-44         /* of the square: step 5 */
#define DT_DISC_INSIDE (1 + 0x1p-17) /* step 9 */
#define DT_DISC_REACH (1 + 0x1p-46)  /* step 10 */

/* Whether the disc of a, b, c, counterclockwise, is certainly deep inside the box: most discs of a large tile are. */
static inline bool dt_disc_deep(struct dt_point a, struct dt_point b, struct dt_point c,
                                const struct dt_box *box)
{
    double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    double ex = c.x - b.x, ey = c.y - b.y;
    double left = bx * cy, right = by * cx, area = left - right;
    double squares = (bx * bx + by * by) * (cx * cx + cy * cy) * (ex * ex + ey * ey);
    double l = a.x - box->lo.x, r = box->hi.x - a.x, d = a.y - box->lo.y, u = box->hi.y - a.y;
    double x = l < r ? l : r, y = d < u ? d : u, least = x < y ? x : y;
    double room = (least * least) * (area * area);
    bool round = fabs(left) + fabs(right) <= 0x1p20 * area;
    return least > 0 && round && squares * (1 + 0x1p-20) < room && room > 0x1p-900;
}

/* Whether the disc of a, b, c, counterclockwise, is as steps 1 to 5 require. */
static inline bool dt_disc_of(struct dt_point a, struct dt_point b, struct dt_point c,
                              struct dt_disc *d)
{
    double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    double left = bx * cy, right = by * cx, scale = 0.5 / (left - right);
    double bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    double p = bb * cy, q = cc * by, v = cc * bx, w = bb * cx;
    double steep = fabs(scale), flat = (fabs(left) + fabs(right)) * steep;
    double terms = (fabs(p) + fabs(q)) + (fabs(v) + fabs(w));
    d->from = a;
    d->x = (p - q) * scale;
    d->y = (v - w) * scale;
    d->square = d->x * d->x + d->y * d->y;
    d->slip = 8 * DT_U * terms * steep + (9 * DT_U * flat + 2.5 * DT_U) * (fabs(d->x) + fabs(d->y));
    return d->slip * d->slip <= DT_DISC_SLIP * d->square;
}

/* Whether it is certainly inside the box, after dt_disc_of was true. */
static inline bool dt_disc_inside(const struct dt_disc *d, const struct dt_box *box)
{
    double left = (d->from.x - box->lo.x) + d->x, right = (box->hi.x - d->from.x) - d->x;
    double below = (d->from.y - box->lo.y) + d->y, above = (box->hi.y - d->from.y) - d->y;
    double x = left < right ? left : right, y = below < above ? below : above;
    double least = x < y ? x : y;
    return least > 0 && least * least > DT_DISC_INSIDE * d->square;
}

/* A disc to be compared with many boxes. */
struct dt_reach {
    struct dt_point from;
    double x, y, reach;
};

/* Of *d, if `sure`, which dt_disc_of returned, otherwise of a, b, c. */
static inline struct dt_reach dt_reach_of(const struct dt_disc *d, bool sure, struct dt_point a,
                                          struct dt_point b, struct dt_point c)
{
    if (sure)
        return (struct dt_reach){d->from, d->x, d->y,
                                 (sqrt(d->square) + 2 * d->slip) * DT_DISC_REACH};
    struct dt_point p = dt_centre(a, b, c);
    double slip = 0x1p-52 * (fabs(p.x) + fabs(p.y));
    return (struct dt_reach){p, 0, 0, (hypot(p.x - a.x, p.y - a.y) + 2 * slip) * DT_DISC_REACH};
}

/* How far the interval from lo to hi is from at + x. */
static inline double dt_reach_beside(double at, double x, double lo, double hi)
{
    double below = (lo - at) - x, above = x - (hi - at), most = below > above ? below : above;
    return most > 0 ? most : 0;
}

/* False: the disc and the box have no point in common. */
static inline bool dt_reach_meets(const struct dt_reach *r, const struct dt_box *box)
{
    double x = dt_reach_beside(r->from.x, r->x, box->lo.x, box->hi.x);
    double y = dt_reach_beside(r->from.y, r->y, box->lo.y, box->hi.y);
    return !(x * x + y * y > r->reach * r->reach);
}

/* The outside of the hull edge a-b, left of it; and the box of that edge. */
struct dt_beyond {
    struct dt_point a, b;
    struct dt_box edge;
};

/* False: no point of the box is strictly left of a-b, nor on the edge. The corner of the box that is farthest to the left decides.
 * Exact, but for boxes near an edge. */
static inline bool dt_beyond_meets(const struct dt_beyond *e, const struct dt_box *box)
{
    struct dt_point far = {e->b.y < e->a.y ? box->hi.x : box->lo.x,
                           e->b.x > e->a.x ? box->hi.y : box->lo.y};
    return dt_box_overlaps(&e->edge, box) || dt_orient2d(e->a, e->b, far) > 0;
}
