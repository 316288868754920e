/* table_fields.h - which further columns of a table are loaded as fields, and their values in each row. */
#ifndef CLIENTS_TABLE_FIELDS_H
#define CLIENTS_TABLE_FIELDS_H

#include <stdint.h>

#include "clients/files/points_file.h"
#include "clients/files/table_row.h"

enum { FIELDS_MOST = 64, FIELDS_NAME = 65 };

struct table_fields {
    bool all; /* the caller's: every column whose first value is a number, or missing */
    char name[FIELDS_MOST][FIELDS_NAME]; /* what the daemon calls them */
    size_t column[FIELDS_MOST];          /* counted from 0; ascending */
    size_t n;
    char
        height[FIELDS_NAME]; /* the heading, or the number from 1, of the column that is called z */
    uint64_t missing[FIELDS_MOST]; /* rows in which the value is not a number */
    double row[FIELDS_MOST];       /* the values of the row that is being read */
};

/* Takes a column under its heading, of which characters that a name cannot have become '_'; without one (len 0) it is
 * called c1, c2, ... False: there are too many. Names that were taken already get a number. */
bool table_fields_add(struct table_fields *t, size_t column, const char *heading, size_t len);

/* The same for the column of heights, which is called z. */
bool table_fields_add_height(struct table_fields *t, size_t column, const char *heading,
                             size_t len);

/* Takes from the header s .. end, but for the columns of x and y, the first that names heights, unless a column has been
 * taken already; with `all` the others, too. */
void table_fields_add_headings(struct table_fields *t, const char *s, const char *end,
                               char separator, const size_t *xy);

/* The same for a table of this number of columns without a header; height: the third column has heights. */
void table_fields_add_numbers(struct table_fields *t, size_t columns, bool height,
                              const size_t *xy);

/* To be called when all have been added. */
void table_fields_sort(struct table_fields *t);

/* Drops the columns, but for `keep`, that have some other text in the first row of values. */
void table_fields_check(struct table_fields *t, const char *s, const char *end, char separator,
                        size_t keep);

/* Reads the values of a row into t->row, nan where there is no number. */
void table_fields_read(struct table_fields *t, const char *s, const char *end, char separator);

/* Counts what is missing in t->row. */
void table_fields_count(struct table_fields *t);

#endif
