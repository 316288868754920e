/* surface_rows.h - values of a surface as rows: at places, or at the cells of a raster, a piece at a time.
 *
 * A plain value with a position. It needs the whole triangulation of its moment: the set's triangulation until the points
 * are edited, and then the triangulation of a copy (past.h). */
#pragma once

#include "core/delaunay_surface.h"
#include "proto/buf.h"
#include "server/rows/pace.h"
#include "server/rows/row_memory.h"

/* INSIDE: the part inside a border, or inside any border. */
struct inside {
    bool asked;
    uint32_t number; /* DT_NONE: any */
};

/* The source of a surface. */
struct surface_source {
    struct version *version; /* borrows */
    /* borrows: edits of it must wait for jobs that read for long; NULL: nobody edits the version */
    struct dataset *set;
};

struct surface_rows {
    const struct dt *dt;                 /* borrows; the set of the view, or a copy */
    const struct dt_view *view;          /* borrows; NULL: now, or of a copy */
    const struct dt_field *const *field; /* borrows; of dt: `fields` of them */
    size_t fields;
    enum dt_interpolation how;
    double max_edge; /* HUGE_VAL: any */
    struct inside inside;
    bool beyond; /* OUTSIDE nearest */
    enum dt_quantity quantity;
    const struct dt_point *place; /* borrows; NULL: the cells of the raster */
    const uint8_t *kept;          /* borrows; bits of the cells that are kept; NULL: all */
    struct dt_raster raster;
    size_t columns; /* places in a row; each has the numbers of all fields */
    bool binary;
    size_t at, end; /* places whose numbers have been written; of all */
    double *value; /* owns: the numbers of the next `found` places, of rows that are not complete */
    size_t found;
    size_t room; /* bytes of `value`, if it is not NULL */
    /* the points, or borders that count, have been edited since the view began: nothing was written */
    bool passed;
};

/* The bytes of a piece, about. */
enum { SURFACE_PIECE = 256 * 1024 };

/* Appends rows until out holds `limit` bytes or more, all are written, or the bound of the pace is reached: as
 * rows_fill. Only reads the set. DT_NOMEM, DT_CANCELLED. */
enum dt_status surface_rows_fill(struct surface_rows *r, struct buf *out, size_t limit,
                                 struct pace *pace, struct reservation *memory);

/* The bytes that the next piece takes at most, its values and their text; and those of the workspace now. */
size_t surface_rows_piece(const struct surface_rows *r);
size_t surface_rows_memory(const struct surface_rows *r);

/* Splits off the next rows, about SURFACE_PIECE bytes: as rows_cut. */
bool surface_rows_cut(struct surface_rows *r, struct surface_rows *part);

/* Frees the workspace. */
void surface_rows_clear(struct surface_rows *r);
