/* source.h - a file of points and lines as the user specified it: its format, its columns, and whether bad lines are
 * skipped. */
#pragma once

#include "clients/files/survey.h"
#include "clients/files/table_file.h"
#include "clients/points/points_file.h"

enum source_form {
    SOURCE_XY,
    SOURCE_TABLE,
    SOURCE_GEOJSON,
    SOURCE_NODE,
    SOURCE_GPX,
    SOURCE_LAS,  /* LAZ, too */
    SOURCE_POLY, /* Triangle's */
    SOURCE_OBJ,
    SOURCE_GRID, /* an ASCII grid, or a raster that GDAL reads */
    SOURCE_GUESS
};

struct source {
    const char *path;
    enum source_form form; /* SOURCE_GUESS: the ending and the first bytes decide */
    struct table_file table;
    bool skip_bad;
    bool geographic;       /* after reading: GeoJSON, or a raster, has longitudes and latitudes */
    bool points_only;      /* the lines of the file do not count */
    bool lines_border;     /* lines are borders, as polygons are */
    uint32_t first_number; /* of the first line or polygon that the file does not number */
    struct survey_wish wish;
    char message[1400]; /* after a failure: the file, the line and why */
};

/* Reads a format's name. */
bool source_read_form(const char *name, struct source *s);

/* Whether the headings or the format say that x and y are longitudes and latitudes, and they can be. */
bool source_is_geographic(const struct source *s, const struct points_file *f);

/* The path, or a name for the standard input. */
const char *source_name(const struct source *s);

/* Reads the file into *f, which must be zeroed and is the caller's to free. Prints on the standard error which
 * columns were used if that is not obvious, f->report, what was skipped, and the fault if it returns false. */
bool source_read(struct source *s, struct points_file *f);
void source_free(struct source *s);
