/* table_fields.h - the fields that the points of a file have: their names, and where they come from. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FIELDS_MOST = 64, FIELDS_NAME = 65 };

/* A value that is neither a number nor missing, where a number should be. */
struct odd_value {
    uint64_t line;
    char text[40];
};

struct table_fields {
    bool all;                            /* the caller's: every column of numbers becomes a field */
    char name[FIELDS_MOST][FIELDS_NAME]; /* what the daemon calls them */
    size_t column[FIELDS_MOST];          /* counted from 0; ascending */
    size_t n;
    char height[FIELDS_NAME];          /* the heading or number of the column that is called z */
    uint64_t missing[FIELDS_MOST];     /* points in which there is no number */
    struct odd_value odd[FIELDS_MOST]; /* the first one of each field; line 0: none */
};

/* Takes a column under its heading, of which characters that a name cannot have become '_'; without one (len 0) it is
 * called c1, c2, ... False: there are too many. Names that were taken already get a number. */
bool table_fields_add(struct table_fields *t, size_t column, const char *heading, size_t len);

/* Remembers a text that is no number of field k, unless it says that the value is missing or there was one before. */
void table_fields_note_odd(struct table_fields *t, size_t k, uint64_t line, const char *text,
                           size_t len);

/* The same as table_fields_add for the column of heights, which is called z. */
bool table_fields_add_height(struct table_fields *t, size_t column, const char *heading,
                             size_t len);
