/* apex.c - the third-point search [the paper, "Forming triangles"].
 *
 * The points that see the edge with a cotangent of at most s are those of a circle segment
 * (segment.h), and for s < t the segment of s is a part of that of t:
 *
 *            .---.
 *          /   p   \        scan all cells of some trial segment (scan.h); if the best point found
 *         |  .---.  |       lies in it, no point is better; else its own segment is the next trial,
 *         | /  q  \ |       and the best point in there is the best of all
 *          a-------b
 *
 * In a large segment the search continues, line by line of cells, in the segment of the best point
 * so far: the paper's circle box, which shrinks as better points are found. If nothing is found, the next trial is
 * higher; if even the whole half plane has no point, the edge is a boundary edge. Lines of cells are runs of
 * places, which are empty beyond the hull, so a trial costs little more than the number of lines. */
#include "core/shelling/apex.h"

#include <math.h>

#include "core/exact/predicates.h"
#include "core/shelling/scan.h"

/* The first trial segment is as high as this many cells, the next ones GROWTH times as high each.
 * Measured on evenly spread points: 1.1 trials and 12 points scanned for an edge. */
#define FIRST_HEIGHT 1.5
#define GROWTH 3.0

/* A segment of a larger cotangent counts as the half plane. */
#define FLAT 0x1p60

/* Steps (grid.h) for cells within a cell, for a line of cells and for a trial. After MANY_STEPS steps the limit is checked;
 * PIECE points take about that many steps. */
enum { CELLS_STEPS = 64, LINE_STEPS = 8, TRIAL_STEPS = 64, MANY_STEPS = 4096, PIECE = 1024 };

struct search {
    struct dt_scan scan;
    struct dt_segment segment; /* where to look */
};

/* Counts steps. True: the search has to stop. */
static bool spend(struct search *q, unsigned steps)
{
    uint64_t all = q->scan.looked += steps;
    if (all < MANY_STEPS)
        return false;
    q->scan.looked = 0;
    return dt_grid_spend(q->scan.grid->stop, all);
}

/* Scans places i .. end - 1. This and all others of its kind return false if the search has to stop. */
static bool scan_places(struct search *q, double reach, uint32_t i, uint32_t end)
{
    for (uint32_t next; i < end; i = next) {
        next = end - i > PIECE ? i + PIECE : end;
        dt_scan_run(&q->scan, reach, i, next);
        if (spend(q, 0))
            return false;
    }
    return true;
}

static bool scan_cells(struct search *q, const struct dt_cells *c);

/* Scans cells first..last of c, some of which are crowded. */
static bool scan_crowded(struct search *q, double reach, const struct dt_cells *c, uint32_t first,
                         uint32_t last)
{
    uint32_t i = c->start[first];
    for (uint32_t k = dt_cells_first_sub(c, first); k < c->subs && c->sub_cell[k] <= last; k++) {
        if (!scan_places(q, reach, i, c->start[c->sub_cell[k]]) || !scan_cells(q, &c->sub[k]))
            return false;
        i = c->start[c->sub_cell[k] + 1];
    }
    return scan_places(q, reach, i, c->start[last + 1]);
}

/* Continues in the segment of the best point if many cells remain. False: the new segment touches no more
 * cells of c. */
static bool narrow(struct search *q, const struct dt_cells *c, struct dt_window *w,
                   uint32_t lines_left)
{
    if ((uint64_t)lines_left * (w->last - w->first + 1) <= 16)
        return true;
    double s = dt_scan_bound(&q->scan);
    if (!(s < q->segment.s && s < FLAT))
        return true;
    q->segment = dt_segment_of_cotangent(&q->scan.edge, s);
    return dt_window_set(w, &q->scan.edge, &q->segment, c);
}

/* Scans the part of the segment that is in c. */
static bool scan_cells(struct search *q, const struct dt_cells *c)
{
    struct dt_window w;
    if (spend(q, CELLS_STEPS))
        return false;
    if (!dt_window_set(&w, &q->scan.edge, &q->segment, c))
        return true;
    double reach = dt_segment_reach(&q->scan.edge, &q->segment, c);
    for (uint32_t j = w.first_line; j <= w.last_line; j++) {
        uint32_t first, last, line = j * c->length;
        if (spend(q, LINE_STEPS))
            return false;
        if (!dt_window_line(&w, j, &first, &last))
            continue;
        if (c->subs == 0 ? !scan_places(q, reach, c->start[line + first], c->start[line + last + 1])
                         : !scan_crowded(q, reach, c, line + first, line + last))
            return false;
        if (!narrow(q, c, &w, w.last_line - j))
            return true;
    }
    return true;
}

/* Reports to the observer which circle the segment is a part of. */
static void observe(const struct search *q)
{
    const struct dt_observer *o = q->scan.grid->observer;
    struct dt_event e = {.kind = DT_EVENT_SEARCH, .a = q->scan.a, .b = q->scan.b};
    struct dt_point a = q->scan.edge.a, d = q->scan.edge.d;
    double s = q->segment.s;
    e.size = HUGE_VAL;
    if (s < HUGE_VAL) {
        e.p = (struct dt_point){a.x + (d.x - s * d.y) / 2, a.y + (d.y + s * d.x) / 2};
        e.size = q->scan.edge.length * sqrt(1 + s * s) / 2;
    }
    o->see(o->ctx, &e);
}

static bool scan_segment(struct search *q, struct dt_segment g, bool exact)
{
    q->segment = g;
    if (q->scan.grid->observer != NULL)
        observe(q);
    dt_scan_begin(&q->scan, exact);
    return !spend(q, TRIAL_STEPS) && scan_cells(q, &q->scan.grid->top);
}

/* Finds some point: scans higher and higher segments, and those with points near the edge's line
 * exactly, until there is one. *scanned is the cotangent of the last segment. */
static bool find_some(struct search *q, double *scanned)
{
    const struct dt_grid *g = q->scan.grid;
    const struct dt_edge *e = &q->scan.edge;
    double height = FIRST_HEIGHT * dt_grid_spacing(g, e->a);
    double all = 2 * g->top.side * ((double)g->top.lines + g->top.length);
    for (;; height *= GROWTH) {
        struct dt_segment trial =
            height < all ? dt_segment_of_height(e, height) : dt_segment_all(e);
        if (!scan_segment(q, trial, false))
            return false;
        if (dt_scan_best(&q->scan) == DT_NONE && !dt_scan_is_certain(&q->scan) &&
            !scan_segment(q, trial, true))
            return false;
        *scanned = trial.s;
        if (dt_scan_best(&q->scan) != DT_NONE || height >= all)
            return true;
    }
}

/* The segment of cotangent s, or the half plane. */
static struct dt_segment segment_of(const struct dt_edge *e, double s)
{
    return s < FLAT ? dt_segment_of_cotangent(e, s) : dt_segment_all(e);
}

/* Finds the best point: if some point is not proved to be the best, scans its segment. */
static bool find_best(struct search *q)
{
    double scanned;
    if (!find_some(q, &scanned))
        return false;
    double s = dt_scan_bound(&q->scan);
    if (s > scanned && dt_scan_is_certain(&q->scan)) {
        if (!scan_segment(q, segment_of(&q->scan.edge, s), false))
            return false;
        s = dt_scan_bound(&q->scan);
    }
    return dt_scan_is_certain(&q->scan) || /* else a tie, or nearly */
           scan_segment(q, segment_of(&q->scan.edge, s), true);
}

uint32_t dt_apex(struct dt_grid *g, uint32_t a, uint32_t b)
{
    struct dt_point pa = g->xy[a], pb = g->xy[b], d = {pb.x - pa.x, pb.y - pa.y};
    struct search q;
    q.scan.grid = g;
    q.scan.a = a;
    q.scan.b = b;
    q.scan.looked = 0;
    q.scan.edge =
        (struct dt_edge){pa, pb, d, sqrt(dt_square_distance(pb, pa)), fabs(d.x) + fabs(d.y)};
    uint32_t apex = find_best(&q) ? dt_scan_best(&q.scan) : DT_NONE;
    (void)dt_grid_spend(g->stop, q.scan.looked);
    return apex;
}
