/* bounds_test.c - values computed in doubles against exact integers: the error never exceeds its
 * bound of bounds.h, on points that maximise the rounding error.
 *
 * A climb begins with points on nearly one line or circle, with coordinates just above powers of two. It changes one
 * coordinate after another if that makes the error a larger share of the bound. A bound fails if it is smaller than
 * the share that climbs reach. All climbs are made at the least exponents, at the greatest, and in
 * between. */
#include "core/exact/bounds.h"

#include <math.h>

#include "core/divide/sight.h"
#include "core/exact/box.h"
#include "core/exact/double2.h"
#include "core/exact/predicates.h"
#include "core/shelling/scan.h"
#include "tests/oracle/exact.h"
#include "tests/test.h"

enum {
    POINTS = 4,
    MORE = 256, /* bits below those of the coordinates, for bounds */
    STEPS = 1000,
    CLIMBS = 18
};

/* An error and its bound, exact and to the same scale. */
struct error {
    struct exact of, bound;
};

/* ---- exact values ---- */

static struct exact difference(double a, double b)
{
    struct exact x = exact_from_double(a), y = exact_from_double(b);
    return exact_subtract(&x, &y);
}

static struct exact times(struct exact a, struct exact b)
{
    return exact_multiply(&a, &b);
}

static struct exact plus(struct exact a, struct exact b)
{
    return exact_add(&a, &b);
}

static struct exact minus(struct exact a, struct exact b)
{
    return exact_subtract(&a, &b);
}

/* (b - a) x (d - c) and (b - a) . (d - c). */
static struct exact cross(struct dt_point a, struct dt_point b, struct dt_point c,
                          struct dt_point d)
{
    return minus(times(difference(b.x, a.x), difference(d.y, c.y)),
                 times(difference(b.y, a.y), difference(d.x, c.x)));
}

static struct exact dot(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    return plus(times(difference(b.x, a.x), difference(d.x, c.x)),
                times(difference(b.y, a.y), difference(d.y, c.y)));
}

/* dt(c) cr(x) - dt(x) cr(c) for the base l-r. */
static struct exact determinant(struct dt_point l, struct dt_point r, struct dt_point c,
                                struct dt_point x)
{
    return minus(times(dot(l, c, r, c), cross(l, r, l, x)),
                 times(dot(l, x, r, x), cross(l, r, l, c)));
}

static struct exact more(struct exact a)
{
    return times(a, exact_scaled(1, MORE));
}

/* Of a value that should be `want`, of that degree in the coordinates. */
static struct error error_of(int degree, struct exact want, double value, double bound)
{
    return (struct error){minus(more(want), exact_scaled(value, 194 * degree + MORE)),
                          exact_scaled(bound, 194 * degree + MORE)};
}

/* Of a quotient that should be above / below, both of degree 2. */
static struct error error_of_quotient(struct exact above, struct exact below, double value,
                                      double bound)
{
    return (struct error){
        minus(times(above, exact_scaled(1, 2 * MORE)), times(below, exact_scaled(value, 2 * MORE))),
        times(below, exact_scaled(bound, 2 * MORE))};
}

/* ---- the expressions ---- */

/* The sign of the rounded value survives its last rounding, so that one is not in the bound. */
static double last(double value)
{
    return DT_U * fabs(value);
}

static struct error orient2d(const struct dt_point *p)
{
    double size, det = dt_orient2d_rounded(p[0], p[1], p[2], &size);
    return error_of(2, cross(p[2], p[0], p[2], p[1]), det, DT_ORIENT_BOUND * size + last(det));
}

static struct error incircle(const struct dt_point *p)
{
    double size, det = dt_incircle_rounded(p[0], p[1], p[2], p[3], &size);
    return error_of(4, determinant(p[3], p[2], p[1], p[0]), det,
                    DT_CLOSE_DET_BOUND * size + last(det));
}

/* p[2] and p[3] as the base p[0]-p[1] sees them. */
static struct sight view(const struct dt_point *p)
{
    struct sight_base at = sight_base_of(p[0], p[1]);
    return sight_of(p, &at, 2, 3);
}

static double side_of(const struct dt_point *p)
{
    struct dt_box box = dt_box_of(p, POINTS);
    return dt_box_side(&box);
}

static struct error wide_cr(const struct dt_point *p)
{
    return error_of(2, cross(p[0], p[1], p[0], p[2]), view(p).cr[0],
                    dt_wide_bounds_of(side_of(p)).cr);
}

static struct error wide_dt(const struct dt_point *p)
{
    return error_of(2, dot(p[0], p[2], p[1], p[2]), view(p).dt[0],
                    dt_wide_bounds_of(side_of(p)).cr);
}

static double rounded_determinant(const struct dt_point *p)
{
    struct sight c = view(p);
    return c.dt[0] * c.cr[1] - c.dt[1] * c.cr[0];
}

static struct error wide_det(const struct dt_point *p)
{
    return error_of(4, determinant(p[0], p[1], p[2], p[3]), rounded_determinant(p),
                    dt_wide_bounds_of(side_of(p)).det);
}

static struct error close_det(const struct dt_point *p)
{
    struct sight c = view(p);
    return error_of(4, determinant(p[0], p[1], p[2], p[3]), rounded_determinant(p),
                    sight_close_of_pair(&c));
}

/* Of p[0], p[1], p[2] as p[3] sees them. */
static struct error lifted_det(const struct dt_point *p)
{
    struct dt_lifted a = dt_lift(p[0], p[3]), b = dt_lift(p[1], p[3]), c = dt_lift(p[2], p[3]);
    double bound, det = dt_lifted_det(a, b, c, dt_lifted_cross(a, b), dt_lifted_cross(b, c),
                                      dt_lifted_cross(c, a), &bound);
    return error_of(4, determinant(p[3], p[2], p[1], p[0]), det, bound + last(det));
}

/* The same where a vertex is at infinity: twice the area of the others and p[2]. */
static struct error lifted_ghost(const struct dt_point *p)
{
    struct dt_lifted a = dt_lift(p[0], p[2]), b = dt_lift(p[1], p[2]), c = dt_lifted_infinity;
    double bound, det = dt_lifted_det(a, b, c, dt_lifted_cross(a, b), dt_lifted_cross(b, c),
                                      dt_lifted_cross(c, a), &bound);
    return error_of(2, cross(p[2], p[0], p[2], p[1]), det, bound + last(det));
}

/* ---- double words ---- */

struct words {
    struct dt_double2 value;
    double size;
};

/* (b - a) (d - c) */
static struct dt_double2 product_2(double a, double b, double c, double d)
{
    return dt_double2_multiply(dt_double2_difference(b, a), dt_double2_difference(d, c));
}

static struct words sum_2(struct dt_double2 a, struct dt_double2 b)
{
    return (struct words){dt_double2_add(a, b), fabs(a.hi) + fabs(b.hi)};
}

static struct words cross_2(struct dt_point a, struct dt_point b, struct dt_point c,
                            struct dt_point d)
{
    return sum_2(product_2(a.x, b.x, c.y, d.y), dt_double2_negate(product_2(a.y, b.y, c.x, d.x)));
}

static struct words dot_2(struct dt_point a, struct dt_point b, struct dt_point c,
                          struct dt_point d)
{
    return sum_2(product_2(a.x, b.x, c.x, d.x), product_2(a.y, b.y, c.y, d.y));
}

static struct error error_of_words(int degree, struct exact want, struct dt_double2 value,
                                   double bound)
{
    struct error e = error_of(degree, want, value.hi, bound);
    e.of = minus(e.of, exact_scaled(value.lo, 194 * degree + MORE));
    return e;
}

static struct error orient2d_2(const struct dt_point *p)
{
    struct words det = cross_2(p[2], p[0], p[2], p[1]);
    return error_of_words(2, cross(p[2], p[0], p[2], p[1]), det.value,
                          DT_ORIENT_BOUND_2 * det.size);
}

static struct error incircle_2(const struct dt_point *p)
{
    struct words cr_c = cross_2(p[0], p[1], p[0], p[2]), cr_x = cross_2(p[0], p[1], p[0], p[3]);
    struct words dt_c = dot_2(p[0], p[2], p[1], p[2]), dt_x = dot_2(p[0], p[3], p[1], p[3]);
    struct dt_double2 left = dt_double2_multiply(dt_c.value, cr_x.value),
                      right = dt_double2_multiply(dt_x.value, cr_c.value);
    struct dt_double2 det = dt_double2_add(left, dt_double2_negate(right));
    return error_of_words(4, determinant(p[0], p[1], p[2], p[3]), det,
                          DT_INCIRCLE_BOUND_2 * (dt_c.size * cr_x.size + dt_x.size * cr_c.size));
}

/* ---- distances ---- */

static struct error square_distance(const struct dt_point *p)
{
    double d = dt_square_distance(p[0], p[1]);
    return error_of(2, dot(p[0], p[1], p[0], p[1]), d, DT_DISTANCE_BOUND * d);
}

/* x and y of w.q, w = p[1] - p[0], q = p[2] - p[0]. */
static struct dt_point products(const struct dt_point *p)
{
    return (struct dt_point){(p[1].x - p[0].x) * (p[2].x - p[0].x),
                             (p[1].y - p[0].y) * (p[2].y - p[0].y)};
}

static struct error inverse(const struct dt_point *p)
{
    struct dt_point v = products(p);
    double square = dt_square_distance(p[1], p[0]);
    return error_of_quotient(dot(p[0], p[1], p[0], p[2]), dot(p[0], p[1], p[0], p[1]),
                             (v.x + v.y) / square,
                             DT_INVERSE_BOUND * (fabs(v.x) + fabs(v.y)) / square);
}

/* ---- the third-point search: p[0]-p[1] is the edge ---- */

struct seen {
    double cross, dot, reach, span;
};

static double coordinate(double a, double b, double least)
{
    return fmax(least, nextafter(fabs(a - b), HUGE_VAL));
}

static struct seen see(const struct dt_point *p, int i)
{
    struct dt_point a = p[0], b = p[1], d = {b.x - a.x, b.y - a.y};
    double x = p[i].x - a.x, y = p[i].y - a.y;
    struct seen s = {d.x * y - d.y * x, x * (p[i].x - b.x) + y * (p[i].y - b.y), 0,
                     fabs(d.x) + fabs(d.y)};
    for (int k = 0; k < 2; k++)
        s.reach = coordinate(p[i].x, p[k].x, coordinate(p[i].y, p[k].y, s.reach));
    return s;
}

static struct error scan_cross(const struct dt_point *p)
{
    struct seen s = see(p, 2);
    return error_of(2, cross(p[0], p[1], p[0], p[2]), s.cross,
                    DT_SCAN_CROSS_BOUND * s.span * s.reach);
}

static struct error scan_dot(const struct dt_point *p)
{
    struct seen s = see(p, 2);
    return error_of(2, dot(p[0], p[2], p[1], p[2]), s.dot, DT_SCAN_DOT_BOUND * s.reach * s.reach);
}

static struct error scan_det(const struct dt_point *p)
{
    struct seen c = see(p, 2), x = see(p, 3);
    double reach = fmax(c.reach, x.reach);
    return error_of(4, determinant(p[0], p[1], p[2], p[3]), c.dot * x.cross - x.dot * c.cross,
                    DT_SCAN_DET_BOUND * c.span * reach * reach * reach);
}

/* Half of the least difference of two cotangents. None where the cotangent is not asked for. */
static struct error scan_cotangent(const struct dt_point *p)
{
    struct seen s = see(p, 2);
    struct error none = {{0, {0}}, exact_from_double(1)};
    if (s.cross <= DT_SCAN_SURE * s.span * s.reach)
        return none;
    double cotangent = s.dot / s.cross;
    return error_of_quotient(dot(p[0], p[2], p[1], p[2]), cross(p[0], p[1], p[0], p[2]), cotangent,
                             DT_SCAN_SURE / 2 * (2 * s.reach / s.span + fabs(cotangent)));
}

/* ---- points that lose much ---- */

/* Just above a power of two, where rounding takes most; so small that it is rounded off; or any. */
static double fresh(void)
{
    double v = 1 + test_below(64) * 0x1p-52;
    switch (test_below(4)) {
    case 0:
        v = ldexp(1 + test_uniform(), -50 - (int)test_below(8));
        break;
    case 1:
        v = test_uniform() + 0x1p-53;
        break;
    default:
        v = ldexp(v, -(int)test_below(3));
        break;
    }
    return test_below(2) ? v : -v;
}

/* Another value near v, or a fresh one. */
static double changed(double v)
{
    double w = v;
    switch (test_below(4)) {
    case 0:
        return fresh();
    case 1:
        w = v * (1 + ((int)test_below(65) - 32) * 0x1p-30);
        break;
    default:
        for (uint32_t i = 1 + test_below(8); i > 0; i--)
            w = nextafter(w, test_below(2) ? 4 : -4);
        break;
    }
    return fabs(w) < 0x1p-60 ? v : w;
}

static struct dt_point scaled(struct dt_point p, int exponent)
{
    return (struct dt_point){ldexp(p.x, exponent), ldexp(p.y, exponent)};
}

struct expression {
    const char *name;
    struct error (*error)(const struct dt_point *p);
    double seen;   /* a share of the bound that climbs reach */
    bool quotient; /* of values of very different size it may be beyond what exact.h holds */
};

static const struct expression expressions[] = {
    {"orient2d", orient2d, 0.8, false},
    {"incircle", incircle, 0.45, false},
    {"cr, wide", wide_cr, 0.4, false},
    {"dt, wide", wide_dt, 0.55, false},
    {"det, wide", wide_det, 0.03, false},
    {"det, close", close_det, 0.5, false},
    {"det, lifted", lifted_det, 0.15, false},
    {"det, lifted, ghost", lifted_ghost, 0, false},
    {"orient2d in double words", orient2d_2, 0.15, false},
    {"incircle in double words", incircle_2, 0.06, false},
    {"square distance", square_distance, 0.4, false},
    {"inverse", inverse, 0.3, true},
    {"cross of a scan", scan_cross, 0.4, false},
    {"dot of a scan", scan_dot, 0.45, false},
    {"det of a scan", scan_det, 0.18, false},
    {"cotangent of a scan", scan_cotangent, 0, true},
};
enum { EXPRESSIONS = sizeof expressions / sizeof *expressions };

/* The error's share of the bound, which it must not exceed. */
static double share_of(const struct expression *e, const struct dt_point *p)
{
    struct error error = e->error(p);
    error.of.sign = error.of.sign != 0;
    CHECK_MSG(error.bound.sign >= 0 && exact_subtract(&error.of, &error.bound).sign <= 0,
              "%s: %.3f of the bound at (%a, %a) (%a, %a) (%a, %a) (%a, %a)", e->name,
              exact_ratio(&error.of, &error.bound), p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y,
              p[3].x, p[3].y);
    return error.of.sign == 0 ? 0 : exact_ratio(&error.of, &error.bound);
}

static double climb(const struct expression *e, int exponent)
{
    struct dt_point p[POINTS], q[POINTS], s[POINTS];
    double best = -1;
    for (int i = 0; i < POINTS; i++)
        p[i] = (struct dt_point){fresh(), fresh()};
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < POINTS; i++)
            q[i] = p[i];
        for (uint32_t changes = step == 0 ? 0 : 1 + test_below(2); changes > 0; changes--) {
            double *v = test_below(2) ? &q[test_below(POINTS)].x : &q[test_below(POINTS)].y;
            const struct dt_point *like = &p[test_below(POINTS)];
            *v = changed(test_below(4) ? *v : test_below(2) ? like->x : like->y);
        }
        for (int i = 0; i < POINTS; i++)
            s[i] = scaled(q[i], exponent);
        double share = share_of(e, s);
        for (int i = 0; i < POINTS && share >= best; i++)
            p[i] = q[i];
        best = fmax(best, share);
    }
    return best;
}

TEST_TIMEOUT(no_error_exceeds_its_bound_and_some_come_near_it, 60)
{
    static const int exponents[] = {-81, 0, 199};
    for (const struct expression *e = expressions; e < expressions + EXPRESSIONS; e++) {
        double most = 0;
        for (int i = 0; i < CLIMBS; i++)
            most = fmax(most, climb(e, exponents[i % 3]));
        CHECK_MSG(most >= e->seen, "%s: only %.3f of the bound", e->name, most);
    }
}

/* Any exponent at all. */
static double wild(void)
{
    double v = test_below(9) == 0 ? 0 : ldexp(1 + test_uniform() / 2, (int)test_below(343) - 142);
    return test_below(2) ? v : -v;
}

TEST_TIMEOUT(no_error_exceeds_its_bound_for_any_exponents, 60)
{
    for (int i = 0; i < 400; i++) {
        struct dt_point p[POINTS];
        for (int k = 0; k < POINTS; k++)
            p[k] = (struct dt_point){wild(), wild()};
        for (const struct expression *e = expressions; e < expressions + EXPRESSIONS; e++)
            if (!e->quotient)
                (void)share_of(e, p);
    }
}

/* ---- limits of searches ---- */

TEST_TIMEOUT(an_upper_bound_of_a_cotangent_is_at_least_the_cotangent, 60)
{
    unsigned bounded = 0;
    for (int i = 0; i < 20000; i++) {
        struct dt_point p[POINTS];
        for (int k = 0; k < POINTS; k++)
            p[k] = scaled((struct dt_point){fresh(), fresh()}, (i % 3 - 1) * 80);
        struct seen s = see(p, 2);
        struct dt_scan q = {
            .exact = true, .reach = s.reach, .best = 2, .dot = s.dot, .cross = s.cross};
        q.edge.span = s.span;
        double bound = dt_scan_bound(&q);
        if (bound == HUGE_VAL)
            continue;
        struct exact below = cross(p[0], p[1], p[0], p[2]), above = dot(p[0], p[2], p[1], p[2]);
        CHECK(below.sign > 0);
        CHECK(minus(times(above, exact_scaled(1, 2 * MORE)),
                    times(below, exact_scaled(bound, 2 * MORE)))
                  .sign <= 0);
        bounded++;
    }
    CHECK(bounded > 2000);
}

/* Coordinates to a finer scale than 2^-194, since a border may lie between them. */
static struct exact fine(double v)
{
    return exact_scaled(v, 194 + 200);
}

/* a |a| */
static struct exact signed_square(struct exact a)
{
    struct exact square = times(a, a);
    square.sign = a.sign;
    return square;
}

/* Whether `limit` is beyond the circle of cotangent s over the edge from 0 along (t, d), in the
 * direction g = 1 or -1 of the axis of d. The circle's extreme point there is left of the edge; it
 * is (d + s across) / 2 + g r away, r = |(t, d)| sqrt(1 + s^2) / 2. All but s, which is a multiple
 * of 2^-20, to the same scale. */
static bool is_beyond_circle(struct exact limit, struct exact d, struct exact across,
                             struct exact s, int g)
{
    struct exact one = exact_scaled(1, 20), two = exact_scaled(1, 21);
    struct exact x = minus(times(limit, two), plus(times(d, one), times(s, across)));
    struct exact square =
        times(plus(times(d, d), times(across, across)), plus(times(one, one), times(s, s)));
    return x.sign * g >= 0 && minus(times(x, x), square).sign >= 0;
}

/* Whether the circle's extreme point in a direction is left of the edge: s |d| > t sqrt(1 +
 * s^2). */
static bool reaches(struct exact dx, struct exact dy, struct exact s, struct exact t)
{
    struct exact one = exact_scaled(1, 20);
    struct exact length = plus(times(dx, dx), times(dy, dy)),
                 root = plus(times(one, one), times(s, s));
    return minus(times(signed_square(s), length), times(signed_square(t), root)).sign > 0;
}

static struct exact negative(struct exact a)
{
    a.sign = -a.sign;
    return a;
}

TEST_TIMEOUT(the_box_of_a_segment_contains_it, 60)
{
    unsigned far = 0;
    for (int i = 0; i < 4000; i++) {
        int exponent = (i % 3 - 1) * 80;
        struct dt_point a = scaled((struct dt_point){fresh(), fresh()}, exponent);
        struct dt_point b = scaled((struct dt_point){fresh(), fresh()}, exponent),
                        d = {b.x - a.x, b.y - a.y};
        if (a.x == b.x && a.y == b.y)
            continue;
        struct dt_edge e = {a, b, d, sqrt(dt_square_distance(b, a)), fabs(d.x) + fabs(d.y)};
        double cotangent = ldexp((double)test_below(1u << 24) - 0x1p23, -(int)test_below(20));
        struct dt_box box = dt_segment_of_cotangent(&e, cotangent).box;
        struct exact s = exact_scaled(cotangent, 20), dx = minus(fine(b.x), fine(a.x)),
                     dy = minus(fine(b.y), fine(a.y));
        struct exact hi_x = minus(fine(box.hi.x), fine(a.x)),
                     lo_x = minus(fine(box.lo.x), fine(a.x));
        struct exact hi_y = minus(fine(box.hi.y), fine(a.y)),
                     lo_y = minus(fine(box.lo.y), fine(a.y));
        CHECK(dt_box_contains(&box, a) && dt_box_contains(&box, b));
        CHECK(!reaches(dx, dy, s, dy) || is_beyond_circle(hi_x, dx, negative(dy), s, 1));
        CHECK(!reaches(dx, dy, s, negative(dy)) || is_beyond_circle(lo_x, dx, negative(dy), s, -1));
        CHECK(!reaches(dx, dy, s, negative(dx)) || is_beyond_circle(hi_y, dy, dx, s, 1));
        CHECK(!reaches(dx, dy, s, dx) || is_beyond_circle(lo_y, dy, dx, s, -1));
        far += reaches(dx, dy, s, dy);
    }
    CHECK(far > 500);
}
