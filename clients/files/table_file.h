/* table_file.h - points from tables: CSV and its relatives, with columns chosen by heading, name or
 * number, and Triangle's .node files. */
#ifndef CLIENTS_TABLE_FILE_H
#define CLIENTS_TABLE_FILE_H

#include "clients/files/points_file.h"
#include "clients/files/table_fields.h"

enum { TABLE_NAME_LIMIT = 64, TABLE_COMMENT_ROOM = 500 };

struct table_file {
    char name[3]
             [TABLE_NAME_LIMIT]; /* of the columns of x, y and z; "" if they are chosen by number */
    size_t column[3];            /* counted from 0 */
    struct table_fields fields;
    size_t columns;        /* of the first row */
    char separator;        /* 0 until the first row has been seen; ' ' for blanks */
    bool chosen;           /* the caller has named or numbered the columns */
    bool has_z;            /* and the third one */
    bool node;             /* a .node file: `number x y ...` after a header of counts */
    bool xyz;              /* more columns than x and y are usual */
    bool any_length;       /* a row may be longer than the first one */
    bool started;          /* the first row has been read */
    bool has_values;       /* the first row of values has been read */
    bool headless, report; /* for `using`: there is no header; the columns are not obvious */
    bool counting;         /* no header: the first column may be a number of the row */
    double count;          /* its last value */
    size_t counted;        /* rows in which it did count */
    char using[5 * TABLE_NAME_LIMIT + 80]; /* which columns were taken, "" where that is obvious */
    char comment[TABLE_COMMENT_ROOM];      /* the last one before the first row */
};

/* Reads "X,Y" or "X,Y,Z", names or numbers counted from 1. False if it is neither. */
bool table_choose_columns(struct table_file *t, const char *text);

/* Makes f read lines of such a table; *t must be zero but for what the caller chose. Values are separated by
 * tabs, semicolons, vertical bars, commas or blanks, whichever the first row has, and may be quoted, with
 * line breaks inside. With semicolons, numbers may have decimal commas. If the first row has no numbers it is the
 * header, whose headings choose the columns unless the caller did (headings.h); headings that name no
 * coordinates are a fault. So they are in a comment before the first row. Without a header the columns are the
 * first two.
 *
 * Heights become the field z: a third column that the caller chose, one whose heading says so, and without a header the
 * third of three or, in an xyz file, of more. With t->fields.all every other numeric column becomes a field, too. */
void table_file_init(struct table_file *t, struct points_file *f);

#endif
