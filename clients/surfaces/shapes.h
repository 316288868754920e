/* shapes.h - Voronoi cells, contour lines and bands, as the rows of VORONOI and CONTOUR say them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "clients/meshes/crs.h"

enum shape_kind {
    SHAPE_CELL,    /* a row `id k x1 y1 ... xk yk` */
    SHAPE_CONTOUR, /* a row `level closed|open k x1 y1 ... xk yk` */
    SHAPE_BAND,    /* a row `low high number outer|hole k x1 y1 ... xk yk` */
    SHAPE_RING     /* of an alpha shape, from rings_to_shapes */
};

struct shape {
    double key;  /* the id, the level, of a band the lower one, or the radius */
    double high; /* of a band the upper level */
    bool closed;
    bool hole;       /* of the polygon whose outer ring is before it */
    size_t first, n; /* its corners in xy */
};

struct shapes {
    enum shape_kind kind;
    struct shape *shape; /* owns n, room for cap */
    size_t n, cap;
    double *xy; /* owns 2 * corners, room for 2 * corners_cap */
    size_t corners, corners_cap;
    const struct crs *crs; /* the caller's: of the coordinates; may be NULL */
    const char *fault;     /* why shapes_take returned false: a static sentence */
};

/* Appends a shape whose corners are the places corner[shape->n] in xy, which are copied; shape->first is ignored. False: see s->fault. */
bool shapes_add(struct shapes *s, const struct shape *shape, const uint32_t *corner,
                const double *xy);

/* Takes a row; one without corners is left out. *s must be zeroed, except its kind. */
bool shapes_take(struct shapes *s, const char *row, size_t len);
void shapes_free(struct shapes *s);

/* The number of shapes from i on that are one polygon, an outer ring with its holes; 1 for cells and lines. */
size_t shapes_rings(const struct shapes *s, size_t i);

/* The number of polygons or lines. */
size_t shapes_count(const struct shapes *s);

/* A FeatureCollection: Polygons with the property id, with low and high, null if they are infinite, or with radius and holes; LineStrings
 * with level and closed. A closed line and a ring end where they begin. ferror() shows whether writing failed. */
void shapes_write_geojson(FILE *out, const struct shapes *s);

/* A table with a column WKT, and the same columns. */
void shapes_write_wkt(FILE *out, const struct shapes *s);
