/* smooth.c - values of the smooth surface: cubic in each third of a triangle, with continuous slopes.
 *
 * The slopes g at a point p minimise the sum of w (g . d - z)^2 over its neighbours that have values. Here d is the place of a
 * neighbour and z its value, both relative to p, and the weight w is 1 / |d|^2. So with x = d.x, y = d.y the equations are
 *
 *     a g.x + b g.y = r     a = sum w x x, b = sum w x y, c = sum w y y
 *     b g.x + c g.y = s     r = sum w x z, s = sum w y z
 *
 * a + c is the number of neighbours, and the determinant measures how far they are from one line. A linear function has its own
 * slopes.
 *
 * The patch is the one of Clough and Tocher [1965] in Bernstein-Bezier form [Farin, "Triangular Bernstein-Bezier patches", CAGD 3,
 * 1986, section 7]. Its slope across a side is linear along the side, so two patches that share a side have the same slopes
 * there:
 * 1. Let h be the place of the centre's foot on the side from i to j, as a share of the side. Across the side, in the direction from
 *    the foot to the centre, the slope has three ordinates q0, q1, q2.
 * 2. q1 is their middle if the ordinate beside the side is
 *        middle = (spoke[i] + spoke[j]) / 2 + ((1 - h)(p - m) + h (m - r)) / 2
 *    with the three differences p, m, r of neighbouring ordinates along the side. */
#include "core/surface/value.h"

#include "core/mesh/mesh.h"

#include <math.h>
#include <stdlib.h>

/* Slopes at a point. */
struct slopes {
    double x, y;
};

/* The surface over a triangle, less the value of corner 0, as Bernstein-Bezier ordinates. Corners are counterclockwise from the
 * smallest id; the centre is their mean:
 *
 *                  2            corner   at a corner
 *                 /|\           side     on a side, a third of the way from corner i: [i][0] to the corner after it, [i][1] before it
 *                / | \          spoke    a third of the way from corner i to the centre
 *               / .c. \         inner    two thirds of that way
 *              /.     .\        middle   beside the side opposite to corner i
 *             0 ------- 1       centre   at the centre */
struct patch {
    uint32_t base; /* its triangle; DT_NONE: none yet */
    double first;  /* the value of corner 0; nan if a corner has none */
    double corner[3], side[3][2], spoke[3], inner[3], middle[3], centre;
    struct dt_point at, to[2]; /* corner 0, and the others relative to it */
    double area;               /* twice the area, rounded */
    bool fat;                  /* weights in doubles are exact enough */
};

struct kept {
    uint32_t vertex;
    struct slopes slopes;
};

struct dt_smoother {
    struct dt_smoother *next; /* in the ring: of the next surface */
    struct patch patch;       /* of the last triangle */
    uint32_t mask;
    struct kept kept[]; /* mask + 1; a point has one place among them */
};

static struct dt_smoother *new_smoother(uint32_t points)
{
    struct dt_smoother *s = malloc(sizeof *s + points * sizeof *s->kept);
    if (s == NULL)
        return NULL;
    s->next = s;
    s->mask = points - 1;
    s->patch.base = DT_NONE;
    for (uint32_t i = 0; i < points; i++)
        s->kept[i].vertex = DT_NONE;
    return s;
}

struct dt_smoother *dt_smoothers_new(uint32_t points, uint32_t n)
{
    struct dt_smoother *first = new_smoother(points);
    for (uint32_t i = 1; first != NULL && i < n; i++) {
        struct dt_smoother *s = new_smoother(points);
        if (s == NULL) {
            dt_smoothers_free(first);
            return NULL;
        }
        s->next = first->next;
        first->next = s;
    }
    return first;
}

void dt_smoothers_free(struct dt_smoother *s)
{
    struct dt_smoother *at = s;
    while (at != NULL) {
        struct dt_smoother *next = at->next != s ? at->next : NULL;
        free(at);
        at = next;
    }
}

struct dt_smoother *dt_smoother_next(const struct dt_smoother *s)
{
    return s->next;
}

/* ---- slopes ---- */

/* The half edge from the vertex to its neighbour of the smallest id, where the sums begin. */
static uint32_t first_neighbour(const struct dt *t, uint32_t vertex)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t begin = m->leaving[vertex], best = DT_NONE, least = DT_NONE, h = begin;
    do {
        uint32_t u = dt_dest(m, h);
        if (u != DT_NONE && t->points.id[u] < least) {
            least = t->points.id[u];
            best = h;
        }
        h = dt_turn_ccw(m, h);
    } while (h != begin);
    return best;
}

/* Of the normal equations. */
struct sums {
    double a, b, c, r, s;
};

static void add(struct sums *n, struct dt_point d, double z)
{
    double weight = 1 / (d.x * d.x + d.y * d.y), x = weight * d.x, y = weight * d.y;
    n->a += x * d.x;
    n->b += x * d.y;
    n->c += y * d.y;
    n->r += x * z;
    n->s += y * z;
}

/* Neighbours that are nearly on one line do not show the slope across the line, which becomes 0. */
static struct slopes solve(const struct sums *n)
{
    double whole = n->a + n->c, det = n->a * n->c - n->b * n->b;
    if (whole == 0)
        return (struct slopes){0, 0};
    if (det <= DT_SMOOTH_FLAT * (whole * whole))
        return (struct slopes){n->r / whole, n->s / whole};
    return (struct slopes){(n->c * n->r - n->b * n->s) / det, (n->a * n->s - n->b * n->r) / det};
}

static enum dt_status find_slopes(struct dt_valuer *v, uint32_t vertex, struct slopes *out)
{
    const struct dt *t = v->t;
    const struct dt_point p = t->points.xy[vertex];
    double z0 = dt_value_of(v, vertex);
    uint32_t begin = first_neighbour(t, vertex), h = begin, steps = 0;
    struct sums n = {0};
    do {
        uint32_t u = dt_dest(&t->mesh, h);
        double z = u == DT_NONE ? (double)NAN : dt_value_of(v, u);
        if (!isnan(z))
            add(&n, (struct dt_point){t->points.xy[u].x - p.x, t->points.xy[u].y - p.y}, z - z0);
        h = dt_turn_ccw(&t->mesh, h);
        enum dt_status s = (++steps & DT_WORK_MASK) == 0 ? dt_work(&v->work, DT_WORK_BLOCK) : DT_OK;
        if (s != DT_OK)
            return s;
    } while (h != begin);
    *out = solve(&n);
    return DT_OK;
}

static enum dt_status slopes_at(struct dt_valuer *v, uint32_t vertex, struct slopes *out)
{
    struct kept *k = &v->smoother->kept[vertex & v->smoother->mask];
    enum dt_status s = DT_OK;
    if (k->vertex != vertex) {
        k->vertex = DT_NONE;
        s = find_slopes(v, vertex, &k->slopes);
    }
    if (s == DT_OK) {
        k->vertex = vertex;
        *out = k->slopes;
    }
    return s;
}

/* ---- patches ---- */

/* A third of the rise from a to b by the slopes at a. */
static double third(struct slopes g, struct dt_point a, struct dt_point b)
{
    return (g.x * (b.x - a.x) + g.y * (b.y - a.y)) / 3;
}

/* The place of the foot of the mean of a, b and c on the side from a to b: 0 at a, 1 at b. */
static double foot_of_centre(struct dt_point a, struct dt_point b, struct dt_point c)
{
    double x = b.x - a.x, y = b.y - a.y;
    return (1 + ((c.x - a.x) * x + (c.y - a.y) * y) / (x * x + y * y)) / 3;
}

static double middle_of(const struct patch *p, uint32_t i, uint32_t j, double h)
{
    double first = p->side[i][0] - p->corner[i], last = p->corner[j] - p->side[j][1];
    double between = p->side[j][1] - p->side[i][0];
    return (p->spoke[i] + p->spoke[j]) / 2 +
           ((1 - h) * (first - between) + h * (between - last)) / 2;
}

static void fill(struct patch *p, const struct dt_point at[3], const struct slopes g[3])
{
    static const uint32_t next[] = {1, 2, 0}, before[] = {2, 0, 1};
    for (uint32_t i = 0; i < 3; i++) {
        double on = third(g[i], at[i], at[next[i]]), back = third(g[i], at[i], at[before[i]]);
        p->side[i][0] = p->corner[i] + on;
        p->side[i][1] = p->corner[i] + back;
        p->spoke[i] = p->corner[i] + (on + back) / 3;
    }
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t i = next[k], j = before[k];
        p->middle[k] = middle_of(p, i, j, foot_of_centre(at[i], at[j], at[k]));
    }
    for (uint32_t i = 0; i < 3; i++)
        p->inner[i] = (p->spoke[i] + p->middle[next[i]] + p->middle[before[i]]) / 3;
    p->centre = (p->inner[0] + p->inner[1] + p->inner[2]) / 3;
}

/* Weights in doubles err by less than 6 u of the square of the longer side from corner 0, over the area. */
static void measure(struct patch *p, const struct dt_point at[3])
{
    const double flat = 128;
    struct dt_point b = {at[1].x - at[0].x, at[1].y - at[0].y};
    struct dt_point c = {at[2].x - at[0].x, at[2].y - at[0].y};
    p->at = at[0];
    p->to[0] = b;
    p->to[1] = c;
    p->area = b.x * c.y - b.y * c.x;
    p->fat = fmax(b.x * b.x + b.y * b.y, c.x * c.x + c.y * c.y) < flat * p->area;
}

/* Makes the patch of the triangle of the half edge. */
static enum dt_status make_patch(struct dt_valuer *v, uint32_t half)
{
    const struct dt_mesh *m = &v->t->mesh;
    struct patch *p = &v->smoother->patch;
    struct dt_point at[3];
    struct slopes g[3];
    double z[3];
    enum dt_status s = DT_OK;
    p->base = DT_NONE;
    half = dt_weigh_start(v->t, DT_INSIDE, half);
    for (uint32_t i = 0, h = half; i < 3; i++, h = dt_next(h)) {
        at[i] = v->t->points.xy[dt_origin(m, h)];
        z[i] = dt_value_of(v, dt_origin(m, h));
        p->corner[i] = z[i] - z[0];
    }
    p->first = isnan(z[1]) || isnan(z[2]) ? (double)NAN : z[0];
    for (uint32_t i = 0, h = half; i < 3 && s == DT_OK && !isnan(p->first); i++, h = dt_next(h))
        s = slopes_at(v, dt_origin(m, h), &g[i]);
    if (s != DT_OK)
        return s;
    if (!isnan(p->first))
        fill(p, at, g);
    measure(p, at);
    p->base = dt_base(half);
    return DT_OK;
}

/* The cubic over the third opposite to corner k, between corners i and j: u at i, v at j, w at the centre. */
static double cubic(const struct patch *p, uint32_t k, const double weight[3])
{
    static const uint32_t next[] = {1, 2, 0}, before[] = {2, 0, 1};
    uint32_t i = next[k], j = before[k];
    double u = weight[i] - weight[k], v = weight[j] - weight[k], w = 3 * weight[k];
    double side = u * (u * (u * p->corner[i] + 3 * v * p->side[i][0]) + 3 * v * v * p->side[j][1]) +
                  v * v * v * p->corner[j];
    double by_one = u * u * p->spoke[i] + 2 * u * v * p->middle[k] + v * v * p->spoke[j];
    double by_two = u * p->inner[i] + v * p->inner[j];
    return side + w * (3 * by_one + w * (3 * by_two + w * p->centre));
}

/* The weights of the corners at q. */
static enum dt_status weigh(struct dt_valuer *v, struct dt_point q, uint32_t half, double *weight)
{
    const struct patch *p = &v->smoother->patch;
    struct dt_weigher *w = &v->weigher;
    if (p->fat) {
        struct dt_point d = {q.x - p->at.x, q.y - p->at.y};
        weight[1] = (d.x * p->to[1].y - d.y * p->to[1].x) / p->area;
        weight[2] = (p->to[0].x * d.y - p->to[0].y * d.x) / p->area;
        weight[0] = 1 - weight[1] - weight[2];
        return DT_OK;
    }
    enum dt_status s = dt_weigh_begin(v->t, q, DT_INSIDE, half, DT_LINEAR, &v->work, w);
    if (s == DT_OK)
        s = dt_weigh_end(w, &v->work);
    for (int i = 0; s == DT_OK && i < 3; i++)
        weight[i] = w->weight[i];
    return s;
}

/* HUGE_VAL: beyond the range of doubles. */
static double or_beyond(double value)
{
    return isfinite(value) ? value : HUGE_VAL;
}

enum dt_status dt_smooth_value(struct dt_valuer *v, struct dt_point q, uint32_t half, double *out)
{
    const struct patch *p = &v->smoother->patch;
    double weight[3];
    enum dt_status s = p->base == dt_base(half) ? DT_OK : make_patch(v, half);
    *out = (double)NAN;
    if (s != DT_OK || isnan(p->first))
        return s;
    s = weigh(v, q, half, weight);
    if (s != DT_OK)
        return s;
    uint32_t k = weight[1] < weight[0] ? 1 : 0;
    k = weight[2] < weight[k] ? 2 : k;
    *out = or_beyond(p->first + cubic(p, k, weight));
    return DT_OK;
}

enum dt_status dt_smooth_on_edge(struct dt_valuer *v, uint32_t half, const double weight[2],
                                 double *out)
{
    const struct dt *t = v->t;
    uint32_t a = dt_origin(&t->mesh, half), b = dt_dest(&t->mesh, half);
    if (t->points.id[b] < t->points.id[a]) {
        uint32_t other = a;
        a = b;
        b = other;
    }
    struct slopes g[2];
    double z0 = dt_value_of(v, a), rise = dt_value_of(v, b) - z0, x = weight[1], y = weight[0];
    *out = (double)NAN;
    if (isnan(rise))
        return DT_OK;
    enum dt_status s = slopes_at(v, a, &g[0]);
    if (s == DT_OK)
        s = slopes_at(v, b, &g[1]);
    if (s != DT_OK)
        return s;
    double from = third(g[0], t->points.xy[a], t->points.xy[b]);
    double to = rise + third(g[1], t->points.xy[b], t->points.xy[a]);
    *out = or_beyond(z0 + x * (3 * y * y * from + x * (3 * y * to + x * rise)));
    return DT_OK;
}
