/* plan.h - how a text table is read. The plan is made before any row is read, from all of the first rows. It
 * has the separator of values, the meaning of commas, the line of the heading, and which columns are x, y and fields. A single odd row or
 * missing value decides nothing. */
#pragma once

#include <stdint.h>

#include "clients/reading/headings.h"
#include "clients/reading/number.h"
#include "clients/reading/row.h"

enum { PLAN_COLUMNS = 2048, PLAN_ROWS = 500, PLAN_NAME = 65 };

/* The caller's choices. */
struct wish {
    char name[3][PLAN_NAME]; /* of the columns of x, y and z; "" if they are chosen by number */
    size_t column[3];        /* counted from 0 */
    bool chosen, has_z;      /* columns are chosen; the third one, too */
    bool all;                /* every column of numbers becomes a field */
    bool xy;                 /* rows `x y` and nothing else */
    bool xyz;                /* rows begin with x, y and perhaps z, whatever follows */
    bool node; /* Triangle's .node: `number x y attributes marker` after a line of counts */
    uint64_t skip_lines; /* the first lines do not count */
};

enum column_role { COLUMN_UNUSED, COLUMN_X, COLUMN_Y, COLUMN_POINT, COLUMN_HEIGHT, COLUMN_FIELD };

struct column {
    enum column_role role; /* COLUMN_POINT: a geometry `POINT (x y)` */
    char heading[PLAN_NAME];
    /* Of the values in the first rows: */
    size_t numbers, degrees, points, missing, texts; /* of each kind */
    size_t solid;                                    /* points that have a third coordinate */
    size_t decimals, units, quoted;                  /* of the numbers; quoted ones of all */
    double least, greatest, last, step;              /* numbers */
    bool even;                /* all steps between the numbers are the same */
    bool ascending, counting; /* each number is greater than, 1 more than, the last */
    char text[40];            /* the first one that is not a number */
    uint64_t text_line;
    char unit[12]; /* the first one's */
};

struct plan {
    struct row_style row;
    struct number_style number;
    struct column *column; /* owns `columns` */
    size_t columns, x, y;  /* x == y: the column has geometries */
    bool geometry;
    bool headed, comment; /* there is a heading, in line heading_line; it is a comment */
    bool any_length;      /* rows may have more columns than others */
    bool exact;           /* rows must have as many columns as others, or values may be elsewhere */
    size_t text;          /* a column of text; a number in it means a shifted row; SIZE_MAX: none */
    bool obvious;         /* nobody needs to be told which columns are x and y */
    uint64_t heading_line;  /* 0: none */
    uint64_t first_line;    /* where the rows of values begin */
    enum heading_pair pair; /* of x and y, if headed */
    bool reversed[2];       /* x counts to the west, y to the south */
    bool depth;             /* the column of heights has depths */
    uint64_t fault_line;
    char fault[1200]; /* why plan_make failed */
};
