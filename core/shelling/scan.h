/* scan.h - which of many points sees an edge under the largest angle: the inner loop of the
 * third-point search.
 *
 * The paper compares cosines. Without square roots: with
 *
 *     cross(p) = (b - a) x (p - a), positive left of the edge, and dot(p) = (p - a) . (p - b)
 *
 * the cotangent of the angle at p is s(p) = dot / cross, to be minimised.
 *
 * There are two kinds of scan. The first uses rounded values, and can say afterwards whether they were precise
 * enough: no other point was near the best one, and none was near the edge's line. The exact one uses exact
 * predicates where rounded values cannot decide. */
#pragma once

#include "core/exact/lanes.h"
#include "core/shelling/segment.h"

struct dt_scan {
    const struct dt_grid *grid; /* borrows */
    uint32_t a, b;              /* the edge, as places */
    struct dt_edge edge;
    bool exact;
    uint64_t looked; /* what scans have cost since this was zeroed, in steps (grid.h) */
    double reach;    /* first scan: of all points scanned; exact: of the best point */
    /* the first scan: each lane has every other point of a run */
    dt_lanes least, second; /* the two smallest cotangents */
    dt_lanes least_at;      /* the place of the smallest one; -1 if there is none */
    bool doubt;             /* a point is barely left of the edge */
    /* the exact scan */
    uint32_t best; /* DT_NONE if there is none */
    double dot, cross;
};

/* Begins a scan for the edge, of no points yet. */
void dt_scan_begin(struct dt_scan *q, bool exact);

/* Takes the points at places i..end-1 into account; `reach` bounds the coordinates of p - a and
 * p - b for all of them. */
void dt_scan_run(struct dt_scan *q, double reach, uint32_t i, uint32_t end);

/* The best point so far, DT_NONE if there is none. */
uint32_t dt_scan_best(const struct dt_scan *q);

/* An upper bound of its cotangent; HUGE_VAL if there is none, or if it may be on the edge's
 * line. */
double dt_scan_bound(const struct dt_scan *q);

/* Whether the best point is the best of all scanned with certainty. */
bool dt_scan_is_certain(const struct dt_scan *q);
