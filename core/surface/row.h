/* row.h - rows of cells of a raster, each a line from west to east.
 *
 * It crosses the triangles one after the other, each from an edge that goes down, as seen from the triangle, to one
 * that goes up:
 *
 *              above                    A corner on the line counts as above it, so the line passes between
 *             /  |  \                   corners, and where it goes on from a triangle follows from one comparison
 *       -----/---|---\-------- y        of a y. Which triangle a cell is in is decided by the side of the edge up
 *           /    |    \                 on which it is: exactly.
 *       below----+-----below
 *
 * A cell on an edge or at a corner is looked up by itself, and so is the first cell of a row, one after many
 * triangles without any, and those outside the hull. */
#ifndef DT_ROW_H
#define DT_ROW_H

#include "core/surface/value.h"

enum {
    DT_ROW_PATIENCE = 32, /* triangles to the next cell; then it is looked up */
    DT_TILE = 64          /* columns, and rows at most, of a tile */
};

struct dt_scan {
    struct dt_valuer v;
    struct dt_work work;
    const struct dt_raster *r; /* borrows */
};

/* Where a row is. */
struct dt_row_end {
    uint32_t near;    /* a half edge near the last place, DT_NONE: none */
    uint32_t up;      /* the edge by which the row leaves the triangle; DT_NONE: not known */
    uint32_t lookups; /* cells that are looked up without walking first */
    bool beyond;      /* the row has left the hull */
    double x;         /* of the last cell; nan: none */
};

static inline struct dt_row_end dt_row_begin(void)
{
    return (struct dt_row_end){.near = DT_NONE, .up = DT_NONE, .x = (double)NAN};
}

/* Centres of columns and rows. */
double dt_raster_x(const struct dt_raster *r, uint32_t column);
double dt_raster_y(const struct dt_raster *r, uint32_t row);

/* What the value at a place usually takes, in steps. */
static inline uint32_t dt_scan_steps(const struct dt_scan *k)
{
    return k->v.s->how == DT_LINEAR ? 1 : 8;
}

/* Looks up the value at q. */
enum dt_status dt_scan_look_up(struct dt_scan *k, struct dt_point q, uint32_t near,
                               enum dt_where *where, uint32_t *half, double *out);

/* The value of the next cell of the row, at q. Cost: the number of triangles up to it. */
enum dt_status dt_row_cell(struct dt_scan *k, struct dt_row_end *e, struct dt_point q, double *out);

/* The cells of a row from the column `from` on, n of them or up to its end; adds those that are written to *done. */
enum dt_status dt_row_scan(struct dt_scan *k, uint32_t row, uint32_t from, size_t n, double *out,
                           size_t *done);

/* All cells of up to DT_TILE rows, a tile of them after the other, so that what one row has read is still in the cache
 * when the next one reads it. Adds to *done the cells that are written or, if it ends early, those of the first row; others
 * will be written again. */
enum dt_status dt_tiles_scan(struct dt_scan *k, uint32_t row, uint32_t rows, double *out,
                             size_t *done);

/* Whether the columns are so wide that the next one is possible. */
bool dt_rows_go_abreast(const struct dt_raster *r);

/* n linear values from the cell `from` on, the same as by dt_row_scan, several rows side by side (abreast.c). Adds the cells of
 * rows that are complete to *done; DT_TOOLONG: too few steps are left, or one takes long by itself. */
enum dt_status dt_rows_scan(struct dt_scan *k, uint64_t from, size_t n, double *out, size_t *done);

#endif
