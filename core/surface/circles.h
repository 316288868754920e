/* circles.h - circumcircles of triangles as seen from one place after the other, kept from place to place.
 *
 * A circle follows from its triangle alone: its centre is computed from the least corner (dt_compare_xy), and from
 * the two others counterclockwise. So it makes no difference which circles are kept.
 *
 * Errors are those of weights_formula.h, with |x| + |y|, which is not less, for the length of a vector, and one unit
 * more for a quotient that is a product with a reciprocal. */
#ifndef DT_CIRCLES_H
#define DT_CIRCLES_H

#include "core/exact/predicates.h"
#include "core/set/set.h"

/* A doubled circumcentre relative to a place: which changes no ratio of areas. */
struct dt_centre {
    double x, y;
    double length; /* |x| + |y| */
    double error;  /* at least the distance from where it is */
};

struct dt_circle {
    uint32_t triangle;       /* its first half edge; DT_NONE: nothing is kept here */
    struct dt_point corner;  /* the least one */
    struct dt_centre centre; /* relative to it */
};

struct dt_circles {
    struct dt_circle *circle; /* owns mask + 1; a triangle has one place among them */
    uint32_t mask;
};

/* For `n` circles, a power of two. DT_NOMEM. */
enum dt_status dt_circles_init(struct dt_circles *c, uint32_t n);
void dt_circles_clear(struct dt_circles *c);

void dt_circle_make(struct dt_circle *k, const struct dt *t, uint32_t triangle);

/* Of the triangle with these sides from the place. aa = |a|^2, bb = |b|^2 as they are rounded. */
static inline struct dt_centre dt_centre_at(struct dt_point a, struct dt_point b, double aa,
                                            double bb)
{
    double area = a.x * b.y - a.y * b.x, inverse = 1 / area;
    double la = fabs(a.x) + fabs(a.y), lb = fabs(b.x) + fabs(b.y);
    struct dt_centre c = {(aa * b.y - bb * a.y) * inverse, (bb * a.x - aa * b.x) * inverse, 0, 0};
    c.length = fabs(c.x) + fabs(c.y);
    double flat = la * lb * fabs(inverse);
    c.error = DT_U * (flat * (7.5 * (la + lb) + 4.5 * c.length) + 3 * c.length);
    if (!(flat * DT_U < 0x1p-10))
        c.error = HUGE_VAL;
    return c;
}

/* That of the triangle whose first half edge is `triangle`. */
static inline const struct dt_circle *dt_circle_of(struct dt_circles *c, const struct dt *t,
                                                   uint32_t triangle)
{
    struct dt_circle *k = &c->circle[triangle >> 3 & c->mask];
    if (k->triangle != triangle)
        dt_circle_make(k, t, triangle);
    return k;
}

static inline struct dt_centre dt_centre_from(const struct dt_circle *k, struct dt_point q)
{
    struct dt_centre c = {k->centre.x + 2 * (k->corner.x - q.x),
                          k->centre.y + 2 * (k->corner.y - q.y), 0, 0};
    c.length = fabs(c.x) + fabs(c.y);
    c.error = k->centre.error + DT_U * (4 * k->centre.length + 6 * c.length);
    return c;
}

/* What the square of its distance from the origin may be wrong by. The errors above contain more than the rounding of
 * the square. */
static inline double dt_centre_square_error(const struct dt_centre *c)
{
    return c->error * (3 * c->length + 2 * c->error);
}

/* Whether q is strictly inside the circle; *c becomes its centre as seen from q. Exact. */
static inline bool dt_circle_contains(const struct dt_circle *k, const struct dt *t,
                                      struct dt_point q, struct dt_centre *c)
{
    *c = dt_centre_from(k, q);
    double beyond =
        (c->x * c->x + c->y * c->y) - (k->centre.x * k->centre.x + k->centre.y * k->centre.y);
    double error = dt_centre_square_error(c) + dt_centre_square_error(&k->centre);
    if (fabs(beyond) > error)
        return beyond < 0;
    const uint32_t *v = t->mesh.half + k->triangle;
    return dt_incircle(t->points.xy[v[0]], t->points.xy[v[1]], t->points.xy[v[2]], q) > 0;
}

#endif
