/* survey.h - looks at the points of a file after reading: ranges, missing values, coincident points, and what may be wrong with
 * them. */
#pragma once

#include "clients/files/table_file.h"
#include "clients/points/points_file.h"

enum { SURVEY_CHANGES = 8 };

/* The changes that the caller wants. */
struct survey_wish {
    double nodata[SURVEY_CHANGES]; /* values of fields that mean: missing */
    size_t nodata_n;
    const char *negate[SURVEY_CHANGES]; /* borrows: x, y or fields whose sign changes */
    size_t negate_n;
};

/* Of x (0), y (1) or a field (2, 3, ...). */
struct range {
    double least, greatest; /* of what is there; nan if nothing is */
    uint64_t missing;
};

struct coincidence {
    uint64_t points;    /* that are where an earlier one is */
    uint64_t different; /* of these, those with other values than the first one there */
    size_t first;       /* the first of these points */
    size_t field;       /* in which its value differs */
};

/* Makes the changes, then adds to f->report what is missing and doubtful; counts t->fields.missing. False with a fault if a
 * field does not exist. */
bool survey(struct points_file *f, struct table_file *t, const struct survey_wish *w);

struct range survey_range(const struct points_file *f, size_t column);

/* Adds to the report that longitudes and latitudes seem to be swapped, if they do: some y are beyond 90, no x is. */
bool survey_note_swapped(struct points_file *f);

/* False if out of memory. Cost: O(n). */
bool survey_coincident(const struct points_file *f, struct coincidence *c);

/* Adds to the report where values of coincident points differ; nothing if they do not, or out of memory. */
void survey_note_coincident(struct points_file *f, const struct table_file *t);
