/* cell.h - one Voronoi cell, clipped to a box, as a polygon.
 *
 * The polygon begins as the whole cell with its far corners. A far corner is at infinity in the direction of a hull edge's
 * normal: a coordinate that grows along the ray is infinite. Four half planes, the sides of the box, cut the polygon.
 * Every corner has the edge that begins at it: the neighbour, side or infinity beyond the edge.
 *
 *              n1         corner      edge that begins there
 *            \    /       c0          bisector of the site and n1
 *        n0   c0-         c1          bisector of the site and n2
 *           site   n2     ...
 *            / c1-
 *
 * Corners are exact places rounded once (centre.h), and each is kept or cut by its rounded coordinates; one on a side
 * is kept. Cells that share an edge have the same two corners there, so they decide the same. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/box.h"
#include "core/exact/lanes.h"

enum dt_cell_kind {
    DT_CELL_INSIDE,  /* of an interior point */
    DT_CELL_ON_HULL, /* its ring goes from its successor to its predecessor */
    DT_CELL_ON_LINE  /* all points are on one line: one or two neighbours, or none */
};

/* A corner, and the edge that begins at it: the number of a neighbour of the ring, or one of these. */
#define DT_EDGE_SIDE (DT_NONE - 1) /* of the box */
#define DT_EDGE_FAR DT_NONE        /* at infinity */

struct dt_cell_corner {
    struct dt_point at;
    uint32_t edge;
};

/* The work space in which cells are computed one after the other. Start with {0}. */
struct dt_cell_work {
    struct dt_point *ring;         /* owns ring_cap: the neighbours, for the caller to fill in */
    struct dt_point *centre;       /* owns ring_cap: circumcentres */
    struct dt_point *polygon;      /* owns cap: the n corners */
    struct dt_cell_corner *corner; /* owns cap: the same while they are cut */
    struct dt_cell_corner *other;  /* owns cap */
    uint32_t ring_cap, n, cap;
    struct dt_stop *stop; /* borrows; polled; NULL: none. Stopped: cells have no corners */
};

/* Corners beyond those of the ring, at most: those at infinity and two of each side. */
enum { DT_CELL_MORE = 16 };

void dt_cell_clear(struct dt_cell_work *w);

size_t dt_cell_memory(const struct dt_cell_work *w);

/* Makes room for the ring. False: out of memory. */
bool dt_cell_reserve(struct dt_cell_work *w, uint32_t degree);

/* Makes w->polygon the cell of the site with the neighbours w->ring[degree], counterclockwise, without equal corners in a
 * row. The polygon has at least three corners. It has none if the cell has fewer, or if all are on one side of the box.
 * It begins with the least corner, by x, then y. Cost: O(degree). */
void dt_cell_make(struct dt_cell_work *w, struct dt_point site, uint32_t degree,
                  enum dt_cell_kind kind, const struct dt_box *box);

/* The same for an interior point whose circumcentres are already in w->centre[degree]: centre i is the corner between
 * neighbours i and i + 1. */
void dt_cell_make_around(struct dt_cell_work *w, struct dt_point site, uint32_t degree,
                         const struct dt_box *box);

enum { DT_CELL_USUAL = 8 }; /* corners: nearly all cells have at most so many */

/* Writes the cell of an interior point to polygon[n], if its corners are exactly the circumcentres centre[n]. least and most are
 * the least and the greatest of each coordinate. False: a centre is not inside the box, or equals the one before, or two have
 * the least x, or there are very many. Behind either array there must be room for DT_CELL_USUAL more, which are
 * written: loops whose ends are the same each time are faster. */
bool dt_cell_make_plain(struct dt_point *centre, uint32_t n, dt_lanes least, dt_lanes most,
                        const struct dt_box *box, struct dt_point *polygon);
