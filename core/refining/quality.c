/* quality.c - see quality.h. */
#include "core/refining/quality.h"

#include "core/exact/predicates.h"
#include "core/exact/vectors.h"

/* Two sides that differ by less than this part of them are compared exactly: the rounding errors of a dozen operations are
 * below 2^-48. */
#define CLOSE 0x1p-40

/* ---- limits ---- */

/* The cosine of twice the angle in degrees, by its series; it errs by less than 2^-100. */
static struct dt_double2 cosine_of_twice(double degrees)
{
    enum { TERMS = 24 }; /* 2.1^48 / 48! < 2^-150 */
    const struct dt_double2 pi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53}, one = {1, 0};
    struct dt_double2 x = dt_double2_divide(
        dt_double2_multiply((struct dt_double2){degrees, 0}, pi), (struct dt_double2){90, 0});
    struct dt_double2 square = dt_double2_multiply(x, x), sum = one;
    for (int k = TERMS; k > 0; k--) {
        struct dt_double2 divisor = {(2 * k - 1) * (2 * k), 0};
        sum = dt_double2_divide(dt_double2_multiply(dt_double2_negate(square), sum), divisor);
        sum = dt_double2_add(one, sum);
    }
    return sum;
}

double dt_cosine2(double degrees)
{
    struct dt_double2 twice = cosine_of_twice(degrees);
    struct dt_double2 sum = dt_double2_add((struct dt_double2){1, 0}, twice);
    return sum.hi / 2;
}

void dt_wanted_of(const struct dt_quality *q, struct dt_wanted *out)
{
    const double nearer =
        0.95; /* than where the angle is just large enough [Shewchuk, Triangle 1.6] */
    *out = (struct dt_wanted){.cosine2 = 2, .area = HUGE_VAL, .length = HUGE_VAL};
    if (q->area > 0)
        out->area = q->area;
    if (q->length > 0)
        out->length = q->length;
    if (q->angle > 0) {
        out->cosine2 = dt_cosine2(q->angle);
        double c = sqrt(out->cosine2);
        out->off =
            nearer * sqrt((1 + c) / (1 - c)) / 2; /* half of the cotangent of half the angle */
    }
}

/* ---- exact comparisons ---- */

static bool is_large_exactly(double area, const struct dt_shape *s)
{
    struct dt_big_vector u = dt_big_vector_of(s->p, s->q), v = dt_big_vector_of(s->p, s->r);
    struct dt_big limit = dt_big_multiply(dt_big_of(area), dt_big_of(2));
    return dt_big_compare(dt_big_cross(&u, &v), limit) > 0;
}

/* Whether the angle at r is too small. */
static bool is_sharp_exactly(double cosine, struct dt_point p, struct dt_point q, struct dt_point r)
{
    struct dt_big_vector u = dt_big_vector_of(r, p), v = dt_big_vector_of(r, q);
    struct dt_big dot = dt_big_dot(&u, &v);
    struct dt_big sides = dt_big_multiply(dt_big_dot(&u, &u), dt_big_dot(&v, &v));
    return dot.sign > 0 &&
           dt_big_compare(dt_big_multiply(dot, dot), dt_big_multiply(sides, dt_big_of(cosine))) > 0;
}

/* ---- the same, by doubles where they decide ---- */

bool dt_is_sharp(double cosine, const struct dt_shape *s)
{
    double dot = (s->p.x - s->r.x) * (s->q.x - s->r.x) + (s->p.y - s->r.y) * (s->q.y - s->r.y);
    double left = dot * dot, right = cosine * s->qr * s->rp;
    if (cosine > 1 || dot <= 0)
        return false;
    if (fabs(left - right) > CLOSE * right)
        return left > right;
    /* Edges that look equally short may differ: each angle is asked. */
    return is_sharp_exactly(cosine, s->p, s->q, s->r) ||
           is_sharp_exactly(cosine, s->q, s->r, s->p) || is_sharp_exactly(cosine, s->r, s->p, s->q);
}

static bool is_large(double area, const struct dt_shape *s)
{
    double size = fabs(s->q.x - s->p.x) * fabs(s->r.y - s->p.y) +
                  fabs(s->q.y - s->p.y) * fabs(s->r.x - s->p.x);
    double excess = s->cross - 2 * area;
    if (fabs(excess) > CLOSE * (size + area))
        return excess > 0;
    return is_large_exactly(area, s);
}

bool dt_is_long(const struct dt_wanted *w, struct dt_point a, struct dt_point b)
{
    return w->length < HUGE_VAL && dt_compare_radius(a, b, w->length) > 0;
}

unsigned dt_shape_breaks(const struct dt_wanted *w, const struct dt_shape *s)
{
    unsigned bits = dt_is_sharp(w->cosine2, s) ? DT_SHARP : 0;
    if (w->area < HUGE_VAL && is_large(w->area, s))
        bits |= DT_LARGE;
    if (w->length < HUGE_VAL &&
        (dt_is_long(w, s->p, s->q) || dt_is_long(w, s->q, s->r) || dt_is_long(w, s->r, s->p)))
        bits |= DT_LONG;
    return bits;
}
