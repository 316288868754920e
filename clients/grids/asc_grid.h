/* asc_grid.h - ASCII grids of heights [ESRI, "Esri ASCII raster format"]: a header of words and numbers, then the values of the cells, the
 * northernmost row first. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"

/* Where the cells of a grid lie. The centre of cell (c, r) is at origin + (first[0] + c) * column + (first[1] + r) * row. */
struct grid_frame {
    uint32_t columns, rows;
    double origin[2];
    double column[2], row[2]; /* the steps to the next column, and to the next row, in x and y */
    double first[2];          /* the centre of the first cell, in steps from the origin */
    bool geographic;          /* x and y are longitude and latitude */
    bool scaled;              /* the values are to be scaled, other than the one that means: none */
};

struct grid_notes {
    struct grid_frame frame;
    double nodata;  /* the value that means: none */
    uint64_t empty; /* cells without a value, which are left out */
};

/* Whether a file begins with a word of the header and a number; n bytes of it are known. */
bool asc_begins(const char *text, size_t n);

/* Reads the centres of the cells as points with the field z, and adds that field to *t. A coordinate is the double nearest to the sum above
 * where column[1] and row[0] are 0. Cells without a value are left out: nan, the NODATA_value (-9999 if the header has none), and words
 * such as NA. A value that is the NODATA_value rounded to a float counts as that; of large ones the first 24 bits count, because some
 * programs write only these. With a frame, that says where the cells lie, and text behind the last value is passed over. False with a fault
 * that names the row and the column. Cost: O(n). */
bool asc_text_read(struct points_file *f, const char *text, size_t n,
                   const struct grid_frame *frame, struct table_fields *t,
                   struct grid_notes *notes);

/* The same for the file fd, of which a block is in memory at a time. */
bool asc_file_read(struct points_file *f, int fd, const struct grid_frame *frame,
                   struct table_fields *t, struct grid_notes *notes);

/* Writes how the file was read, for instance "the centres of 30 x 20 cells of 0.5 x 0.5". */
void grid_describe(const struct grid_notes *notes, char *to, size_t room);
