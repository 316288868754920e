/* scan.c - the two scans of scan.h; the error bounds of their values are in bounds.h. */
#include "core/shelling/scan.h"

#include <float.h>
#include <math.h>

#include "core/exact/predicates.h"

/* Steps for a point: in the first scan; in the exact one; and for a predicate, which usually takes 30, but up
 * to 1000 if it needs exact arithmetic. */
enum { LOOK = 2, CLOSE_LOOK = 6, PREDICATE = 100 };

void dt_scan_begin(struct dt_scan *q, bool exact)
{
    q->exact = exact;
    q->reach = 0;
    q->least = q->second = (dt_lanes){HUGE_VAL, HUGE_VAL};
    q->least_at = (dt_lanes){-1, -1};
    q->doubt = false;
    q->best = DT_NONE;
    q->dot = DBL_MAX; /* with cross = 0, a cotangent greater than any */
    q->cross = 0;
}

/* Whether a point near the edge's line is left of the edge. */
static bool is_left(struct dt_scan *q, uint32_t i)
{
    q->looked += PREDICATE;
    return i != q->a && i != q->b && dt_orient2d(q->edge.a, q->edge.b, q->grid->xy[i]) > 0;
}

/* ---- the first scan ---- */

/* Whether a point of the run is left of the edge, but by no more than `sure`. */
static bool has_doubtful(struct dt_scan *q, double sure, uint32_t i, uint32_t end)
{
    q->looked += (uint64_t)CLOSE_LOOK * (end - i);
    for (; i < end; i++) {
        struct dt_point p = q->grid->xy[i], a = q->edge.a, d = q->edge.d;
        if (fabs(d.x * (p.y - a.y) - d.y * (p.x - a.x)) <= sure && is_left(q, i))
            return true;
    }
    return false;
}

/* Takes the points in pairs. No branch depends on which of them is the best, since it would be unpredictable.
 * The NaN of a removed point fails every comparison, so it is ignored. */
static void scan_rounded(struct dt_scan *q, double reach, uint32_t i, uint32_t end)
{
    static const struct dt_point nowhere = {DT_REMOVED, DT_REMOVED};
    const struct dt_edge *e = &q->edge;
    const dt_lanes ax = dt_lanes_both(e->a.x), ay = dt_lanes_both(e->a.y),
                   bx = dt_lanes_both(e->b.x), by = dt_lanes_both(e->b.y);
    const dt_lanes dx = dt_lanes_both(e->d.x), dy = dt_lanes_both(e->d.y), a = dt_lanes_both(q->a),
                   b = dt_lanes_both(q->b);
    const dt_lanes sure = dt_lanes_both(DT_SCAN_SURE * e->span * reach),
                   none = dt_lanes_both(HUGE_VAL);
    dt_lanes least = q->least, second = q->second, least_at = q->least_at, at = {i, i + 1.0};
    dt_lanes_holds near = {0, 0};
    q->looked += (uint64_t)LOOK * (end - i);
    for (uint32_t k = i; k < end; k += 2, at += 2) {
        const struct dt_point *p = q->grid->xy + k, *r = k + 1 < end ? p + 1 : &nowhere;
        dt_lanes px = {p->x, r->x}, py = {p->y, r->y};
        dt_lanes x = px - ax, y = py - ay, cross = dx * y - dy * x;
        dt_lanes s = dt_lanes_choose(cross > sure, (x * (px - bx) + y * (py - by)) / cross, none);
        dt_lanes_holds less = s < least;
        dt_lanes other = dt_lanes_choose(less, least, s);
        second = dt_lanes_choose(other < second, other, second);
        least_at = dt_lanes_choose(less, at, least_at);
        least = dt_lanes_choose(less, s, least);
        near |= (cross <= sure) & (cross >= -sure) & (at != a) & (at != b);
    }
    q->least = least;
    q->second = second;
    q->least_at = least_at;
    q->reach = reach > q->reach ? reach : q->reach;
    if ((near[0] | near[1]) != 0)
        q->doubt |= has_doubtful(q, sure[0], i, end);
}

/* Returns the lane that has the least cotangent. */
static int least_lane(const struct dt_scan *q)
{
    return q->least[1] < q->least[0];
}

/* The difference from the least cotangent beyond which another cotangent is certainly greater. */
static double margin(const struct dt_scan *q)
{
    return DT_SCAN_SURE * (2 * q->reach / q->edge.span + fabs(q->least[least_lane(q)]));
}

bool dt_scan_is_certain(const struct dt_scan *q)
{
    int lane = least_lane(q);
    double sure = q->least[lane] + margin(q);
    if (q->exact || q->least[lane] == HUGE_VAL)
        return !q->doubt;
    return !q->doubt && q->least[!lane] >= sure && q->second[0] >= sure && q->second[1] >= sure;
}

/* ---- the exact scan ---- */

/* Error bounds, for points that far away and the best point so far. */
struct bounds {
    double cross, det;
};

static struct bounds bounds_of(const struct dt_scan *q, double reach)
{
    double k = q->edge.span, r = reach > q->reach ? reach : q->reach;
    return (struct bounds){DT_SCAN_CROSS_BOUND * k * reach, DT_SCAN_DET_BOUND * k * r * r * r};
}

/* Whether point i is the best so far: values decide if they are beyond their bounds. */
static bool is_better(struct dt_scan *q, struct bounds e, uint32_t i, double cross, double det)
{
    const struct dt_point *xy = q->grid->xy;
    if (!(cross >= -e.cross) || (cross > e.cross && det > e.det) || i == q->best)
        return false;
    if (cross <= e.cross && !is_left(q, i))
        return false;
    if (q->best == DT_NONE || (cross > e.cross && det < -e.det))
        return true;
    q->looked += PREDICATE;
    return dt_incircle_perturbed(q->edge.a, q->edge.b, xy[q->best], xy[i]) > 0;
}

static void scan_exactly(struct dt_scan *q, double reach, uint32_t i, uint32_t end)
{
    const struct dt_point *xy = q->grid->xy, a = q->edge.a, b = q->edge.b, d = q->edge.d;
    struct bounds e = bounds_of(q, reach);
    q->looked += (uint64_t)CLOSE_LOOK * (end - i);
    for (; i < end; i++) {
        double x = xy[i].x - a.x, y = xy[i].y - a.y;
        double cross = d.x * y - d.y * x;
        double dot = x * (xy[i].x - b.x) + y * (xy[i].y - b.y);
        if (!is_better(q, e, i, cross, dot * q->cross - q->dot * cross))
            continue;
        q->best = i;
        q->dot = dot;
        q->cross = cross;
        q->reach = reach;
        e = bounds_of(q, reach);
    }
}

/* ---- either ---- */

void dt_scan_run(struct dt_scan *q, double reach, uint32_t i, uint32_t end)
{
    if (i == end)
        return;
    if (q->exact)
        scan_exactly(q, reach, i, end);
    else
        scan_rounded(q, reach, i, end);
}

uint32_t dt_scan_best(const struct dt_scan *q)
{
    double at = q->least_at[least_lane(q)];
    if (q->exact)
        return q->best;
    return at < 0 ? DT_NONE : (uint32_t)at;
}

double dt_scan_bound(const struct dt_scan *q)
{
    if (!q->exact)
        return q->least[least_lane(q)] + margin(q);
    double error = DT_SCAN_CROSS_BOUND * q->edge.span * q->reach,
           dot = q->dot + DT_SCAN_DOT_BOUND * q->reach * q->reach;
    if (q->best == DT_NONE || q->cross <= 2 * error)
        return HUGE_VAL;
    double s = dot / (dot > 0 ? q->cross - error : q->cross + error);
    return s + DT_SCAN_COTANGENT_BOUND * fabs(s);
}
