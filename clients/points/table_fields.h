/* table_fields.h - the fields that the points of a file have: their names, and where they come from. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FIELDS_MOST = 64, FIELDS_NAME = 65 };

struct table_fields {
    bool all;                            /* the caller's: every column of numbers becomes a field */
    char name[FIELDS_MOST][FIELDS_NAME]; /* what the daemon calls them */
    size_t column[FIELDS_MOST];          /* counted from 0; ascending */
    size_t n;
    char height[FIELDS_NAME];      /* the heading or number of the column that is called z */
    uint64_t missing[FIELDS_MOST]; /* points in which there is no number */
};

/* Takes a column under its heading, of which characters that a name cannot have become '_'; without one (len 0) it is
 * called c1, c2, ... False: there are too many. Names that were taken already get a number. */
bool table_fields_add(struct table_fields *t, size_t column, const char *heading, size_t len);

/* The same for the column of heights, which is called z. */
bool table_fields_add_height(struct table_fields *t, size_t column, const char *heading,
                             size_t len);
