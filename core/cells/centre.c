/* centre.c - see centre.h.
 *
 * A value is computed with a bound of its error. If every number within the bound rounds to the same double, that double is
 * the result. Otherwise the next of three stages decides:
 *
 * 1. Doubles with the first-order errors of each operation, for circumcentres of points whose differences are doubles.
 * 2. Double words.
 * 3. Exact signs, in numbers of 2,500 bits. The points are multiples of 2^-195 below 2^204. So numerators, polynomials
 *    of degree 3, have at most 1,210 bits. */
#include "core/cells/centre.h"

#include "core/exact/lanes2.h"
#include "core/exact/vectors.h"

#include <math.h>

/* Every numerator and denominator below errs by less than UNIT of the sum of the magnitudes of its terms; a quotient errs
 * by less than UNIT of itself. These errors are at most 21 u^2, u = 2^-53, by the bounds of double2.h. */
#define UNIT 0x1p-100

static struct dt_double2 times(struct dt_double2 a, struct dt_double2 b)
{
    return dt_double2_multiply(a, b);
}

/* Rounds from + offset, where the offset is off by at most `error`. False: that does not decide. */
static bool round_sum(double from, struct dt_double2 offset, double error, double *out)
{
    double near, rest, tail;
    dt_two_sum(from, offset.hi, &near, &rest);
    rest += offset.lo;
    error += 0x1p-52 * fabs(rest); /* of that sum and of the ones below */
    dt_two_sum(near, rest, &near, &tail);
    *out = near + 0.0;
    return near + (tail + error) == near && near + (tail - error) == near;
}

/* ---- exact ---- */

/* from + n / d, rounded. */
static double round_big(double from, struct dt_big n, struct dt_big d)
{
    return dt_big_quotient(dt_big_add(dt_big_multiply(dt_big_of(from), d), n), d);
}

/* ---- circumcentres: a + (|b|^2 c' - |c|^2 b') / (2 b x c), where b and c are seen from a, v' = (v.y, -v.x) ---- */

static inline dt_lanes turned(dt_lanes v)
{
    return (dt_lanes){v[1], -v[0]};
}

/* A vector, split for its products. */
struct factor {
    dt_lanes v;
    struct dt_lanes2 split;
};

static inline struct factor factor(dt_lanes v)
{
    return (struct factor){v, dt_lanes2_split(v)};
}

static inline struct factor turn(const struct factor *f)
{
    return (struct factor){turned(f->v), {turned(f->split.hi), turned(f->split.lo)}};
}

static inline struct dt_lanes2 times_lanes(const struct factor *a, const struct factor *b)
{
    return dt_lanes2_product(a->v, a->split, b->v, b->split);
}

/* |b|^2 and |c|^2. */
static inline struct dt_lanes2 squares_of(const struct factor *b, const struct factor *c)
{
    struct dt_lanes2 bb = times_lanes(b, b), cc = times_lanes(c, c);
    struct dt_lanes2 s = dt_lanes2_sum(dt_lanes_first(bb.hi, cc.hi), dt_lanes_second(bb.hi, cc.hi));
    s.lo += dt_lanes_first(bb.lo, cc.lo) + dt_lanes_second(bb.lo, cc.lo);
    return s;
}

/* b x c in both lanes, and the sum of the magnitudes of its terms. */
static inline struct dt_lanes2 area_of(const struct factor *b, const struct factor *c_turned,
                                       dt_lanes *size)
{
    struct dt_lanes2 cross = times_lanes(b, c_turned);
    struct dt_lanes2 area = dt_lanes2_sum(cross.hi, (dt_lanes){cross.hi[1], cross.hi[0]});
    area.lo += cross.lo + (dt_lanes){cross.lo[1], cross.lo[0]};
    *size = dt_lanes_abs(cross.hi);
    *size += (dt_lanes){(*size)[1], (*size)[0]};
    return area;
}

/* |b|^2 c' - |c|^2 b', and the sums of the magnitudes of their terms. */
static inline struct dt_lanes2 numerators(struct dt_lanes2 squares, const struct factor *b_turned,
                                          const struct factor *c_turned, dt_lanes *terms)
{
    struct factor bb = factor(dt_lanes_both(squares.hi[0]));
    struct factor cc = factor(dt_lanes_both(squares.hi[1]));
    struct dt_lanes2 p = times_lanes(&bb, c_turned), q = times_lanes(&cc, b_turned);
    struct dt_lanes2 n = dt_lanes2_sum(p.hi, -q.hi);
    n.lo += (p.lo - q.lo) + (dt_lanes_both(squares.lo[0]) * c_turned->v -
                             dt_lanes_both(squares.lo[1]) * b_turned->v);
    *terms = dt_lanes_abs(p.hi) + dt_lanes_abs(q.hi);
    return n;
}

/* n / (2 area), where scale is 1 / (2 area) in doubles: the quotient in doubles, and its correction. */
static inline struct dt_lanes2 quotient(struct dt_lanes2 n, struct dt_lanes2 area, dt_lanes scale)
{
    dt_lanes q = n.hi * scale, twice = area.hi + area.hi;
    struct dt_lanes2 r = dt_lanes2_product(q, dt_lanes2_split(q), twice, dt_lanes2_split(twice));
    dt_lanes rest = ((n.hi - r.hi) - r.lo) + (n.lo - q * (area.lo + area.lo));
    return (struct dt_lanes2){q, rest * scale};
}

/* As round_sum. */
static inline dt_lanes_holds round_lanes(dt_lanes from, struct dt_lanes2 offset, dt_lanes error,
                                         struct dt_point *out)
{
    struct dt_lanes2 near = dt_lanes2_sum(from, offset.hi);
    dt_lanes rest = near.lo + offset.lo;
    error += dt_lanes_both(0x1p-52) * dt_lanes_abs(rest);
    near = dt_lanes2_sum(near.hi, rest);
    *out = (struct dt_point){near.hi[0] + 0.0, near.hi[1] + 0.0};
    return (near.hi + (near.lo + error) == near.hi) & (near.hi + (near.lo - error) == near.hi);
}

/* False, too, if a difference of b and c from a is not a double. The names: u = 2^-53; `terms` is the sum of the magnitudes
 * of a numerator's two terms, `size` that sum for the area; k = size / |area|; q is the quotient in doubles. The errors:
 *
 * 1. squares: 3.1 u^2 of itself. Its lo, at most 2.1 u of hi, is rounded by two sums.
 * 2. area: 3.1 u^2 size, by the same two sums.
 * 3. numerators: 16 u^2 terms. Step 1 gives 3.1; squares.lo c' 2.1; the difference of these products 2.1; the difference of
 *    the products' errors 1; the two last sums 3.2 and 4.3.
 * 4. rest: (35 terms + 19 |q| size) u^2, with steps 2 and 3 and the roundings. The difference n.hi - r.hi is exact, because
 *    both are few units apart. It is at most 5 u terms. So rest is at most (9.5 terms + 4.3 |q| size) u.
 * 5. rest * scale: step 4 times |scale|, and 4.3 k u of itself, by scale and the product.
 * 6. Together that is less than 80 k u^2 (terms + |q| size) |scale|. k is 2 flat, and 160 u^2 < 2^-98. */
static bool centre_corrected(struct dt_point at, struct dt_point to, struct dt_point on,
                             struct dt_point *out)
{
    dt_lanes a = {at.x, at.y}, size, terms, zero = {0, 0};
    struct dt_lanes2 to_b = dt_lanes2_sum((dt_lanes){to.x, to.y}, -a),
                     to_c = dt_lanes2_sum((dt_lanes){on.x, on.y}, -a);
    struct factor b = factor(to_b.hi), c = factor(to_c.hi), bt = turn(&b), ct = turn(&c);
    struct dt_lanes2 area = area_of(&b, &ct, &size);
    dt_lanes scale = dt_lanes_both(0.5 / area.hi[0]), flat = size * dt_lanes_abs(scale);
    struct dt_lanes2 n = numerators(squares_of(&b, &c), &bt, &ct, &terms);
    struct dt_lanes2 q = quotient(n, area, scale);
    dt_lanes error = (terms + dt_lanes_abs(q.hi) * size) * dt_lanes_abs(scale) * flat;
    dt_lanes_holds sure = round_lanes(a, q, error * dt_lanes_both(0x1p-98), out);
    sure &= (to_b.lo == zero) & (to_c.lo == zero);
    return dt_lanes_bits(sure) == 3 && flat[0] < 0x1p20;
}

static bool centre_double2(struct dt_point a, struct dt_point b, struct dt_point c,
                           struct dt_point *out)
{
    struct dt_double2 bx = dt_double2_difference(b.x, a.x), by = dt_double2_difference(b.y, a.y);
    struct dt_double2 cx = dt_double2_difference(c.x, a.x), cy = dt_double2_difference(c.y, a.y);
    struct dt_double2 bb = dt_double2_add(times(bx, bx), times(by, by));
    struct dt_double2 cc = dt_double2_add(times(cx, cx), times(cy, cy));
    struct dt_double2 area = dt_double2_subtract(times(bx, cy), times(by, cx));
    double flat = fabs(area.hi), size = fabs(bx.hi * cy.hi) + fabs(by.hi * cx.hi);
    if (!(size < 0x1p40 * flat))
        return false;
    struct dt_double2 twice = {2 * area.hi, 2 * area.lo};
    struct dt_double2 x =
        dt_double2_divide(dt_double2_subtract(times(bb, cy), times(cc, by)), twice);
    struct dt_double2 y =
        dt_double2_divide(dt_double2_subtract(times(cc, bx), times(bb, cx)), twice);
    double x_error = (fabs(bb.hi * cy.hi) + fabs(cc.hi * by.hi) + size * fabs(x.hi)) / flat;
    double y_error = (fabs(cc.hi * bx.hi) + fabs(bb.hi * cx.hi) + size * fabs(y.hi)) / flat;
    bool x_done = round_sum(a.x, x, UNIT * (x_error + fabs(x.hi)), &out->x);
    return round_sum(a.y, y, UNIT * (y_error + fabs(y.hi)), &out->y) && x_done;
}

static struct dt_point centre_big(struct dt_point a, struct dt_point b, struct dt_point c)
{
    struct dt_big_vector to_b = dt_big_vector_of(a, b), to_c = dt_big_vector_of(a, c);
    struct dt_big bb = dt_big_dot(&to_b, &to_b), cc = dt_big_dot(&to_c, &to_c);
    struct dt_big area = dt_big_cross(&to_b, &to_c), twice = dt_big_add(area, area);
    struct dt_big x = dt_big_determinant(&bb, &cc, &to_b.y, &to_c.y),
                  y = dt_big_determinant(&cc, &bb, &to_c.x, &to_b.x);
    return (struct dt_point){round_big(a.x, x, twice), round_big(a.y, y, twice)};
}

struct dt_point dt_centre(struct dt_point a, struct dt_point b, struct dt_point c)
{
    struct dt_point p;
    return centre_corrected(a, b, c, &p) || centre_double2(a, b, c, &p) ? p : centre_big(a, b, c);
}

/* ---- two triangles in doubles ---- */

/* Lane k is of triangle k. */
struct pair {
    dt_lanes x, y;
};

static inline struct pair pair_of(struct dt_point p, struct dt_point q)
{
    return (struct pair){{p.x, q.x}, {p.y, q.y}};
}

/* One coordinate: `from` and the offset (p - q) scale. The errors, with u = 2^-53:
 *
 * 1. Differences of places err by u of themselves, squares by 4 u, the area by 4 u of `size`.
 * 2. The numerator p - q errs by 7 u of |p| + |q|, and the quotient by 2 u more.
 * 3. The factors below are larger by an eighth. That covers the second order, as 4 u size / area < 2^-8, and the rounding
 *    of the bound itself.
 *
 * False: the rounded sum may be another double than the exact one. flat: size |scale|. */
static inline dt_lanes_holds round_pair(dt_lanes from, dt_lanes p, dt_lanes q, dt_lanes scale,
                                        dt_lanes flat, dt_lanes *out)
{
    dt_lanes offset = (p - q) * scale;
    dt_lanes error =
        (dt_lanes_abs(p) + dt_lanes_abs(q)) * (dt_lanes_both(8 * 0x1p-53) * dt_lanes_abs(scale)) +
        dt_lanes_abs(offset) * (dt_lanes_both(9 * 0x1p-53) * flat + dt_lanes_both(2.5 * 0x1p-53));
    dt_lanes near = from + offset, part = near - from;
    dt_lanes rest = (from - (near - part)) + (offset - part);
    *out = near + dt_lanes_both(0);
    return (near + (rest + error) == near) & (near + (rest - error) == near);
}

void dt_centre_two(const struct dt_point p[3], const struct dt_point q[3], struct dt_point *of_p,
                   struct dt_point *of_q)
{
    struct pair a = pair_of(p[0], q[0]), b = pair_of(p[1], q[1]), c = pair_of(p[2], q[2]), at;
    b = (struct pair){b.x - a.x, b.y - a.y};
    c = (struct pair){c.x - a.x, c.y - a.y};
    dt_lanes left = b.x * c.y, right = b.y * c.x, area = left - right;
    dt_lanes size = dt_lanes_abs(left) + dt_lanes_abs(right), scale = dt_lanes_both(0.5) / area;
    dt_lanes bb = b.x * b.x + b.y * b.y, cc = c.x * c.x + c.y * c.y;
    dt_lanes flat = size * dt_lanes_abs(scale);
    dt_lanes_holds sure = round_pair(a.x, bb * c.y, cc * b.y, scale, flat, &at.x) &
                          round_pair(a.y, cc * b.x, bb * c.x, scale, flat, &at.y) &
                          (flat < dt_lanes_both(0x1p41));
    int bits = dt_lanes_bits(sure);
    dt_lanes_store(&of_p->x, dt_lanes_first(at.x, at.y));
    dt_lanes_store(&of_q->x, dt_lanes_second(at.x, at.y));
    if ((bits & 1) == 0)
        *of_p = dt_centre(p[0], p[1], p[2]);
    if ((bits & 2) == 0)
        *of_q = dt_centre(q[0], q[1], q[2]);
}

/* ---- bisectors: y = p.y + (dx (dx - 2 (at - p.x)) + dy^2) / (2 dy), where d = q - p ---- */

static double bisector_big(struct dt_point p, struct dt_point q, double at)
{
    struct dt_big_vector d = dt_big_vector_of(p, q);
    struct dt_big w = dt_big_difference(at, p.x);
    struct dt_big n = dt_big_subtract(dt_big_dot(&d, &d), dt_big_multiply(d.x, dt_big_add(w, w)));
    return round_big(p.y, n, dt_big_add(d.y, d.y));
}

double dt_bisector_y(struct dt_point p, struct dt_point q, double at)
{
    double y;
    struct dt_double2 dx = dt_double2_difference(q.x, p.x), dy = dt_double2_difference(q.y, p.y);
    struct dt_double2 w = dt_double2_difference(at, p.x), twice_w = {2 * w.hi, 2 * w.lo};
    struct dt_double2 along = times(dx, dt_double2_subtract(dx, twice_w)), square = times(dy, dy);
    struct dt_double2 twice_dy = {2 * dy.hi, 2 * dy.lo};
    struct dt_double2 offset = dt_double2_divide(dt_double2_add(along, square), twice_dy);
    double error = (fabs(along.hi) + square.hi) / fabs(twice_dy.hi) + fabs(offset.hi);
    return round_sum(p.y, offset, UNIT * error, &y) ? y : bisector_big(p, q, at);
}

double dt_bisector_x(struct dt_point p, struct dt_point q, double at)
{
    return dt_bisector_y((struct dt_point){p.y, p.x}, (struct dt_point){q.y, q.x}, at);
}
