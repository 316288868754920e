/* table_file.h - points from tables: CSV with columns chosen by name or number, and Triangle's
 * .node files. */
#ifndef CLIENTS_TABLE_FILE_H
#define CLIENTS_TABLE_FILE_H

#include "clients/points_file.h"

enum { TABLE_NAME_LIMIT = 64 };

struct table_file {
    char name[2][TABLE_NAME_LIMIT]; /* of the columns of x and y; "" if they are chosen by number */
    size_t column[2];               /* counted from 0 */
    char separator;                 /* 0 until the first row has been seen; ' ' for blanks */
    bool chosen;                    /* the caller has named or numbered the columns */
    bool node;                      /* a .node file: `number x y ...` after a header of counts */
    bool started;                   /* the first row has been read */
};

/* Reads "X,Y", two names or two numbers counted from 1. False if it is neither. */
bool table_choose_columns(struct table_file *t, const char *text);

/* Makes f read lines of such a table; *t must be zero but for what the caller chose. CSV: values
 * are separated by commas, semicolons, tabs or blanks, whichever the first row has, and may be
 * quoted. If the first row holds no numbers in the chosen columns it is the header; without a
 * choice the columns are those headed x and y, lon and lat, longitude and latitude, easting and
 * northing, or else the first two. */
void table_file_init(struct table_file *t, struct points_file *f);

#endif
