/* apex.c - the third-point search [the paper, "Forming triangles"].
 *
 * The paper looks for the point p that sees the edge under the largest angle, that is, the smallest
 * cosine. Without square roots: with
 *
 *     cross(p) = (b - a) x (p - a),  > 0 on the left        dot(p) = (p - a) . (p - b)
 *
 * the cotangent of the angle at p is s(p) = dot / cross, to be minimised. The circle through a, b
 * and p has its centre at s/2 |ab| left of the edge's middle; the segment of it that lies left of
 * the edge grows with s:
 *
 *              .---.                 segment(s) = the points left of ab that see it with a
 * cotangent of at most s; /   p   \               for s < s', segment(s) is a part of segment(s').
 *           |  .---.  |
 *           | /  q  \ |              So: scan all cells of some trial segment. If the best point
 * found lies in it, no point a --------b              is better; else the segment of the point
 * found is the next trial.
 *
 * The cells of a segment are those of its min-max box, as in the paper, and between the edge's line
 * and the parallel that touches the segment; each line of cells contributes one run of places. The
 * box shrinks as better points are found.
 *
 * Rounding. Limits of the region are padded outward, so every point of the segment is scanned. Of
 * the points scanned, the floating-point values reject one only if it is certainly right of the
 * edge or certainly worse than the best, and take one only if it is certainly left and better;
 * exact predicates decide the rest. Bounds, u = 2^-53, with R at least every coordinate of p - a
 * and p - b, K = |dx| + |dy|, d = b - a: cross: two products of rounded differences, 4 u (|dx py| +
 * |dy px|) < 4.1 u K R        bound 8 u K R dot:   two products of rounded differences, 4 u * 2 R^2
 * < 8.1 u R^2                    bound 10 u R^2 dot cross' - dot' cross, dot <= 2 R^2, cross <= K
 * R: each product is off by 2 R^2 * 4.1 u K R + K R * 8.1 u R^2
 *     + 2 u K R^3 < 18.5 u K R^3, the difference by 4 u K R^3 more: 41 u K R^3               bound
 * 48 u K R^3 */
#include "core/apex.h"

#include "core/predicates.h"

#include <float.h>
#include <math.h>

#define U 0x1p-53

/* The first trial segment is as high as this many cells, the next ones GROWTH times as high each.
 */
#define FIRST_HEIGHT 1.0
#define GROWTH 3.0

/* Where to look: the segment of cotangent s, its box, and its height above the edge. */
struct segment {
    double s, height;
    struct dt_point lo, hi;
};

struct search {
    const struct dt_grid *grid;
    uint32_t a, b;
    struct dt_point pa, pb, d; /* the end points, and pb - pa */
    double length;             /* of the edge */
    struct segment segment;
    /* The best point so far and its values; reach is the R for which they were computed. */
    uint32_t best;
    double dot, cross, reach;
};

/* ---- segments ---- */

/* How far the segment reaches beyond the edge's end points in the direction e (a unit vector along
 * an axis), rounded outward: the extreme point of the circle, if that lies on the edge's left. side
 * = d x e, along = d . e. */
static double extent(const struct search *q, double r, double s, double side, double along)
{
    double length2 = q->length * q->length;
    double extreme =
        along / 2 + s / 2 * side + r; /* from a: half the edge, s/2 along its normal, the radius */
    double ends = along > 0 ? along : 0;
    bool left = s / 2 * length2 + side * r > -0x1p-40 * q->length * r;
    return (left && extreme > ends ? extreme : ends) + 0x1p-48 * q->length * (1 + fabs(s));
}

/* What adding v to the coordinate c loses, at most; to be added to v before. */
static double lost(double c)
{
    return 2 * U * fabs(c);
}

static void segment_set(struct search *q, double s)
{
    struct segment *g = &q->segment;
    double root = sqrt(1 + s * s), r = q->length / 2 * root;
    struct dt_point d = q->d, a = q->pa;
    g->s = s;
    g->height = (s > 0 ? r + q->length / 2 * s : q->length / 2 / (root - s)) * (1 + 0x1p-40);
    g->hi.x = a.x + (extent(q, r, s, -d.y, d.x) + lost(a.x));
    g->lo.x = a.x - (extent(q, r, s, d.y, -d.x) + lost(a.x));
    g->hi.y = a.y + (extent(q, r, s, d.x, d.y) + lost(a.y));
    g->lo.y = a.y - (extent(q, r, s, -d.x, -d.y) + lost(a.y));
}

/* The whole half plane. */
static void segment_set_all(struct search *q)
{
    struct dt_point d = q->d, a = q->pa;
    q->segment = (struct segment){HUGE_VAL, HUGE_VAL, {-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}};
    if (d.x == 0 && d.y > 0)
        q->segment.hi.x = a.x;
    if (d.x == 0 && d.y < 0)
        q->segment.lo.x = a.x;
    if (d.y == 0 && d.x > 0)
        q->segment.lo.y = a.y;
    if (d.y == 0 && d.x < 0)
        q->segment.hi.y = a.y;
}

/* An upper bound of the best point's cotangent; infinite if the point may be on the edge's line. */
static double best_cotangent(const struct search *q)
{
    double cross_error = 8 * U * (fabs(q->d.x) + fabs(q->d.y)) * q->reach;
    double dot = q->dot + 10 * U * q->reach * q->reach;
    if (q->cross <= 2 * cross_error)
        return HUGE_VAL;
    double s = dot / (dot > 0 ? q->cross - cross_error : q->cross + cross_error);
    return s + 0x1p-50 * fabs(s);
}

/* Makes the best point's segment the current one if that is smaller. */
static void segment_shrink(struct search *q)
{
    double s = best_cotangent(q);
    if (s < q->segment.s && s < 0x1p60)
        segment_set(q, s);
}

/* ---- scanning ---- */

/* Error bounds for points at most `reach` away from a and b. */
struct bounds {
    double reach, cross, det;
};

static void bounds_set(const struct search *q, struct bounds *e)
{
    double k = fabs(q->d.x) + fabs(q->d.y), r = fmax(e->reach, q->best == DT_NONE ? 0 : q->reach);
    e->cross = 8 * U * k * e->reach;
    e->det = 48 * U * k * r * r * r;
}

static void take(struct search *q, struct bounds *e, uint32_t i, double dot, double cross)
{
    q->best = i;
    q->dot = dot;
    q->cross = cross;
    q->reach = e->reach;
    bounds_set(q, e);
}

/* Decides exactly whether point i is the best so far. */
static __attribute__((noinline)) bool is_better(const struct search *q, uint32_t i)
{
    const struct dt_point *xy = q->grid->xy;
    if (i == q->a || i == q->b || dt_orient2d(q->pa, q->pb, xy[i]) <= 0)
        return false;
    return q->best == DT_NONE || dt_incircle_perturbed(q->pa, q->pb, xy[q->best], xy[i]) > 0;
}

/* Removed points are NaN and fail both comparisons with cross. */
static void scan_run(struct search *q, struct bounds *e, uint32_t i, uint32_t end)
{
    const struct dt_point *xy = q->grid->xy;
    const struct dt_point a = q->pa, b = q->pb, d = q->d;
    for (; i < end; i++) {
        double x = xy[i].x - a.x, y = xy[i].y - a.y;
        double cross = d.x * y - d.y * x;
        double dot = x * (xy[i].x - b.x) + y * (xy[i].y - b.y);
        double det = dot * q->cross - q->dot * cross;
        if (cross > e->cross) {
            if (det < -e->det || (det <= e->det && is_better(q, i)))
                take(q, e, i, dot, cross);
        } else if (cross >= -e->cross && is_better(q, i)) {
            take(q, e, i, dot, cross);
        }
    }
}

static void scan_cells(struct search *q, const struct dt_cells *c);

/* Scans cells first..last of a line, where some cells of c are crowded. */
static void scan_crowded(struct search *q, struct bounds *e, const struct dt_cells *c,
                         uint32_t first, uint32_t last)
{
    uint32_t i = c->start[first];
    for (uint32_t k = dt_cells_first_sub(c, first); k < c->subs && c->sub_cell[k] <= last; k++) {
        scan_run(q, e, i, c->start[c->sub_cell[k]]);
        scan_cells(q, &c->sub[k]);
        bounds_set(q, e);
        i = c->start[c->sub_cell[k] + 1];
    }
    scan_run(q, e, i, c->start[last + 1]);
}

/* The lines and cells of c that the box of a segment touches. */
struct window {
    uint32_t first_line, last_line, first, last;
};

/* False if the box touches none of c. */
static bool window_of(const struct segment *g, const struct dt_cells *c, struct window *w)
{
    double v0 = dt_cells_across(c, g->lo), v1 = dt_cells_across(c, g->hi);
    double u0 = dt_cells_along(c, g->lo), u1 = dt_cells_along(c, g->hi);
    w->first_line = dt_cells_clamp(v0, c->lines);
    w->last_line = dt_cells_clamp(v1, c->lines);
    w->first = dt_cells_clamp(u0, c->length);
    w->last = dt_cells_clamp(u1, c->length);
    return v0 < c->lines && v1 >= 0 && u0 < c->length && u1 >= 0;
}

/* The strip between the edge's line and its parallel at the segment's height. On line j of cells it
 * lies between lo + j slope and hi + j slope:
 *
 *     j + 1  ------/---------/--       the intersections of a line with the borders of the lines of
 * cells: one addition lo    /   strip /  hi      each [the paper, p. 38] j      ----/---------/----
 */
struct strip {
    double lo, hi, slope;
};

static struct strip strip_of(const struct search *q, const struct dt_cells *c)
{
    double along = c->upright ? q->d.y : q->d.x, across = c->upright ? -q->d.x : q->d.y;
    if (across == 0)
        return (struct strip){-HUGE_VAL, HUGE_VAL, 0};
    double slope = along / (c->upright ? q->d.x : q->d.y);
    double u = dt_cells_along(c, q->pa), v = dt_cells_across(c, q->pa);
    double width = q->segment.height * c->per_unit * q->length / fabs(across);
    double pad = 0x1p-48 * (fabs(u) + (fabs(v) + c->lines) * fabs(slope) + c->length);
    double lo = u - v * slope + fmin(0, slope) - pad, hi = u - v * slope + fmax(0, slope) + pad;
    /* Going up, the edge has its left side at smaller numbers; a line of cells along y sees the
     * mirror image. */
    return across > 0 ? (struct strip){lo - width, hi, slope}
                      : (struct strip){lo, hi + width, slope};
}

/* A bound on the coordinates of p - a and p - b for all points p in the cells of the current
 * segment. */
static double reach_of(const struct search *q, const struct dt_cells *c)
{
    const struct segment *g = &q->segment;
    double w = c->side * c->length, h = c->side * c->lines;
    double x = fmax(fmin(g->hi.x, c->lo.x + (c->upright ? h : w)) - q->pa.x,
                    q->pa.x - fmax(g->lo.x, c->lo.x));
    double y = fmax(fmin(g->hi.y, c->lo.y + (c->upright ? w : h)) - q->pa.y,
                    q->pa.y - fmax(g->lo.y, c->lo.y));
    return (fmax(fmax(x, y), 0) + c->side + fmax(fabs(q->d.x), fabs(q->d.y))) * (1 + 0x1p-20);
}

/* Scans the cells of c that the current segment touches; the segment shrinks when a line of cells
 * has brought a better point. */
static void scan_cells(struct search *q, const struct dt_cells *c)
{
    struct window w;
    if (!window_of(&q->segment, c, &w))
        return;
    struct strip strip = strip_of(q, c);
    struct bounds e = {.reach = reach_of(q, c)};
    bounds_set(q, &e);
    for (uint32_t j = w.first_line; j <= w.last_line; j++) {
        double lo = strip.lo + j * strip.slope, hi = strip.hi + j * strip.slope;
        if (lo >= w.last + 1.0 || hi < w.first)
            continue;
        uint32_t before = q->best;
        uint32_t first = j * c->length + (lo > w.first ? (uint32_t)lo : w.first);
        uint32_t last = j * c->length + (hi < w.last ? (uint32_t)hi : w.last);
        if (c->subs == 0)
            scan_run(q, &e, c->start[first], c->start[last + 1]);
        else
            scan_crowded(q, &e, c, first, last);
        if (q->best != before && j < w.last_line) {
            segment_shrink(q);
            if (!window_of(&q->segment, c, &w))
                return;
            strip = strip_of(q, c);
        }
    }
}

uint32_t dt_apex(const struct dt_grid *g, uint32_t a, uint32_t b)
{
    struct dt_point pa = g->xy[a], pb = g->xy[b];
    struct search q = {.grid = g, .a = a, .b = b, .pa = pa, .pb = pb, .best = DT_NONE};
    q.d = (struct dt_point){pb.x - pa.x, pb.y - pa.y};
    q.length = sqrt(q.d.x * q.d.x + q.d.y * q.d.y);
    q.dot = DBL_MAX; /* any point is better than none: cross = 0 makes every cotangent smaller than
                        this */
    double height = FIRST_HEIGHT * dt_grid_spacing(g, pa),
           all = 2 * g->top.side * (g->top.lines + g->top.length);
    for (;;) {
        if (q.best != DT_NONE && best_cotangent(&q) < 0x1p60)
            segment_set(&q, best_cotangent(&q));
        else if (q.best == DT_NONE && height < all)
            segment_set(&q, height / q.length - q.length / height / 4);
        else
            segment_set_all(&q);
        double s = q.segment.s;
        scan_cells(&q, &g->top);
        if (s == HUGE_VAL || (q.best != DT_NONE && best_cotangent(&q) <= s))
            return q.best;
        height *= GROWTH;
    }
}
