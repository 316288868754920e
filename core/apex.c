/* apex.c - the third-point search [the paper, "Forming triangles"].
 *
 * The paper looks for the point p that sees the edge under the largest angle, that is, the smallest
 * cosine. Without square roots: with
 *
 *     cross(p) = (b - a) x (p - a),  > 0 on the left        dot(p) = (p - a) . (p - b)
 *
 * the cotangent of the angle at p is s(p) = dot / cross, to be minimised. The points that see the
 * edge with a cotangent of at most s are those of a segment (segment.h), and for s < s' the segment
 * of s is a part of that of s'. So: scan all cells of some trial segment. If the best point found
 * lies in it, no point is better; else its own segment is the next trial. In a large segment the
 * search goes on in that of the best point found so far, line by line: the paper's circle box,
 * which shrinks as better points are found.
 *
 * The scan is done with rounded values, and tells whether they were enough: no other point came
 * near the best one, and none was near the edge's line. Otherwise, in case of ties and on crowded
 * lines, a second scan settles with exact predicates what rounded values leave open.
 *
 * Bounds, with u = 2^-53, R >= all coordinates of p - a and p - b, K = |dx| + |dy|, d = b - a:
 *     cross: two products of rounded differences, 4 u (|dx py| + |dy px|) < 4.1 u K R        bound
 * 8 u K R dot:   two products of rounded differences, 4 u * 2 R^2 < 8.1 u R^2 bound 12 u R^2 dot
 * cross' - dot' cross, dot <= 2 R^2, cross <= K R: each product is off by 2 R^2 * 4.1 u K R + K R
 * * 8.1 u R^2
 *     + 2 u K R^3 < 18.5 u K R^3, the difference by 4 u K R^3 more: 41 u K R^3               bound
 * 48 u K R^3 s = dot / cross, where cross > 2^-24 K R = 2^26 * 8 u K R: 2^-26 (1.5 R / K + |s|); so
 * if two of them differ by more than 2^-24 (2 R / K + |s|), s the smaller one, their order is
 * certain. */
#include "core/apex.h"

#include <float.h>
#include <math.h>

#include "core/predicates.h"
#include "core/segment.h"

#define U 0x1p-53

/* The first trial segment is as high as this many cells, the next ones GROWTH times as high each.
 */
#define FIRST_HEIGHT 1.5
#define GROWTH 3.0

/* Two doubles that are computed with at once; comparisons give all ones or zeros. */
typedef double pair __attribute__((vector_size(16)));
typedef int64_t mask __attribute__((vector_size(16)));

/* What the first scan has found, each in its half of the points. */
struct lanes {
    pair least, second; /* the two smallest cotangents */
    pair best;          /* the place of the least one; -1 if there is none */
};

struct search {
    const struct dt_grid *grid;
    uint32_t a, b;
    struct dt_edge edge;
    struct dt_segment segment;
    bool exact;    /* the second scan */
    uint32_t best; /* the best point so far, DT_NONE if there is none */
    double reach;  /* the R that holds for it; while not exact, for all points scanned */
    /* while not exact: */
    struct lanes lanes;
    bool doubt; /* a point is left of the edge, but hardly */
    /* while exact: */
    double dot, cross; /* of the best point */
};

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* ---- the best point so far ---- */

/* An upper bound of the cotangent of a point with these values; HUGE_VAL if it is huge, or the
 * point may be on the edge's line. */
static double cotangent_bound(const struct search *q)
{
    double error = 8 * U * q->edge.span * q->reach, dot = q->dot + 12 * U * q->reach * q->reach;
    if (q->cross <= 2 * error)
        return HUGE_VAL;
    double s = dot / (dot > 0 ? q->cross - error : q->cross + error);
    s += 0x1p-50 * fabs(s);
    return s < 0x1p60 ? s : HUGE_VAL;
}

/* The least cotangent of the first scan, the next one, and whose it is. */
static double least_of(const struct lanes *l)
{
    return smaller(l->least[0], l->least[1]);
}

static double second_of(const struct lanes *l)
{
    return smaller(larger(l->least[0], l->least[1]), smaller(l->second[0], l->second[1]));
}

static uint32_t best_of(const struct lanes *l)
{
    double best = l->least[0] < l->least[1] ? l->best[0] : l->best[1];
    return best < 0 ? DT_NONE : (uint32_t)best;
}

/* How far another cotangent must be from the least one to be greater with certainty. */
static double margin(const struct search *q)
{
    return 0x1p-24 * (2 * q->reach / q->edge.span + fabs(least_of(&q->lanes)));
}

/* An upper bound of the best point's cotangent; HUGE_VAL if there is no best point. */
static double best_bound(const struct search *q)
{
    if (!q->exact)
        return least_of(&q->lanes) + margin(q);
    return q->best == DT_NONE ? HUGE_VAL : cotangent_bound(q);
}

/* ---- scanning runs of places ---- */

/* A point that is near the edge's line: it is of no account if it is not left of it. */
static __attribute__((noinline)) bool is_left(const struct search *q, uint32_t i)
{
    return i != q->a && i != q->b && dt_orient2d(q->edge.a, q->edge.b, q->grid->xy[i]) > 0;
}

static inline pair choose(mask m, pair a, pair b)
{
    return (pair)((m & (mask)a) | (~m & (mask)b));
}

static inline bool any(mask m)
{
    return (m[0] | m[1]) != 0;
}

/* Whether a point of the run is left of the edge, but by no more than `sure`. */
static __attribute__((noinline)) bool is_doubtful(const struct search *q, double sure, uint32_t i,
                                                  uint32_t end)
{
    for (; i < end; i++) {
        struct dt_point p = q->grid->xy[i], a = q->edge.a, d = q->edge.d;
        if (fabs(d.x * (p.y - a.y) - d.y * (p.x - a.x)) <= sure && is_left(q, i))
            return true;
    }
    return false;
}

/* The first scan, of the points i..end-1 in pairs. No branch depends on which point is the best, as
 * none could be predicted. The NaN of a removed point fails every comparison, and so drops out. */
static inline void scan_run(struct search *q, double reach, uint32_t i, uint32_t end)
{
    static const struct dt_point nowhere = {NAN, NAN};
    const struct dt_point *xy = q->grid->xy;
    const pair ax = {q->edge.a.x, q->edge.a.x}, ay = {q->edge.a.y, q->edge.a.y};
    const pair bx = {q->edge.b.x, q->edge.b.x}, by = {q->edge.b.y, q->edge.b.y};
    const pair dx = {q->edge.d.x, q->edge.d.x}, dy = {q->edge.d.y, q->edge.d.y};
    const pair at_a = {q->a, q->a}, at_b = {q->b, q->b}, huge = {HUGE_VAL, HUGE_VAL};
    double s_ = 0x1p-24 * q->edge.span * reach;
    const pair sure = {s_, s_};
    struct lanes l = q->lanes;
    mask near = {0, 0};
    pair at = {i, i + 1.0};
    for (uint32_t k = i; k < end; k += 2) {
        const struct dt_point *u = xy + k, *v = k + 1 < end ? u + 1 : &nowhere;
        pair px = {u->x, v->x}, py = {u->y, v->y};
        pair x = px - ax, y = py - ay, cross = dx * y - dy * x;
        pair dot = x * (px - bx) + y * (py - by);
        pair s = choose(cross > sure, dot / cross, huge);
        near |= (cross <= sure) & (cross >= -sure) & (at != at_a) & (at != at_b);
        mask less = s < l.least;
        pair greater = choose(less, l.least, s);
        l.second = choose(greater < l.second, greater, l.second);
        l.best = choose(less, at, l.best);
        l.least = choose(less, s, l.least);
        at += 2;
    }
    q->lanes = l;
    if (any(near) && is_doubtful(q, s_, i, end))
        q->doubt = true;
}

/* Error bounds of the second scan, for points at most `reach` away and for the best point so far.
 */
struct bounds {
    double cross, det;
};

static struct bounds bounds_of(const struct search *q, double reach)
{
    double k = q->edge.span, r = larger(reach, q->reach);
    return (struct bounds){8 * U * k * reach, 48 * U * k * r * r * r};
}

/* Whether point i, of these values, is the best so far. */
static bool is_better(const struct search *q, const struct bounds *e, uint32_t i, double cross,
                      double det)
{
    const struct dt_point *xy = q->grid->xy, a = q->edge.a, b = q->edge.b;
    if (i == q->best || (cross <= e->cross && !is_left(q, i)))
        return false;
    if (q->best == DT_NONE || (cross > e->cross && det < -e->det))
        return true;
    return dt_incircle_perturbed(a, b, xy[q->best], xy[i]) > 0;
}

/* The second scan. */
static void scan_run_exactly(struct search *q, double reach, uint32_t i, uint32_t end)
{
    const struct dt_point *xy = q->grid->xy, a = q->edge.a, b = q->edge.b, d = q->edge.d;
    struct bounds e = bounds_of(q, reach);
    for (; i < end; i++) {
        double x = xy[i].x - a.x, y = xy[i].y - a.y;
        double cross = d.x * y - d.y * x;
        double dot = x * (xy[i].x - b.x) + y * (xy[i].y - b.y);
        double det = dot * q->cross - q->dot * cross;
        if (!(cross >= -e.cross) || (cross > e.cross && det > e.det) ||
            !is_better(q, &e, i, cross, det))
            continue;
        q->best = i;
        q->dot = dot;
        q->cross = cross;
        q->reach = reach;
        e = bounds_of(q, reach);
    }
}

/* ---- scanning cells ---- */

static void scan(struct search *q, double reach, uint32_t i, uint32_t end)
{
    if (i == end)
        return;
    if (q->exact) {
        scan_run_exactly(q, reach, i, end);
        return;
    }
    q->reach = larger(q->reach, reach);
    scan_run(q, reach, i, end);
}

static void scan_cells(struct search *q, const struct dt_cells *c);

/* Scans cells first..last of c, some of which are crowded. */
static void scan_crowded(struct search *q, double reach, const struct dt_cells *c, uint32_t first,
                         uint32_t last)
{
    uint32_t i = c->start[first];
    for (uint32_t k = dt_cells_first_sub(c, first); k < c->subs && c->sub_cell[k] <= last; k++) {
        scan(q, reach, i, c->start[c->sub_cell[k]]);
        scan_cells(q, &c->sub[k]);
        i = c->start[c->sub_cell[k] + 1];
    }
    scan(q, reach, i, c->start[last + 1]);
}

/* Where there is much left to scan, continues in the segment of the best point. False if that
 * leaves nothing of c. */
static bool narrow(struct search *q, const struct dt_cells *c, struct dt_window *w,
                   uint32_t lines_left)
{
    if ((uint64_t)lines_left * (w->last - w->first + 1) <= 16)
        return true;
    double s = best_bound(q);
    if (!(s < q->segment.s))
        return true;
    q->segment = dt_segment_of_cotangent(&q->edge, s);
    return dt_window_set(w, &q->edge, &q->segment, c);
}

/* Scans the part of the current segment that is in c. */
static void scan_cells(struct search *q, const struct dt_cells *c)
{
    struct dt_window w;
    if (!dt_window_set(&w, &q->edge, &q->segment, c))
        return;
    double reach = dt_segment_reach(&q->edge, &q->segment, c);
    for (uint32_t j = w.first_line; j <= w.last_line; j++) {
        uint32_t first, last, line = j * c->length;
        if (!dt_window_line(&w, j, &first, &last))
            continue;
        if (c->subs == 0)
            scan(q, reach, c->start[line + first], c->start[line + last + 1]);
        else
            scan_crowded(q, reach, c, line + first, line + last);
        if (!narrow(q, c, &w, w.last_line - j))
            return;
    }
}

/* ---- the search ---- */

static bool has_best(const struct search *q)
{
    return q->exact ? q->best != DT_NONE : best_of(&q->lanes) != DT_NONE;
}

/* Scans trial segments until the best point scanned is the best of all. s is the cotangent of a
 * segment that is known to hold a point, or HUGE_VAL. */
static void find_best(struct search *q, double s)
{
    static const struct lanes none = {{HUGE_VAL, HUGE_VAL}, {HUGE_VAL, HUGE_VAL}, {-1, -1}};
    const struct dt_cells *top = &q->grid->top;
    double height = FIRST_HEIGHT * dt_grid_spacing(q->grid, q->edge.a);
    double limit = 2 * top->side * ((double)top->lines + top->length); /* passes all points */
    bool found = false, last;
    do {
        last = s < 0x1p60 || found || height >= limit;
        if (s < 0x1p60)
            q->segment = dt_segment_of_cotangent(&q->edge, s);
        else if (last)
            q->segment = dt_segment_all(&q->edge);
        else
            q->segment = dt_segment_of_height(&q->edge, height);
        double scanned = q->segment.s;
        q->lanes = none;
        scan_cells(q, top);
        found = has_best(q);
        s = found ? best_bound(q) : HUGE_VAL;
        height *= GROWTH;
        last |= s <= scanned || q->doubt;
    } while (!last);
}

uint32_t dt_apex(const struct dt_grid *g, uint32_t a, uint32_t b)
{
    struct search q;
    struct dt_point pa = g->xy[a], pb = g->xy[b], d = {pb.x - pa.x, pb.y - pa.y};
    q.grid = g;
    q.a = a;
    q.b = b;
    q.edge = (struct dt_edge){pa, pb, d, sqrt(d.x * d.x + d.y * d.y), fabs(d.x) + fabs(d.y)};
    q.reach = 0;
    q.exact = q.doubt = false;
    find_best(&q, HUGE_VAL);
    if (!q.doubt && second_of(&q.lanes) >= least_of(&q.lanes) + margin(&q))
        return best_of(&q.lanes);

    double s = has_best(&q) ? best_bound(&q) : HUGE_VAL;
    q.exact = true;
    q.doubt = false;
    q.best = DT_NONE;
    q.reach = 0;
    q.cross = 0;
    q.dot = DBL_MAX; /* a cotangent greater than any */
    find_best(&q, s);
    return q.best;
}
