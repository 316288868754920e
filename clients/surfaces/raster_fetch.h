/* raster_fetch.h - a raster of square cells of a surface, fetched from a daemon with RASTER ... BINARY. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/surfaces/grid_file.h"

enum { RASTER_MOST_COLUMNS = 1000000, RASTER_USUAL_COLUMNS = 1000 };

struct raster_request {
    bool has_box;
    double box[4];        /* left, lower, right, upper; without it, the bounding box of the hull */
    double cell;          /* side of a cell; 0: `columns` decide */
    uint32_t columns;     /* across the box; 0: RASTER_USUAL_COLUMNS along its longer side */
    uint32_t most_rows;   /* where it is not 0, cells are larger if there would be more */
    const char *method;   /* NULL: linear */
    double max_edge;      /* 0: any */
    const char *inside;   /* the number of a border, or any; NULL: everywhere */
    const char *outside;  /* nan or nearest; NULL: nan */
    const char *missing;  /* nan or skip; NULL: nan */
    const char *quantity, /* slope or aspect in degrees; NULL: the values */
        *clip;      /* the name of a set, inside whose borders there are values; NULL: everywhere */
    double squeeze; /* cells are 1 / squeeze as wide as high; 0: as wide */
};

/* The grid: cells begin at the lower left corner of the box and cover it. DELAUNAY_STOPPED: *fault says why, a static
 * sentence. On success the caller frees the values with raster_free. */
enum delaunay_result raster_fetch(struct delaunay_client *c, const char *set, const char *field,
                                  const struct raster_request *request, struct grid *g,
                                  const char **fault);
void raster_free(struct grid *g);

/* The box around a triangulated set, from HULL. DELAUNAY_STOPPED: *fault says why. */
enum delaunay_result raster_bounds(struct delaunay_client *c, const char *set, double *box,
                                   const char **fault);

/* Chooses cells for the box: g without values. False: they would be too many, or the box has no area. */
bool raster_plan(const struct raster_request *request, const double *box, struct grid *g);
