/* predicates.c - the stages behind the inline filters of predicates.h.
 *
 * Each predicate tries cheaper methods before it computes the polynomial as a bignum:
 *
 *     filter (inline)            decides all but one call in 10^4 on random points
 *     axis-parallel rectangle    incircle: exactly zero; most ties on lattices
 *     256-bit integers           incircle: differences on a common grid, 55 bits
 *     double words               about 100 bits, from a near base: nearly all that is not a tie
 *     bignums                    exact whatever the input
 *
 * The near base. A determinant is the same, up to its sign, from any base point, but rounding errors of a
 * difference to a far point cannot be recovered.
 *
 *     orient2d  =  (q - p) x (s - p)
 *     incircle  =  dt(q) cr(t) - dt(t) cr(q)                                         (see sight.h)
 *     cr(v)  =  (s - p) x (v - p)  =  (s - p) x (v - s)
 *     dt(v)  =  (v - p) . (v - s)
 *
 * Here p and q are the two points closest to each other, s and t the others. cr takes the smaller one of
 * v - p and v - s:
 *
 *      q                     t
 *       p - - - - - - - - - s
 *
 * 1. Let d be the distance of p and q, and e the distance of t to the nearer one of p and s.
 * 2. Each term has the order of magnitude of d e |s - p| max(|t - p|, |t - s|). So no two large values that
 *    nearly cancel are subtracted.
 * 3. The inline filters may use a base far away from the other points. Then all differences are large, and
 *    terms are larger by up to the square of that ratio: double words soon lack that precision.
 *
 * bounds.h has the error bounds of doubles and double words, and the proof that no value overflows or
 * underflows. */
#include "core/exact/predicates.h"

#include <string.h>

#include "core/delaunay_constraints.h"
#include "core/exact/box.h"
#include "core/exact/vectors.h"

#ifdef __FAST_MATH__
#error "the predicates need IEEE arithmetic: compile without -ffast-math"
#endif

/* Another base is worth its cost if the least distance is below NEAR times the greatest one: it wins a few bits. */
#define NEAR 0x1p-5

static int sign_of(double v)
{
    return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/* The distance of a and b, to an order of magnitude. */
static double spread(struct dt_point a, struct dt_point b)
{
    return fabs(a.x - b.x) + fabs(a.y - b.y);
}

/* ---- orient2d ---- */

struct dt_near_corner dt_near_corner_of(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double ab = spread(a, b), bc = spread(b, c), ca = spread(c, a);
    if (ab <= bc && ab <= ca)
        return (struct dt_near_corner){a, b, c};
    return bc <= ca ? (struct dt_near_corner){b, c, a} : (struct dt_near_corner){c, a, b};
}

int dt_orient2d_double2(const struct dt_near_corner *k)
{
    struct dt_bounded2 det = dt_vector2_cross(dt_vector2_of(k->p, k->q), dt_vector2_of(k->p, k->s));
    return fabs(det.value.hi) > DT_ORIENT_BOUND_2 * det.size ? sign_of(det.value.hi) : 0;
}

int dt_orient2d_big(const struct dt_near_corner *k)
{
    struct dt_big_vector q = dt_big_vector_of(k->p, k->q), s = dt_big_vector_of(k->p, k->s);
    return dt_big_cross(&q, &s).sign;
}

/* If all differences are exact, two products decide: rounding is monotone. False: some are not. */
static bool orient2d_two_products(const struct dt_near_corner *k, int *sign)
{
    struct dt_vector2 q = dt_vector2_of(k->p, k->q), s = dt_vector2_of(k->p, k->s);
    double left, left_tail, right, right_tail;
    if (q.x.lo != 0 || q.y.lo != 0 || s.x.lo != 0 || s.y.lo != 0)
        return false;
    dt_two_product(q.x.hi, s.y.hi, &left, &left_tail);
    dt_two_product(q.y.hi, s.x.hi, &right, &right_tail);
    *sign = sign_of(left != right ? left - right : left_tail - right_tail);
    return true;
}

int dt_orient2d_exact(struct dt_point a, struct dt_point b, struct dt_point c)
{
    if ((a.x == c.x || b.y == c.y) && (a.y == c.y || b.x == c.x))
        return 0; /* as both products are: the usual case on lattices */
    struct dt_near_corner k = dt_near_corner_of(a, b, c);
    int sign;
    if (orient2d_two_products(&k, &sign) || (sign = dt_orient2d_double2(&k)) != 0)
        return sign;
    return dt_orient2d_big(&k);
}

/* ---- incircle: integers ---- */

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

/* ---- incircle: from a near base ---- */

/* The pairs of four points: p and q, and the two others, s and t. The sign is that of the permutation p, s, q, t, the order
 * of base and candidates. */
static const struct {
    unsigned char p, q, s, t;
    signed char sign;
} pairs[6] = {{0, 1, 2, 3, -1}, {0, 2, 1, 3, 1}, {0, 3, 1, 2, -1},
              {1, 2, 0, 3, -1}, {1, 3, 0, 2, 1}, {2, 3, 0, 1, -1}};

struct dt_near_base dt_near_base_of(struct dt_point a, struct dt_point b, struct dt_point c,
                                    struct dt_point d)
{
    const struct dt_point v[4] = {a, b, c, d};
    double far[6] = {spread(a, b), spread(a, c), spread(a, d),
                     spread(b, c), spread(b, d), spread(c, d)};
    double least = far[0], most = far[0];
    for (int i = 1; i < 6; i++) {
        least = far[i] < least ? far[i] : least;
        most = far[i] > most ? far[i] : most;
    }
    if (least >= NEAR * most) /* any base will do */
        return (struct dt_near_base){a, c, b, d, .nearer = a, .sign = 1};
    int i = 0;
    while (far[i] != least)
        i++;
    struct dt_near_base k = {v[pairs[i].p], v[pairs[i].q], v[pairs[i].s], v[pairs[i].t],
                             .sign = pairs[i].sign};
    k.nearer = spread(k.t, k.p) <= spread(k.t, k.s) ? k.p : k.s;
    return k;
}

int dt_incircle_double2(const struct dt_near_base *k)
{
    struct dt_vector2 base = dt_vector2_of(k->p, k->s), q = dt_vector2_of(k->p, k->q);
    struct dt_bounded2 cr_q = dt_vector2_cross(base, q),
                       cr_t = dt_vector2_cross(base, dt_vector2_of(k->nearer, k->t));
    struct dt_bounded2 dt_q = dt_vector2_dot(q, dt_vector2_of(k->s, k->q));
    struct dt_bounded2 dt_t = dt_vector2_dot(dt_vector2_of(k->p, k->t), dt_vector2_of(k->s, k->t));
    struct dt_double2 left = dt_double2_multiply(dt_q.value, cr_t.value);
    struct dt_double2 right = dt_double2_multiply(dt_t.value, cr_q.value);
    struct dt_double2 det = dt_double2_subtract(left, right);
    double size = dt_q.size * cr_t.size + dt_t.size * cr_q.size;
    return fabs(det.hi) > DT_INCIRCLE_BOUND_2 * size ? k->sign * sign_of(det.hi) : 0;
}

int dt_incircle_big(const struct dt_near_base *k)
{
    struct dt_big_vector base = dt_big_vector_of(k->p, k->s),
                         nearer_t = dt_big_vector_of(k->nearer, k->t),
                         pq = dt_big_vector_of(k->p, k->q), pt = dt_big_vector_of(k->p, k->t),
                         sq = dt_big_vector_of(k->s, k->q), st = dt_big_vector_of(k->s, k->t);
    struct dt_big cr_q = dt_big_cross(&base, &pq), cr_t = dt_big_cross(&base, &nearer_t);
    struct dt_big dt_q = dt_big_dot(&pq, &sq), dt_t = dt_big_dot(&pt, &st);
    return k->sign * dt_big_compare(dt_big_multiply(dt_q, cr_t), dt_big_multiply(dt_t, cr_q));
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
    struct dt_near_base k = dt_near_base_of(a, b, c, d);
    int sign = dt_incircle_double2(&k);
    return sign != 0 ? sign : dt_incircle_big(&k);
}

/* 1. The raised height of the greatest point dominates.
 * 2. If d is the greatest, raising it lifts it out of the circle.
 * 3. If a corner is the greatest, the determinant changes by its cofactor: the orientation of the three other points.
 * 4. Three distinct points of one circle are never collinear, so the greatest point decides alone. */
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

/* ---- boxes ---- */

/* No axis and not the segment's normal separates them. */
bool dt_segment_meets_box(struct dt_point a, struct dt_point b, struct dt_point lo,
                          struct dt_point hi)
{
    const struct dt_box box = {lo, hi}, around = dt_box_of((const struct dt_point[]){a, b}, 2);
    if (dt_box_contains(&box, a) || dt_box_contains(&box, b))
        return true;
    if (!dt_box_overlaps(&around, &box))
        return false;
    bool rising = (a.x < b.x) == (a.y < b.y);
    struct dt_point left = {lo.x, rising ? hi.y : lo.y}, right = {hi.x, rising ? lo.y : hi.y};
    return dt_orient2d(a, b, left) * dt_orient2d(a, b, right) <= 0;
}

/* ---- distances ---- */

static struct dt_big square_distance_big(struct dt_point a, struct dt_point b)
{
    struct dt_big_vector v = dt_big_vector_of(a, b);
    return dt_big_dot(&v, &v);
}

int dt_compare_distance(struct dt_point q, struct dt_point a, struct dt_point b)
{
    double da = dt_square_distance(a, q), db = dt_square_distance(b, q);
    if (dt_squares_decide(da, db))
        return da < db ? -1 : 1;
    return dt_big_compare(square_distance_big(q, a), square_distance_big(q, b));
}

int dt_compare_radius(struct dt_point a, struct dt_point b, double r)
{
    double d = dt_square_distance(a, b), rr = r * r;
    if (dt_squares_decide(d, rr))
        return d < rr ? -1 : 1;
    struct dt_big exact_r = dt_big_of(r);
    return dt_big_compare(square_distance_big(a, b), dt_big_multiply(exact_r, exact_r));
}

int dt_dot_exact(struct dt_point o, struct dt_point a, struct dt_point b)
{
    struct dt_big_vector to_a = dt_big_vector_of(o, a), to_b = dt_big_vector_of(o, b);
    return dt_big_dot(&to_a, &to_b).sign;
}

/* ---- circumradii: (|ab| |bc| |ca|)^2 beside (2 r)^2 D^2 ---- */

static int compare_circumradius_big(struct dt_point a, struct dt_point b, struct dt_point c,
                                    double r)
{
    struct dt_big sides = dt_big_multiply(square_distance_big(a, b), square_distance_big(b, c));
    struct dt_big_vector to_b = dt_big_vector_of(a, b), to_c = dt_big_vector_of(a, c);
    struct dt_big other = dt_big_multiply(dt_big_cross(&to_b, &to_c), dt_big_of(2 * r));
    sides = dt_big_multiply(sides, square_distance_big(c, a));
    return dt_big_compare(sides, dt_big_multiply(other, other));
}

int dt_compare_circumradius(struct dt_point a, struct dt_point b, struct dt_point c, double r)
{
    double size, area = fabs(dt_orient2d_rounded(a, b, c, &size));
    double sides =
        sqrt(dt_square_distance(a, b) * dt_square_distance(b, c)) * sqrt(dt_square_distance(c, a));
    double difference = sides - 2 * r * area;
    if (fabs(difference) > DT_SIDES_BOUND * sides + DT_CIRCUMRADIUS_BOUND * (2 * r * size))
        return difference < 0 ? -1 : 1;
    return compare_circumradius_big(a, b, c, r);
}
