/* raster_rows.h - rows of cells of a raster, each a line from west to east, several side by side.
 *
 * A row crosses the triangles one after the other, each from an edge that goes down, as seen from the triangle, to one
 * that goes up:
 *
 *              above                    A corner on the line counts as above it, so the line passes between
 *             /  |  \                   corners, and where it goes on from a triangle follows from one comparison
 *       -----/---|---\-------- y        of a y. Which triangle a cell is in is decided by the side of the edge up
 *           /    |    \                 on which it is: exactly.
 *       below----+-----below
 *
 * A cell on an edge or at a corner is looked up by itself. The first cell of a row, some cells after many triangles
 * without cells, and cells to the west of the hull are, too. */
#pragma once

#include "core/surface/value.h"

/* Whether the columns are so wide that dt_rows_scan is possible. */
bool dt_rows_suit(const struct dt_raster *r);

/* The values of n cells from the cell `from` on. Adds the cells of rows that are complete to *done; DT_TOOLONG: too few
 * steps are left, or a cell takes long by itself. Cost: the number of cells and of triangles along their rows. */
enum dt_status dt_rows_scan(struct dt_valuer *v, const struct dt_raster *r, uint64_t from, size_t n,
                            double *out, size_t *done);
