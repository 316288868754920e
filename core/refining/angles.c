/* angles.c - see angles.h. */
#include "core/refining/angles.h"

#include "core/exact/vectors.h"

/* ---- cotangents ---- */

/* The cross product where double words lose too many bits: rounded to a double word. */
static struct dt_double2 exact_cross(struct dt_point r, struct dt_point p, struct dt_point q)
{
    struct dt_big_vector u = dt_big_vector_of(r, p), v = dt_big_vector_of(r, q);
    struct dt_big exact = dt_big_cross(&u, &v);
    double hi = dt_big_nearest(exact);
    return (struct dt_double2){hi, dt_big_nearest(dt_big_subtract(exact, dt_big_of(hi)))};
}

/* Of the angle at r, counterclockwise from p to q. A product of double words errs by 2^-100, so a sum of two errs by 2^-90 of itself
 * if it has more than 2^-10 of their sizes. The dot product may be smaller than that only near 90 degrees; there the
 * cotangent is near 0, and errs by 2^-98. */
static struct dt_double2 cotangent_at(struct dt_point r, struct dt_point p, struct dt_point q)
{
    struct dt_vector2 u = dt_vector2_of(r, p), v = dt_vector2_of(r, q);
    struct dt_bounded2 cross = dt_vector2_cross(u, v);
    if (cross.value.hi < cross.size * 0x1p-10)
        cross.value = exact_cross(r, p, q);
    return dt_double2_divide(dt_vector2_dot(u, v).value, cross.value);
}

static bool is_less(struct dt_double2 a, struct dt_double2 b)
{
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}

/* ---- extremes ---- */

static double dot_at(struct dt_point r, struct dt_point p, struct dt_point q)
{
    return (p.x - r.x) * (q.x - r.x) + (p.y - r.y) * (q.y - r.y);
}

/* Whether the triangle's angles are certainly between those there are. In doubles: products err by 2^-51 of their sizes, so both
 * cotangents by less than 2^-44 of themselves and 1 where the triangle is not thin. */
static bool is_between(const struct dt_angles *a, const struct dt_shape *s)
{
    const double sure = 0x1p-40;
    double size = fabs(s->q.x - s->p.x) * fabs(s->r.y - s->p.y) +
                  fabs(s->q.y - s->p.y) * fabs(s->r.x - s->p.x);
    double dot = dot_at(s->r, s->p, s->q);
    double other = fmin(dot_at(s->p, s->q, s->r), dot_at(s->q, s->r, s->p));
    double largest = a->largest.hi + sure * (1 + fabs(a->largest.hi));
    return a->any && s->cross * 16 > size && dot < a->least.hi * (1 - sure) * s->cross &&
           other > largest * s->cross;
}

void dt_angles_add(struct dt_angles *a, const struct dt_shape *s)
{
    const struct dt_point p[] = {s->p, s->q, s->r, s->p, s->q};
    if (is_between(a, s))
        return;
    for (int k = 0; k < 3; k++) {
        struct dt_double2 c = cotangent_at(p[k], p[k + 1], p[k + 2]);
        if (!a->any || is_less(a->least, c))
            a->least = c;
        if (!a->any || is_less(c, a->largest))
            a->largest = c;
        a->any = true;
    }
}

/* ---- degrees ---- */

static struct dt_double2 root(struct dt_double2 v)
{
    double first = sqrt(v.hi), p, rest;
    dt_two_product(first, first, &p, &rest);
    struct dt_double2 error = dt_double2_add(v, (struct dt_double2){-p, -rest});
    return dt_double2_add((struct dt_double2){first, 0},
                          (struct dt_double2){error.hi / (2 * first), 0});
}

/* In degrees, 0 <= t <= 1: atan t = 2 atan(t / (1 + sqrt(1 + t^2))), four times; then its series. */
static struct dt_double2 arc_tangent(struct dt_double2 t)
{
    enum { HALVINGS = 4, TERMS = 14 }; /* t is below 0.05 then, and 0.05^28 / 29 below 2^-120 */
    const struct dt_double2 pi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53}, one = {1, 0};
    struct dt_double2 sum = {0, 0};
    for (int i = 0; i < HALVINGS; i++) {
        struct dt_double2 square = dt_double2_add(one, dt_double2_multiply(t, t));
        t = dt_double2_divide(t, dt_double2_add(one, root(square)));
    }
    struct dt_double2 square = dt_double2_negate(dt_double2_multiply(t, t));
    for (int k = TERMS; k >= 0; k--) {
        struct dt_double2 term = dt_double2_divide(one, (struct dt_double2){2 * k + 1, 0});
        sum = dt_double2_add(term, dt_double2_multiply(square, sum));
    }
    sum = dt_double2_multiply(dt_double2_multiply(t, sum), (struct dt_double2){180 << HALVINGS, 0});
    return dt_double2_divide(sum, pi);
}

/* Of an angle of at most 90 degrees. */
static struct dt_double2 acute(struct dt_double2 cotangent)
{
    const struct dt_double2 one = {1, 0}, right = {90, 0};
    if (cotangent.hi > 1)
        return arc_tangent(dt_double2_divide(one, cotangent));
    return dt_double2_add(right, dt_double2_negate(arc_tangent(cotangent)));
}

double dt_degrees(struct dt_double2 cotangent)
{
    const struct dt_double2 half = {180, 0};
    if (cotangent.hi >= 0)
        return acute(cotangent).hi;
    return dt_double2_add(half, dt_double2_negate(acute(dt_double2_negate(cotangent)))).hi;
}
