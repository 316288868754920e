/* all_cells.h - cells that have been made all at once, to be read by their ids (dt_cells_make). */
#pragma once

#include "core/delaunay_surface.h"

/* As dt_cells_read, for a cursor whose cells have been made. */
enum dt_status dt_all_cells_read(struct dt_cells *c, struct dt_cell *cell, size_t room,
                                 struct dt_point *corner, size_t cap, size_t *n, size_t *corners);
