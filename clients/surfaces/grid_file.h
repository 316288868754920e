/* grid_file.h - a raster of values, and its files: ESRI's ASCII grid, and raw values (BIL) with a header. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct grid {
    double x0, y0, cell; /* lower left corner; the side of a square cell */
    uint32_t columns, rows;
    double *value; /* columns * rows, the northernmost row first; nan: none */
};

/* The coordinates of the right and the upper edge. */
double grid_right(const struct grid *g);
double grid_top(const struct grid *g);

/* The least and the greatest value; false if there is none. */
bool grid_range(const struct grid *g, double *least, double *most);

/* An ASCII grid. Values are written so that they read back as the same double. ferror() shows whether writing failed. */
void grid_write_asc(FILE *out, const struct grid *g);

/* The values as 32-bit floats, little-endian; and the header that says so. */
void grid_write_bil(FILE *out, const struct grid *g);
void grid_write_hdr(FILE *out, const struct grid *g);

/* A world file: where a picture lies whose upper left corner is at x, y and whose pixels are this wide and high. */
void world_write(FILE *out, double wide, double high, double x, double y);
