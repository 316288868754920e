/* cut.c - see cut.h.
 *
 * [p a b], [q p a] and [p q b] are twice the areas of three triangles, all positive:
 *
 *             b              along  = [p a b] / ([q p a] + [p q b])
 *             |              across = [q p a] / ([q p a] + [p q b])
 *      p ---- x ---> q       x      = p + along (q - p)
 *             |
 *             a              In double words, with u = 2^-53, a product errs by 7 u^2 of itself and a sum by 3.1 u^2, so an
 *                            area by less than 11 u^2 of the sum of its products.
 *
 * An area is used if it is at least 2^-20 of that sum; then it errs by less than 2^-82 of itself. Sums of positive numbers and
 * quotients add 2^-98, so both shares err by less than 2^-80 of themselves. A coordinate of x errs by less than 2^-79 of the
 * side of the way and 2^-100 of the coordinates. If that cannot change the nearest double, it is rounded correctly. In all other
 * cases integers of 2,560 bits decide. */
#include "core/triangle/cut.h"

#include "core/constraints/crossings.h"
#include "core/exact/vectors.h"

#include <math.h>

/* Twice the area of p, q, r. False: it is too small beside its products. */
static bool area_of(struct dt_point p, struct dt_point q, struct dt_point r,
                    struct dt_double2 *area)
{
    struct dt_bounded2 cross = dt_vector2_cross(dt_vector2_of(p, q), dt_vector2_of(p, r));
    *area = cross.value;
    return cross.value.hi >= 0x1p-20 * cross.size;
}

/* The absolute value of the same. */
static struct dt_big exact_area(struct dt_point p, struct dt_point q, struct dt_point r)
{
    struct dt_big_vector a = dt_big_vector_of(p, q), b = dt_big_vector_of(p, r);
    struct dt_big area = dt_big_cross(&a, &b);
    area.sign = 1;
    return area;
}

static struct dt_double2 quotient_of(struct dt_big a, struct dt_big b)
{
    struct dt_big v = dt_big_divide(a, b);
    double hi = dt_big_nearest(v);
    return (struct dt_double2){hi, dt_big_to_double(dt_big_subtract(v, dt_big_of(hi)))};
}

static struct dt_cut exact_cut(struct dt_point p, struct dt_point q, struct dt_point a,
                               struct dt_point b)
{
    struct dt_big right = exact_area(p, q, a), whole = dt_big_add(right, exact_area(q, p, b));
    return (struct dt_cut){.along = quotient_of(exact_area(p, a, b), whole),
                           .across = quotient_of(right, whole),
                           .at = dt_crossing_place(&(struct dt_segment){.p = p, .q = q},
                                                   &(struct dt_segment){.p = a, .q = b})};
}

/* from + along (to - from), rounded once. False: the nearest double is not certain. */
static bool round_coordinate(double from, double to, struct dt_double2 along, double *out)
{
    struct dt_double2 side = dt_double2_difference(to, from);
    struct dt_double2 v =
        dt_double2_add(dt_double2_multiply(along, side), (struct dt_double2){from, 0});
    double error = 0x1p-78 * fabs(side.hi) + 0x1p-99 * fabs(from);
    *out = v.hi;
    if (to == from)
        return true;
    return fabs(v.hi) >= 0x1p-140 && v.hi + (v.lo + error) == v.hi && v.hi + (v.lo - error) == v.hi;
}

struct dt_cut dt_cut_of(struct dt_point p, struct dt_point q, struct dt_point a, struct dt_point b)
{
    struct dt_cut r;
    struct dt_double2 before, right, left;
    if (!area_of(p, a, b, &before) || !area_of(q, p, a, &right) || !area_of(p, q, b, &left))
        return exact_cut(p, q, a, b);
    left = dt_double2_add(left, right);
    r.along = dt_double2_divide(before, left);
    r.across = dt_double2_divide(right, left);
    if (!round_coordinate(p.x, q.x, r.along, &r.at.x) ||
        !round_coordinate(p.y, q.y, r.along, &r.at.y))
        return exact_cut(p, q, a, b);
    return r;
}
