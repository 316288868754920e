/* made.h - cells that have been made all at once, to be read by their ids (dt_cells_make). */
#ifndef DT_MADE_H
#define DT_MADE_H

#include "core/cells/cell.h"
#include "core/delaunay_surface.h"

struct dt_circumcentres;

/* The corners of a cell: `corners` of them from `at` on. */
struct dt_made {
    uint32_t at, corners; /* corners DT_NONE: there is no cell of that id */
};

enum { DT_MADE_PENDING = 64 };

struct dt_cells_made {
    struct dt_box box;
    bool areas;           /* these are kept instead of the cells: */
    double *area;         /* owns `ids`, by id; NaN: there is no cell of that id */
    struct dt_made *cell; /* owns `ids`, by id */
    struct dt_point *
        corner; /* owns cap, in the order in which the cells were made; of areas, of the `pending` last ones */
    uint32_t ids, cells; /* cells: how many there will be */
    size_t corners, cap;
    /* while they are made */
    uint32_t vertex;                 /* the next one */
    struct dt_circumcentres *centre; /* owns */
    struct dt_cell_work work;
    struct dt_cell last[DT_MADE_PENDING]; /* cells whose areas have not been computed yet */
    uint32_t pending;
};

/* As dt_cells_read, for a cursor whose cells have been made. */
enum dt_status dt_made_read(struct dt_cells *c, struct dt_cell *cell, size_t room,
                            struct dt_point *corner, size_t cap, size_t *n, size_t *corners);

#endif
