/* circles.h - circumcircles of triangles as seen from one place after the other, kept from place to place.
 *
 * A circle follows from its triangle alone, so it makes no difference which circles are kept. Its centre is computed from a
 * corner with the sides s and t from there, counterclockwise, and e = t - s:
 *
 *     c = s + (t.e / D) s', where s' is s turned left and D = s x e,                doubled and relative to the corner.
 *
 * Errors, in units of DT_U. Each coordinate of s, t and e is off by one unit of itself, so D by 4 |s| |e|, t.e by 4 |t| |e|
 * and their quotient, with the product by a reciprocal, by (4 |t| |e| + 4 |t.e / D| |s| |e|) / |D| + 2 |t.e / D|. Since
 * |s| |t| |e| / |D| = |c|, |t.e / D| |s| <= |c| and |s| <= |c|, that moves c by |c| (6 + 4 F), where F = |s| |e| / |D| =
 * |c| / |t|, and the rest of the formula by 4 |c|. The factors below are a little larger: they make up for what is of second
 * order, and for the rounding of the bounds. F is small where t is long, so t is the longest side of the triangle. |x| + |y|,
 * which is not less, replaces the length of a vector. */
#ifndef DT_CIRCLES_H
#define DT_CIRCLES_H

#include "core/exact/predicates.h"
#include "core/set/set.h"

/* How far a computed centre may be from where it is, over its length, for F as above. */
#define DT_CENTRE_ERROR(f) (DT_U * (10.2 + 4.1 * (f)))

struct dt_circle {
    uint32_t triangle;      /* its first half edge; DT_NONE: nothing is kept here */
    struct dt_point corner; /* a corner */
    struct dt_point centre; /* doubled, relative to the corner */
    double inside,
        outside;  /* the square of a distance below, above which a place is certainly there */
    double error; /* of the centre from a place, but for 2.2 units of its length there */
};

struct dt_circles {
    struct dt_circle *circle; /* owns mask + 1; a triangle has one place among them */
    uint32_t mask;
};

/* For `n` circles, a power of two. DT_NOMEM. */
enum dt_status dt_circles_init(struct dt_circles *c, uint32_t n);
void dt_circles_clear(struct dt_circles *c);

/* A ghost has a circle without inside. */
void dt_circle_make(struct dt_circle *k, const struct dt *t, uint32_t triangle);

/* The doubled centre relative to q. */
static inline struct dt_point dt_circle_from(const struct dt_circle *k, struct dt_point q)
{
    return (struct dt_point){k->centre.x + 2 * (k->corner.x - q.x),
                             k->centre.y + 2 * (k->corner.y - q.y)};
}

/* Whether q is strictly inside the circle of a triangle, whose centre relative to q is c. Exact. */
static inline bool dt_circle_contains(const struct dt_circle *k, const struct dt *t,
                                      struct dt_point q, struct dt_point c)
{
    double square = c.x * c.x + c.y * c.y;
    if (square < k->inside)
        return true;
    if (square > k->outside)
        return false;
    const uint32_t *v = t->mesh.half + k->triangle;
    return dt_incircle(t->points.xy[v[0]], t->points.xy[v[1]], t->points.xy[v[2]], q) > 0;
}

#endif
