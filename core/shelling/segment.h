/* segment.h - where to look for the apex of an edge: circle segments, and the cells they touch. */
#pragma once

#include "core/shelling/grid.h"

struct dt_edge {
    struct dt_point a, b, d; /* d = b - a, rounded */
    double length, span;     /* of the edge; span = |d.x| + |d.y| */
};

/* The points left of the edge that see it under an angle of cotangent at most s: the part of a
 * circle through a and b that lies left of the edge. Its centre is s/2 times the edge's length left
 * of the edge's middle.
 *
 *            .---.
 *          /       \       the box of the segment and its height above the edge, both
 *         |         |      rounded outward
 *          a-------b */
struct dt_segment {
    double s, height;
    struct dt_box box;
};

struct dt_segment dt_segment_of_height(const struct dt_edge *e, double height);
struct dt_segment dt_segment_of_cotangent(const struct dt_edge *e, double s);

/* The half plane left of the edge: s = HUGE_VAL. */
struct dt_segment dt_segment_all(const struct dt_edge *e);

/* The part of a grid of cells that a segment touches: the lines and cells of its box. On line j it is only the cells
 * between lo + j slope and hi + j slope: the strip between the edge's line and its parallel at the
 * segment's height. Following the strip takes one addition for each border of lines [the paper, p. 38]:
 *
 *
 *                lo               hi
 *     j + 1  ------/--------------/----
 *                 /    strip     /          the edge goes up and has its left side left
 *     j      ----/--------------/------ */
struct dt_window {
    uint32_t first_line, last_line, first, last;
    double lo, hi, slope;
};

/* False if the box touches none of c. */
bool dt_window_set(struct dt_window *w, const struct dt_edge *e, const struct dt_segment *g,
                   const struct dt_cells *c);

/* The cells first..last of line j in the window; false if there are none. */
static inline bool dt_window_line(const struct dt_window *w, uint32_t j, uint32_t *first,
                                  uint32_t *last)
{
    double lo = w->lo + j * w->slope, hi = w->hi + j * w->slope;
    if (lo >= w->last + 1.0 || hi < w->first)
        return false;
    *first = lo > w->first ? (uint32_t)lo : w->first;
    *last = hi < w->last ? (uint32_t)hi : w->last;
    return true;
}

/* A bound on the coordinates of p - a and p - b for the points p in all cells of c that the segment
 * touches. */
double dt_segment_reach(const struct dt_edge *e, const struct dt_segment *g,
                        const struct dt_cells *c);
