/* grid.h - the paper's uniform grid: the points of a set in the order of the cells they fall into.
 *
 * The cells are squares of side sqrt(area / n) * 4/3 over the min-max box. A line of cells is a row, or a
 * column if the box is higher than wide, so that there are few lines. The points of a line, and the points
 * of adjacent cells in a line, are one contiguous run of places. A point's place is its
 * index in that order.
 *
 *        line 1  | 5 |   | 6 7 | 8 |         start[] of line 1:  5 6 6 8 9
 *        line 0  | 0 | 1 2 3 | 4 |   |       places 0..8 hold xy[0..8]
 *
 * A crowded cell has cells of its own: the same grid again over the box of its points, which stay within
 * the cell's run of places. Evenly spread points have no such cells. The paper has none, and
 * slows down on crowded points.
 *
 * A point that is removed leaves a NaN at its place: it lies on no side of any line and is at no
 * distance, so that searches skip it without a test. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/box.h"

struct dt_cells {
    struct dt_point lo;     /* corner of the box */
    double side, per_unit;  /* of a cell, and how many of them make a unit */
    bool upright;           /* lines run along y instead of x */
    uint32_t lines, length; /* how many lines, of how many cells */
    uint32_t *start;        /* owns lines * length + 1 places: where the run of each cell starts */
    struct dt_cells *sub;   /* owns: the cells of crowded cells, in the order of the latter */
    uint32_t *sub_cell;     /* owns: which cells those are */
    uint32_t subs;
};

struct dt_grid {
    struct dt_point *xy; /* borrows, by place; NaN once removed */
    uint32_t *from;      /* borrows, by place: the index of the point in the caller's array */
    uint32_t n;
    struct dt_stop *stop; /* borrows; limits what building it and searches cost; NULL: no limit */
    struct dt_cells top;  /* owns */
    const struct dt_observer *observer; /* borrows; is told of searches, in places; may be NULL */
};

/* Builds the grid of n >= 1 distinct points. *g must be zeroed or cleared, except stop. xy[n] and from[n] are the
 * caller's, filled here and borrowed until dt_grid_clear. DT_NOMEM, or the reason to stop, leave *g cleared. Cost:
 * O(n log n) at worst, linear on all but very skewed sets; 24 bytes of memory a point. */
enum dt_status dt_grid_build(struct dt_grid *g, const struct dt_point *in, uint32_t n,
                             struct dt_point *xy, uint32_t *from);
void dt_grid_clear(struct dt_grid *g);

/* The place of a point at or near the middle cell [the paper, "Finding a start point and the first
 * edge"]. Any point, if it has to stop. */
uint32_t dt_grid_middle(struct dt_grid *g);

/* The place of the point nearest to the one at `place`; DT_NONE if it is alone. Any other one or none, if
 * it has to stop. Cost: constant expected on evenly spread points. */
uint32_t dt_grid_nearest(struct dt_grid *g, uint32_t place);

/* Subtracts steps, of about a nanosecond each, from stop->left. It polls after a number of steps, not of rounds, because
 * one round may be very long. True: the computation must stop, with DT_TOOBIG if no steps are left; stays true. */
bool dt_grid_spend(struct dt_stop *stop, uint64_t steps);

#define DT_REMOVED __builtin_nan("") /* a NaN that is a double */

/* Removes the point from all later searches. */
static inline void dt_grid_remove(struct dt_grid *g, uint32_t place)
{
    g->xy[place].x = g->xy[place].y = DT_REMOVED;
}

static inline bool dt_grid_removed(const struct dt_grid *g, uint32_t place)
{
    return g->xy[place].x != g->xy[place].x;
}

/* The side of the smallest cell that p falls into: about the distance between the points around p. */
double dt_grid_spacing(const struct dt_grid *g, struct dt_point p);

/* ---- coordinates in cells: monotone, as dt_cell is ---- */

static inline double dt_cells_along(const struct dt_cells *c, struct dt_point p)
{
    return c->upright ? (p.y - c->lo.y) * c->per_unit : (p.x - c->lo.x) * c->per_unit;
}

static inline double dt_cells_across(const struct dt_cells *c, struct dt_point p)
{
    return c->upright ? (p.x - c->lo.x) * c->per_unit : (p.y - c->lo.y) * c->per_unit;
}

static inline uint32_t dt_cells_index(const struct dt_cells *c, struct dt_point p)
{
    return dt_cell(dt_cells_across(c, p), c->lines) * c->length +
           dt_cell(dt_cells_along(c, p), c->length);
}

/* The first of the crowded cells numbered >= cell, as an index into sub and sub_cell. */
uint32_t dt_cells_first_sub(const struct dt_cells *c, uint32_t cell);
