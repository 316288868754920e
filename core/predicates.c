/* predicates.c - what the inline filters of predicates.h leave open.
 *
 * Each predicate tries what is cheap and certain before it computes the polynomial as an expansion:
 *
 *     filter (inline)            decides all but one call in 10^4 on random points
 *     axis-parallel rectangle    incircle: exactly zero; most ties on lattices
 *     256-bit integers           incircle: differences on a common grid, 55 bits
 *     double words               about 100 bits: nearly all that is not a tie
 *     expansions                 exact whatever the input [Shewchuk 1997]
 *
 * Why nothing overflows or underflows: a coordinate is 0 or of magnitude 2^-142 to 2^201, so it is
 * a multiple of 2^-194, and so are differences; every intermediate value of degree k is then a
 * multiple of 2^(-194 k), at least 2^-776, and below 2^(203 k + 4), at most 2^816.
 *
 * Bounds of the double words, relative errors in units of u^2 = 2^-106: a difference is exact, a
 * product 7, a sum 3.1 of its own result. A 2x2 minor is off by at most 7 + 3.1 < 10.2 times the
 * sum of its products' magnitudes, a lift by 10.2 times itself; their product by 27.5, and the two
 * sums of three of them by 6.3 more: 34 times the permanent, to first order. The permanent in
 * doubles is right to 1 part in 2^49, and the higher half of a double word has the sign of the
 * whole and is right to 1 part in 2^53. 64 u^2 and 16 u^2 leave room for all that. */
#include "core/predicates.h"

#include <string.h>

#include "core/expansion.h"

#define ORIENT_BOUND_2 0x1p-102   /* 16 u^2 */
#define INCIRCLE_BOUND_2 0x1p-100 /* 64 u^2 */

static int sign_of(double v)
{
    return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/* ---- orient2d ---- */

/* h[16] = ux vy - vx uy for expansions of two components; returns the length. */
static int minor(int nux, const double *ux, int nuy, const double *uy, int nvx, const double *vx,
                 int nvy, const double *vy, double *h)
{
    double left[8], right[8], work[12];
    int nl = dt_expansion_product(nux, ux, nvy, vy, left, work);
    int nr = dt_expansion_product(nvx, vx, nuy, uy, right, work);
    dt_expansion_negate(nr, right);
    return dt_expansion_sum(nl, left, nr, right, h);
}

static int orient2d_expansion(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double ax[2], ay[2], bx[2], by[2], det[16];
    int nax = dt_expansion_difference(a.x, c.x, ax), nay = dt_expansion_difference(a.y, c.y, ay);
    int nbx = dt_expansion_difference(b.x, c.x, bx), nby = dt_expansion_difference(b.y, c.y, by);
    return dt_expansion_sign(minor(nax, ax, nay, ay, nbx, bx, nby, by, det), det);
}

int dt_orient2d_exact(struct dt_point a, struct dt_point b, struct dt_point c)
{
    if ((a.x == c.x || b.y == c.y) && (a.y == c.y || b.x == c.x))
        return 0; /* as both products are: the usual case on lattices */
    struct dt_double2 ax = dt_double2_difference(a.x, c.x), ay = dt_double2_difference(a.y, c.y);
    struct dt_double2 bx = dt_double2_difference(b.x, c.x), by = dt_double2_difference(b.y, c.y);
    if (ax.lo == 0 && ay.lo == 0 && bx.lo == 0 &&
        by.lo == 0) { /* two products decide: rounding is monotone */
        double left, left_tail, right, right_tail;
        dt_two_product(ax.hi, by.hi, &left, &left_tail);
        dt_two_product(ay.hi, bx.hi, &right, &right_tail);
        return sign_of(left != right ? left - right : left_tail - right_tail);
    }
    struct dt_double2 left = dt_double2_multiply(ax, by), right = dt_double2_multiply(ay, bx);
    struct dt_double2 det = dt_double2_add(left, dt_double2_negate(right));
    if (fabs(det.hi) > ORIENT_BOUND_2 * (fabs(left.hi) + fabs(right.hi)))
        return sign_of(det.hi);
    return orient2d_expansion(a, b, c);
}

/* ---- incircle ---- */

/* The differences of a, b, c to d: double words hi[i] + lo[i], 0 to 2 in x, 3 to 5 in y. */
struct differences {
    double hi[6], lo[6];
};

static void differences_to(struct dt_point a, struct dt_point b, struct dt_point c,
                           struct dt_point d, struct differences *r)
{
    dt_two_sum(a.x, -d.x, &r->hi[0], &r->lo[0]);
    dt_two_sum(b.x, -d.x, &r->hi[1], &r->lo[1]);
    dt_two_sum(c.x, -d.x, &r->hi[2], &r->lo[2]);
    dt_two_sum(a.y, -d.y, &r->hi[3], &r->lo[3]);
    dt_two_sum(b.y, -d.y, &r->hi[4], &r->lo[4]);
    dt_two_sum(c.y, -d.y, &r->hi[5], &r->lo[5]);
}

/* 2^54 / 2^floor(log2 largest) for the largest magnitude. That is not 0: four equal points are a
 * rectangle. */
static double scale_of(const struct differences *d)
{
    double largest = 0, scale;
    uint64_t bits;
    for (int i = 0; i < 6; i++)
        largest = fabs(d->hi[i]) > largest ? fabs(d->hi[i]) : largest;
    memcpy(&bits, &largest, sizeof bits);
    bits = (uint64_t)(1023 + 54 + 1023 - (int)(bits >> 52)) << 52;
    memcpy(&scale, &bits, sizeof scale);
    return scale;
}

/* If the differences are integers below 2^55 times a common power of two, puts them in v. The power
 * is found from the largest one, so this needs to know nothing about the set of points. */
static bool to_integers(const struct differences *d, int64_t v[6])
{
    double scale = scale_of(d), tails = 0;
    int broken = 0;
    for (int i = 0; i < 6; i++) {
        double hi = d->hi[i] * scale;
        v[i] = (int64_t)hi;
        broken |= (double)v[i] != hi;
        tails += fabs(d->lo[i]);
    }
    if (tails == 0 || broken)
        return !broken;
    for (int i = 0; i < 6; i++) {
        double lo = d->lo[i] * scale;
        int64_t rest = (int64_t)lo;
        v[i] += rest;
        broken |= (double)rest != lo;
    }
    return !broken;
}

/* high * 2^128 + low */
struct wide {
    __int128 high;
    unsigned __int128 low;
};

/* a * b for factors below 2^113. */
static struct wide multiply(__int128 a, __int128 b)
{
    __int128 a_high = a >> 64, b_high = b >> 64;
    uint64_t a_low = (uint64_t)a, b_low = (uint64_t)b;
    unsigned __int128 low = (unsigned __int128)a_low * b_low;
    __int128 middle = a_high * (__int128)b_low + b_high * (__int128)a_low + (__int128)(low >> 64);
    return (struct wide){a_high * b_high + (middle >> 64),
                         (unsigned __int128)middle << 64 | (uint64_t)low};
}

/* The determinant in the form of sight.h, dt(b) cr(a) - dt(a) cr(b) for the base d-c: factors below
 * 2^112, which are multiplied in full. */
static int incircle_integers(const int64_t v[6])
{
    int64_t ax = v[0], bx = v[1], cx = v[2], ay = v[3], by = v[4], cy = v[5];
    __int128 cr_a = (__int128)cx * ay - (__int128)cy * ax;
    __int128 cr_b = (__int128)cx * by - (__int128)cy * bx;
    __int128 dt_a = (__int128)ax * (ax - cx) + (__int128)ay * (ay - cy);
    __int128 dt_b = (__int128)bx * (bx - cx) + (__int128)by * (by - cy);
    struct wide inside = multiply(dt_b, cr_a), outside = multiply(dt_a, cr_b);
    if (inside.high != outside.high)
        return inside.high > outside.high ? 1 : -1;
    return (inside.low > outside.low) - (inside.low < outside.low);
}

static struct dt_double2 lift_2(struct dt_double2 x, struct dt_double2 y)
{
    return dt_double2_add(dt_double2_multiply(x, x), dt_double2_multiply(y, y));
}

/* lift(x, y) * (ux vy - vx uy), and *permanent += the same with magnitudes. */
static struct dt_double2 term_2(struct dt_double2 x, struct dt_double2 y, struct dt_double2 ux,
                                struct dt_double2 uy, struct dt_double2 vx, struct dt_double2 vy,
                                double *permanent)
{
    struct dt_double2 lift = lift_2(x, y);
    struct dt_double2 left = dt_double2_multiply(ux, vy), right = dt_double2_multiply(vx, uy);
    *permanent += lift.hi * (fabs(left.hi) + fabs(right.hi));
    return dt_double2_multiply(lift, dt_double2_add(left, dt_double2_negate(right)));
}

/* The sign of the determinant if double words can tell, else 0. */
static int incircle_double2(const struct differences *d)
{
    struct dt_double2 ax = {d->hi[0], d->lo[0]}, ay = {d->hi[3], d->lo[3]};
    struct dt_double2 bx = {d->hi[1], d->lo[1]}, by = {d->hi[4], d->lo[4]};
    struct dt_double2 cx = {d->hi[2], d->lo[2]}, cy = {d->hi[5], d->lo[5]};
    double permanent = 0;
    struct dt_double2 det = term_2(ax, ay, bx, by, cx, cy, &permanent);
    det = dt_double2_add(det, term_2(bx, by, cx, cy, ax, ay, &permanent));
    det = dt_double2_add(det, term_2(cx, cy, ax, ay, bx, by, &permanent));
    return fabs(det.hi) > INCIRCLE_BOUND_2 * permanent ? sign_of(det.hi) : 0;
}

/* A difference as an expansion: zero components left out. */
struct component {
    double e[2];
    int n;
};

/* h[512] = lift(x, y) * (ux vy - vx uy); returns the length. */
static int term(const struct component *x, const struct component *y, const struct component *ux,
                const struct component *uy, const struct component *vx, const struct component *vy,
                double *h)
{
    double xx[8], yy[8], lift[16], cross[16], work[544];
    int nxx = dt_expansion_product(x->n, x->e, x->n, x->e, xx, work);
    int nyy = dt_expansion_product(y->n, y->e, y->n, y->e, yy, work);
    int nl = dt_expansion_sum(nxx, xx, nyy, yy, lift);
    int nc = minor(ux->n, ux->e, uy->n, uy->e, vx->n, vx->e, vy->n, vy->e, cross);
    return dt_expansion_product(nl, lift, nc, cross, h, work);
}

static int incircle_expansion(const struct differences *d)
{
    struct component v[6];
    double a[512], b[512], c[512], ab[1024], abc[1536];
    for (int i = 0; i < 6; i++) {
        v[i].n = dt_expansion_push(0, v[i].e, d->lo[i]);
        v[i].n = dt_expansion_push(v[i].n, v[i].e, d->hi[i]);
    }
    const struct component *ax = v, *bx = v + 1, *cx = v + 2, *ay = v + 3, *by = v + 4, *cy = v + 5;
    int na = term(ax, ay, bx, by, cx, cy, a);
    int nb = term(bx, by, cx, cy, ax, ay, b);
    int nc = term(cx, cy, ax, ay, bx, by, c);
    int nab = dt_expansion_sum(na, a, nb, b, ab);
    return dt_expansion_sign(dt_expansion_sum(nab, ab, nc, c, abc), abc);
}

int dt_incircle_exact(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    if (dt_is_rectangle(a, d, b, c) || dt_is_rectangle(b, d, a, c) || dt_is_rectangle(c, d, a, b))
        return 0;
    struct differences v;
    int64_t integer[6];
    differences_to(a, b, c, d, &v);
    if (to_integers(&v, integer))
        return incircle_integers(integer);
    int sign = incircle_double2(&v);
    return sign != 0 ? sign : incircle_expansion(&v);
}

/* Raising the greatest point's height dominates. Raising d's own lifts it out of the circle;
 * raising that of a corner changes the determinant by that corner's cofactor, which is the
 * orientation of the three others. Those are distinct points of one circle, hence never collinear,
 * so the greatest point decides alone. */
int dt_incircle_tie(struct dt_point a, struct dt_point b, struct dt_point c, struct dt_point d)
{
    struct dt_point greatest = a;
    int corner = 0;
    if (dt_compare_xy(b, greatest) > 0) {
        greatest = b;
        corner = 1;
    }
    if (dt_compare_xy(c, greatest) > 0) {
        greatest = c;
        corner = 2;
    }
    if (dt_compare_xy(d, greatest) > 0)
        return -1;
    return corner == 0   ? dt_orient2d(d, b, c)
           : corner == 1 ? dt_orient2d(a, d, c)
                         : dt_orient2d(a, b, d);
}

/* ---- distances ---- */

/* h[16] = |a - b|^2; returns the length. */
static int squared_distance(struct dt_point a, struct dt_point b, double *h)
{
    double x[2], y[2], xx[8], yy[8], work[12];
    int nx = dt_expansion_difference(a.x, b.x, x), ny = dt_expansion_difference(a.y, b.y, y);
    int nxx = dt_expansion_product(nx, x, nx, x, xx, work);
    int nyy = dt_expansion_product(ny, y, ny, y, yy, work);
    return dt_expansion_sum(nxx, xx, nyy, yy, h);
}

/* The filter of both comparisons: a squared distance takes a difference, a square and a sum, so it
 * is right to a factor of (1 +- u)^4, and a comparison of two is certain beyond 4 u (1 + 10 u)
 * times their sum; 8 u is used. */
static bool far_apart(double da, double db)
{
    return fabs(da - db) > 0x1p-50 * (da + db);
}

static double rounded_distance(struct dt_point a, struct dt_point b)
{
    double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y;
}

int dt_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b)
{
    double da = rounded_distance(a, q), db = rounded_distance(b, q);
    if (far_apart(da, db))
        return da < db ? -1 : 1;
    double ea[16], eb[16], sum[32];
    int na = squared_distance(a, q, ea), nb = squared_distance(b, q, eb);
    dt_expansion_negate(nb, eb);
    return dt_expansion_sign(dt_expansion_sum(na, ea, nb, eb, sum), sum);
}

int dt_compare_radius(struct dt_point a, struct dt_point b, double r)
{
    double d = rounded_distance(a, b), rr = r * r;
    if (far_apart(d, rr))
        return d < rr ? -1 : 1;
    double ed[16], er[2], sum[18];
    int nd = squared_distance(a, b, ed), nr = dt_expansion_scale(r != 0, &r, -r, er);
    return dt_expansion_sign(dt_expansion_sum(nd, ed, nr, er, sum), sum);
}
