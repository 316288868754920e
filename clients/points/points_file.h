/* points_file.h - the points and lines of a file in memory, their values, and what was wrong with the file. Readers of formats fill it
 * in (table_file.h, geojson_file.h). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/points/paths.h"
#include "clients/reading/report.h"

enum { SKIPPED_SHOWN = 5 };

struct points_file {
    double *xy; /* owns 2n */
    size_t n, cap;
    double *value; /* owns n * fields: what else is known of each point; nan: missing */
    size_t fields; /* to be set before the first point */
    /* borrows `fields` values for the point that is read next; NULL: none known */
    const double *row;
    struct paths paths; /* owns */
    uint64_t line;      /* lines read so far; the last one's number, from 1 */
    /* why reading failed: a sentence, about line `line` if that is not 0; static or in `text` */
    const char *fault;
    char text[1200];
    bool skip_bad; /* bad lines are counted and left out */
    bool fatal;    /* the fault is not one of a single line */
    uint64_t skipped;
    struct {
        uint64_t line;
        char fault[80], text[60]; /* the fault, and the beginning of the line */
    } skip[SKIPPED_SHOWN];        /* the first ones */
    struct report report;         /* what the user should know, whether reading succeeds or not */
};

/* Appends a point with the values f->row. False, with the fault set, if a coordinate is out of the server's range, or out of
 * memory. Memory: 16 bytes a point and 8 a value, doubled while growing. */
bool points_file_append(struct points_file *f, double x, double y);

/* Appends the point that two words give. False, with the fault set, if they are not numbers. */
bool points_file_add(struct points_file *f, const char *x, size_t x_len, const char *y,
                     size_t y_len);

/* Begin a path at this line; make the point that was appended last its next corner; end it; choose the number of a line or polygon.
 * False, with the fault set, when out of memory or of numbers. A path that ends where it began is closed, and its last place is no point of
 * its own; a ring of a polygon is closed in any case. */
bool points_file_begin_path(struct points_file *f, bool border, uint32_t number, uint64_t feature);
bool points_file_corner(struct points_file *f);
void points_file_end_path(struct points_file *f, bool polygon);
bool points_file_number(struct points_file *f, uint32_t *number);

/* Return false and set the fault: of this line, the second one from a format; of the file as a whole. */
bool points_file_fault(struct points_file *f, const char *what);
__attribute__((format(printf, 2, 3))) bool points_file_bad(struct points_file *f,
                                                           const char *format, ...);
__attribute__((format(printf, 2, 3))) bool points_file_stop(struct points_file *f,
                                                            const char *format, ...);

/* Counts what has just failed, the text s[len], as skipped; false if it may not be skipped. */
bool points_file_skip(struct points_file *f, const char *s, size_t len);

/* Reads all of fd into *text, which must be NULL and is the caller's to free. False with a fault. */
bool points_file_read_all(struct points_file *f, int fd, char **text, size_t *n);

void points_file_free(struct points_file *f);
