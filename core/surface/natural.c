/* natural.c - means of natural neighbours in doubles: the tour of weights.h, which notes the rim, then sums over the rim.
 *
 * Names. v(i) v(i+1) is a rim edge; a = v(i) - q, b = v(i+1) - q, e = v(i+1) - v(i), D = a x e; a' is a turned left. A and B
 * are the angles of the triangle q v(i) v(i+1) at v(i) and v(i+1). Three doubled circumcentres are relative to q: c(T) of a
 * triangle T of the disc, c(i) of the disc's triangle at the rim edge, r(i) of the triangle q v(i) v(i+1).
 *
 *     cot A = -a.e / D,  cot B = b.e / D,  r(i) = a + cot B a'
 *
 * Sibson's mean of the values z, where z0 is the value at v(0):
 *
 * 1. An edge u w between two triangles S and T of the disc adds c(S) x c(T) to the part of u's cell, and takes it from w's.
 * 2. A rim edge adds c(i) x r(i) to the part of v(i)'s cell, and takes it from v(i+1)'s.
 * 3. r(i) x r(i-1) is added to the part of v(i)'s cell.
 * 4. So the mean is
 *
 *     z0 + (sum c(S) x c(T) (z(u) - z(w)) + sum c(i) x r(i) (z(i) - z(i+1)) + sum r(i) x r(i-1) (z(i) - z0))
 *          / sum r(i) x r(i-1).
 *
 * Laplace's mean:
 *
 * 1. The edge between the cells of q and v(i), over the distance of v(i), is half the sum of cot B and of cot A of the rim
 *    edge before.
 * 2. So the mean is
 *
 *     z0 + sum (cot B (z(i) - z0) + cot A (z(i+1) - z0)) / sum (cot A + cot B).
 *
 * Errors:
 *
 * 1. If the shares of the values are off by d(i), their mean is off by sum d(i) (z(i) - mean) / sum of the shares, to first
 *    order. That is at most sum |d(i)| / sum of the shares, times the range of the values.
 * 2. Second-order terms are negligible under the bounds below; the constant factors cover them.
 * 3. The errors of circumcentres, also at rim edges, are bounded below. Let L be a bound of their lengths. A term of two
 *    circumcentres that are off by f and g is off by L (f + g). Each circumcentre is part of three terms.
 * 4. Rounding adds 4 units of DT_U of L^2 for each term. The sums add, for each term, a unit of all terms before it.
 *
 * Laplace's shares, in units of DT_U, for n rim edges. Let S = |b.x e.x| + |b.y e.y|, and F = (|a.x e.y| + |a.y e.x|) / |D|.
 *
 * 1. b.e is off by 4 units of S, and D by 4 units of F |D|. The reciprocal and the product add 2 units.
 * 2. So cot B and cot A are off by (6 + 4 F) S / |D| each.
 * 3. The terms with values are rounded by 4 units more. The sums, two edges side by side, add at most n + 2 units of all terms, and
 *    n + 2 units of the shares.
 * 4. Together that is less than 2 n + 30 units of the S / |D|, and 4.1 units of the F S / |D|. */
#include "core/exact/lanes.h"
#include "core/exact/predicates.h"
#include "core/surface/value.h"

#include <stdlib.h>

enum {
    MOST = 96,      /* triangles of a disc; nearly all have fewer than ten */
    ROOM = MOST + 6 /* rim edges, and two of them again; even */
};

struct crossing {
    uint32_t half;     /* of the disc, to be crossed */
    uint16_t from, to; /* its triangle, and the vertex where it ends, as numbered in the disc */
};

struct vertex {
    struct dt_point at;
    double z;
};

/* Numbered in the order in which they are found. */
struct disc {
    struct vertex vertex[MOST + 2];
    struct dt_point centre[MOST]; /* of triangles */
    uint32_t triangles;
    double sum;    /* over the edges between them */
    double length; /* at least that of the centres */
    double error;  /* of all centres, but for 2.2 units of their lengths */
};

/* Rim edges, and the first ones again after the last. */
struct rim {
    double x[ROOM], y[ROOM], z[ROOM]; /* of v(i) */
    double cx[ROOM], cy[ROOM];        /* c(i) */
    double rx[ROOM], ry[ROOM];        /* r(i - 1) */
    uint32_t edges;
};

/* Sums over the rim, in two lanes. */
struct sums {
    dt_lanes of_values; /* of shares by how far the values are from z0 */
    dt_lanes of_shares;
    dt_lanes flat;        /* of the F of circles */
    dt_lanes length;      /* at least that of the circumcentres */
    dt_lanes size, error; /* Laplace: of the magnitudes of all terms, of their errors */
};

static inline double cross(struct dt_point a, struct dt_point b)
{
    return a.x * b.y - a.y * b.x;
}

/* ---- circumcircles of triangles, which are kept from place to place ----
 *
 * A circle follows from its triangle alone, so it makes no difference which circles are kept. Its centre is computed from a
 * corner with the sides s and t from there, counterclockwise, and e = t - s:
 *
 *     c = s + (t.e / D) s', where s' is s turned left and D = s x e,                doubled and relative to the corner.
 *
 * Errors, in units of DT_U. Let F = |s| |e| / |D| = |c| / |t|.
 *
 * 1. Each coordinate of s, t and e is off by one unit of itself. So D is off by 4 |s| |e|, and t.e by 4 |t| |e|.
 * 2. Their quotient, by a reciprocal and a product, is off by (4 |t| |e| + 4 |t.e / D| |s| |e|) / |D| + 2 |t.e / D|.
 * 3. |s| |t| |e| / |D| = |c| and |t.e / D| |s| <= |c|. So step 2 moves c by at most |c| (6 + 4 F).
 * 4. |s| <= |c|, so the rest of the formula moves c by at most 4 |c|.
 * 5. The factors below are a little larger: they cover second-order terms and the rounding of the bounds.
 *
 * F is small if t is long, so t is the longest side of the triangle. |x| + |y|, which is not less, replaces the length of a
 * vector. */

/* The largest error of a computed centre, over its length, for F as above. */
#define CENTRE_ERROR(f) (DT_U * (10.2 + 4.1 * (f)))

struct dt_circle {
    uint32_t triangle;      /* its first half edge; DT_NONE: nothing is kept here */
    struct dt_point corner; /* a corner */
    struct dt_point centre; /* doubled, relative to the corner */
    double inside,
        outside;  /* the square of a distance below, above which a place is certainly there */
    double error; /* of the centre from a place, but for 2.2 units of its length there */
};

enum dt_status dt_natural_keep(struct dt_valuer *v, size_t n)
{
    enum { LEAST = 64, MOST_KEPT = 1 << 13 }; /* half a megabyte */
    uint32_t circles = LEAST;
    while (circles < MOST_KEPT && circles < n)
        circles *= 2;
    v->circle = malloc(circles * sizeof *v->circle);
    v->circle_mask = circles - 1;
    if (v->circle == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < circles; i++)
        v->circle[i].triangle = DT_NONE;
    return DT_OK;
}

/* Whether side i of a triangle is longer than side j, or as long and ends at a lesser corner; side i ends at corner i. */
static bool is_longer(const struct dt_point p[3], const double square[3], uint32_t i, uint32_t j)
{
    return square[i] > square[j] || (square[i] == square[j] && dt_compare_xy(p[i], p[j]) < 0);
}

/* The corner at which the longest side ends, counterclockwise. */
static uint32_t first_corner(const struct dt_point p[3])
{
    double square[3];
    for (uint32_t i = 0, before = 2; i < 3; before = i++) {
        double x = p[i].x - p[before].x, y = p[i].y - p[before].y;
        square[i] = x * x + y * y;
    }
    bool last = (square[2] > square[0]) & (square[2] > square[1]);
    bool middle = (square[1] > square[0]) & (square[1] > square[2]);
    bool first = (square[0] > square[1]) & (square[0] > square[2]);
    if (first | middle | last) /* a branch on which one it is would be unpredictable */
        return (uint32_t)middle | (uint32_t)last << 1;
    uint32_t longest = is_longer(p, square, 1, 0) ? 1 : 0;
    return is_longer(p, square, 2, longest) ? 2 : longest;
}

/* The largest difference that rounding can cause between the squared distances of a place and of a corner from a centre of
 * this length and error, if both are equally far.
 *
 * 1. The place sees the centre at c, which is off by `error` and by 3 units of the length (circle_from).
 * 2. So the two lengths differ by at most 2 `error` + 3 units.
 * 3. A square differs by twice the length times that, and is rounded by 2 units of itself.
 * 4. If the place is nearer or farther, the errors change by less than the difference of the lengths. So a difference
 *    beyond the bound has the right sign. */
static double doubt(double length, double error)
{
    return 2.1 * length * (2 * error + 9 * DT_U * length);
}

/* A ghost has a circle without inside. */
static void circle_make(struct dt_circle *k, const struct dt *t, uint32_t triangle)
{
    const uint32_t *v = t->mesh.half + triangle;
    *k = (struct dt_circle){.triangle = triangle, .inside = -1, .outside = -1};
    if (v[2] == DT_NONE)
        return;
    struct dt_point p[3] = {t->points.xy[v[0]], t->points.xy[v[1]], t->points.xy[v[2]]};
    uint32_t i = first_corner(p), j = i == 2 ? 0 : i + 1, last = j == 2 ? 0 : j + 1;
    double sx = p[j].x - p[i].x, sy = p[j].y - p[i].y;
    double tx = p[last].x - p[i].x, ty = p[last].y - p[i].y;
    double ex = p[last].x - p[j].x, ey = p[last].y - p[j].y;
    double left = sx * ey, right = sy * ex, inverse = 1 / (left - right);
    double turn = (tx * ex + ty * ey) * inverse;
    struct dt_point c = {sx - turn * sy, sy + turn * sx};
    double length = fabs(c.x) + fabs(c.y), flat = (fabs(left) + fabs(right)) * fabs(inverse);
    double error = flat * DT_U < 0x1p-10 ? CENTRE_ERROR(flat) * length : HUGE_VAL;
    double square = c.x * c.x + c.y * c.y;
    k->corner = p[i];
    k->centre = c;
    k->inside = square - doubt(length, error);
    k->outside = square + doubt(length, error);
    k->error = error + 1.1 * DT_U * length;
}

/* The doubled centre relative to q. */
static inline struct dt_point circle_from(const struct dt_circle *k, struct dt_point q)
{
    return (struct dt_point){k->centre.x + 2 * (k->corner.x - q.x),
                             k->centre.y + 2 * (k->corner.y - q.y)};
}

/* Whether q is strictly inside the circle of a triangle, whose centre relative to q is c. Exact. */
static inline bool circle_contains(const struct dt_circle *k, const struct dt *t, struct dt_point q,
                                   struct dt_point c)
{
    double square = c.x * c.x + c.y * c.y;
    if (square < k->inside)
        return true;
    if (square > k->outside)
        return false;
    const uint32_t *v = t->mesh.half + k->triangle;
    return dt_incircle(t->points.xy[v[0]], t->points.xy[v[1]], t->points.xy[v[2]], q) > 0;
}

/* ---- the tour ---- */

static inline const struct dt_circle *circle_of(struct dt_valuer *v, uint32_t triangle)
{
    struct dt_circle *k = &v->circle[triangle >> 3 & v->circle_mask];
    const uint32_t *corner = v->t->mesh.half + triangle;
    if (k->triangle != triangle) {
        if (dt_fetch_at_triangle(v, triangle))
            for (uint32_t i = 0; i < 3 && corner[i] != DT_NONE; i++)
                dt_fetch_at_vertex(v, corner[i]);
        circle_make(k, v->t, triangle);
    }
    return k;
}

/* Whether q is inside of the circle of the triangle. *centre becomes its centre relative to q, which only Sibson's mean
 * needs, and *error the error of the circle. If no circles are kept, most circles are not made. */
static inline __attribute__((always_inline)) bool is_in_disc(struct dt_valuer *v, uint32_t triangle,
                                                             struct dt_point q, bool sibson,
                                                             struct dt_point *centre, double *error)
{
    const struct dt_point *xy = v->t->points.xy;
    const uint32_t *corner = v->t->mesh.half + triangle;
    struct dt_circle once;
    const struct dt_circle *k = &once;
    if (v->circle != NULL)
        k = circle_of(v, triangle);
    else if (corner[2] == DT_NONE ||
             dt_incircle(xy[corner[0]], xy[corner[1]], xy[corner[2]], q) <= 0)
        return false;
    else if (sibson)
        circle_make(&once, v->t, triangle);
    else
        return true;
    *centre = circle_from(k, q);
    *error = k->error;
    return k == &once || circle_contains(k, v->t, q, *centre);
}

static inline struct vertex vertex_at(const struct dt_valuer *v, uint32_t vertex)
{
    return (struct vertex){v->t->points.xy[vertex], dt_value_of(v, vertex)};
}

static inline void add_centre(struct disc *d, struct dt_point c, double error)
{
    double length = fabs(c.x) + fabs(c.y);
    d->length = length > d->length ? length : d->length;
    d->error += error;
    d->centre[d->triangles++] = c;
}

static inline void add_edge(struct rim *r, const struct vertex *v, const struct dt_point *c)
{
    uint32_t i = r->edges++;
    r->x[i] = v->at.x;
    r->y[i] = v->at.y;
    r->z[i] = v->z;
    r->cx[i] = c->x;
    r->cy[i] = c->y;
}

/* False: there are too many triangles. */
static inline bool tour(struct dt_valuer *v, struct dt_point q, uint32_t first, bool sibson,
                        struct disc *d, struct rim *r)
{
    const struct dt_mesh *mesh = &v->t->mesh;
    struct dt_point centre = {0, 0};
    double error = 0;
    struct crossing todo[MOST + 3];
    todo[0] = (struct crossing){dt_prev(first), 0, 0};
    todo[1] = (struct crossing){dt_next(first), 0, 2};
    todo[2] = (struct crossing){first, 0, 1};
    uint32_t left = 3, here = 0;
    d->vertex[0] = vertex_at(v, dt_origin(mesh, first));
    d->vertex[1] = vertex_at(v, dt_dest(mesh, first));
    d->vertex[2] = vertex_at(v, dt_apex_of(mesh, first));
    d->triangles = r->edges = 0;
    d->sum = d->length = d->error = 0;
    is_in_disc(v, dt_base(first), q, sibson, &centre, &error);
    add_centre(d, centre, error);
    while (left > 0) {
        struct crossing c = todo[--left];
        uint32_t beyond = dt_twin(mesh, c.half);
        if (!is_in_disc(v, dt_base(beyond), q, sibson, &centre, &error)) {
            add_edge(r, &d->vertex[here], &d->centre[c.from]);
            here = c.to;
            continue;
        }
        uint16_t inside = (uint16_t)d->triangles, apex = (uint16_t)(inside + 2);
        if (inside == MOST)
            return false;
        d->vertex[apex] = vertex_at(v, dt_apex_of(mesh, beyond));
        if (sibson)
            d->sum += cross(d->centre[c.from], centre) * (d->vertex[here].z - d->vertex[c.to].z);
        add_centre(d, centre, error);
        todo[left++] = (struct crossing){dt_prev(beyond), inside, c.to};
        todo[left++] = (struct crossing){dt_next(beyond), inside, apex};
    }
    for (uint32_t i = 0; i < 2; i++)
        add_edge(r, &(struct vertex){{r->x[i], r->y[i]}, r->z[i]},
                 &(struct dt_point){r->cx[i], r->cy[i]});
    r->edges -= 2;
    return true;
}

/* ---- sums over the rim ---- */

/* Both lanes count for the rim edges i and i + 1, or only the first one if i is the last rim edge. */
static inline dt_lanes counting(const struct rim *r, uint32_t i)
{
    return (dt_lanes){1, i + 1 < r->edges ? 1 : 0};
}

static inline void add_sibson(struct sums *s, struct rim *r, uint32_t i, dt_lanes ax, dt_lanes ay,
                              dt_lanes turn)
{
    dt_lanes cx = dt_lanes_load(r->cx + i), cy = dt_lanes_load(r->cy + i);
    dt_lanes z = dt_lanes_load(r->z + i), next = dt_lanes_load(r->z + i + 1);
    dt_lanes x = ax - turn * ay, y = ay + turn * ax;
    dt_lanes_store(r->rx + i + 1, x);
    dt_lanes_store(r->ry + i + 1, y);
    s->length = dt_lanes_most(s->length, dt_lanes_abs(x) + dt_lanes_abs(y));
    s->of_values += (cx * y - cy * x) * ((z - next) * counting(r, i));
}

/* The rim edges i and i + 1. */
static inline void add_edges(struct sums *s, struct rim *r, uint32_t i, struct dt_point q,
                             bool sibson)
{
    dt_lanes px = dt_lanes_load(r->x + i), py = dt_lanes_load(r->y + i);
    dt_lanes nx = dt_lanes_load(r->x + i + 1), ny = dt_lanes_load(r->y + i + 1);
    dt_lanes qx = dt_lanes_both(q.x), qy = dt_lanes_both(q.y);
    dt_lanes ax = px - qx, ay = py - qy, bx = nx - qx, by = ny - qy, ex = nx - px, ey = ny - py;
    dt_lanes left = ax * ey, right = ay * ex;
    dt_lanes inverse = dt_lanes_both(1) / (left - right), size = dt_lanes_abs(inverse);
    dt_lanes flat = (dt_lanes_abs(left) + dt_lanes_abs(right)) * size;
    dt_lanes bex = bx * ex, bey = by * ey, turn = (bex + bey) * inverse;
    if (sibson) {
        s->flat += flat;
        add_sibson(s, r, i, ax, ay, turn);
        return;
    }
    dt_lanes z = dt_lanes_load(r->z + i), next = dt_lanes_load(r->z + i + 1);
    dt_lanes aex = ax * ex, aey = ay * ey, other = (aex + aey) * inverse;
    dt_lanes z0 = dt_lanes_both(r->z[0]), counts = counting(r, i);
    size *= (dt_lanes_abs(aex) + dt_lanes_abs(aey)) + (dt_lanes_abs(bex) + dt_lanes_abs(bey));
    s->size += size;
    s->error += size * flat;
    s->of_shares += (turn - other) * counts;
    s->of_values += (turn * (z - z0) - other * (next - z0)) * counts;
}

/* The sums of r(i) x r(i-1). */
static inline void add_shares(struct sums *s, struct rim *r)
{
    dt_lanes z0 = dt_lanes_both(r->z[0]);
    r->rx[0] = r->rx[r->edges];
    r->ry[0] = r->ry[r->edges];
    for (uint32_t i = 0; i < r->edges; i += 2) {
        dt_lanes share = dt_lanes_load(r->rx + i + 1) * dt_lanes_load(r->ry + i) -
                         dt_lanes_load(r->ry + i + 1) * dt_lanes_load(r->rx + i);
        share *= counting(r, i);
        s->of_shares += share;
        s->of_values += share * (dt_lanes_load(r->z + i) - z0);
    }
}

static inline double total(dt_lanes a)
{
    return a[0] + a[1];
}

/* A bound of the sum of the shares' errors. */
static inline double error_of(const struct disc *d, const struct rim *r, const struct sums *s,
                              bool sibson)
{
    double n = r->edges;
    if (!sibson)
        return DT_U * ((2 * n + 30) * total(s->size) + 4.1 * total(s->error));
    double terms = d->triangles + 2 * n;
    double length = s->length[0] > s->length[1] ? s->length[0] : s->length[1];
    length = length > d->length ? length : d->length;
    double rim = CENTRE_ERROR(0) * (n + 1) + 4.1 * DT_U * total(s->flat);
    double centres = d->error + length * (rim + 2.2 * DT_U * d->triangles);
    return length * (3.1 * centres + DT_U * length * terms * (terms + 8));
}

/* ---- the mean ---- */

/* z0 + sum / whole, unless there is no mean in doubles: terms of the sum may overflow, or be so small that they lose bits. */
static bool make_mean(const struct disc *d, double sum, double whole, double *out)
{
    double z0 = d->vertex[0].z, least = z0, most = z0;
    bool missing = false;
    for (uint32_t i = 0; i < d->triangles + 2; i++) {
        double z = d->vertex[i].z;
        least = z < least ? z : least;
        most = z > most ? z : most;
        missing |= z != z;
    }
    double mean = z0 + sum / whole, range = most - least;
    *out = mean < least ? least : mean > most ? most : mean;
    if (missing)
        *out = (double)NAN;
    return missing || (isfinite(mean) && (range == 0 || fabs(whole) * range > 0x1p-900));
}

static inline bool mean_of(struct dt_valuer *v, struct dt_point q, uint32_t first, bool sibson,
                           double *out)
{
    struct disc d;
    struct rim r;
    struct sums s = {0};
    if (!tour(v, q, first, sibson, &d, &r))
        return false;
    for (uint32_t i = 0; i < r.edges; i += 2)
        add_edges(&s, &r, i, q, sibson);
    if (sibson)
        add_shares(&s, &r);
    double whole = total(s.of_shares);
    if (!(error_of(&d, &r, &s, sibson) < 0.9 * DT_WEIGHTS_ERROR * fabs(whole)))
        return false;
    return make_mean(&d, d.sum + total(s.of_values), whole, out);
}

bool dt_natural_mean(struct dt_valuer *v, struct dt_point q, uint32_t first, double *out)
{
    return v->s->how == DT_NATURAL ? mean_of(v, q, first, true, out)
                                   : mean_of(v, q, first, false, out);
}
