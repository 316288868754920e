/* shapes.h - Voronoi cells and contour lines, as the rows of VORONOI and CONTOUR say them. */
#ifndef CLIENTS_SHAPES_H
#define CLIENTS_SHAPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum shape_kind {
    SHAPE_CELL,   /* a row `id k x1 y1 ... xk yk` */
    SHAPE_CONTOUR /* a row `level closed|open k x1 y1 ... xk yk` */
};

struct shape {
    double key; /* the id or the level */
    bool closed;
    size_t first, n; /* its corners in xy */
};

struct shapes {
    enum shape_kind kind;
    struct shape *shape; /* owns n, room for cap */
    size_t n, cap;
    double *xy; /* owns 2 * corners, room for 2 * corners_cap */
    size_t corners, corners_cap;
    const char *fault; /* why shapes_take returned false: a static sentence */
};

/* Takes a row; one without corners is left out. *s must be zeroed but for its kind. */
bool shapes_take(struct shapes *s, const char *row, size_t len);
void shapes_free(struct shapes *s);

/* The box around all of them; false if there are none. */
bool shapes_bounds(const struct shapes *s, double *box);

/* A FeatureCollection: Polygons with the property id, LineStrings with level and closed; a closed line ends where it
 * begins. ferror() shows whether writing failed. */
void shapes_write_geojson(FILE *out, const struct shapes *s);

/* A table with a column WKT, and id, or level and closed. */
void shapes_write_wkt(FILE *out, const struct shapes *s);

#endif
