/* points_file.h - reads a file of points: lines `x y`, blank ones and those that start with '#'
 * skipped; or lines that f->parse_line reads (table_file.h). */
#ifndef CLIENTS_POINTS_FILE_H
#define CLIENTS_POINTS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/reading/report.h"

enum { SKIPPED_SHOWN = 5 };

struct points_file {
    double *xy; /* owns 2n */
    size_t n, cap;
    double *value; /* owns n * fields: what else is known of each point; nan: missing */
    size_t fields; /* to be set before the first point */
    const double
        *row;      /* borrows `fields` values for the point that is read next; NULL: none known */
    uint64_t line; /* lines read so far; the last one's number, from 1 */
    /* Reads one line, its number in f->line, which may be changed meanwhile; NULL: `x y`. */
    bool (*parse_line)(struct points_file *f, const char *s, const char *end);
    /* The end of the line that begins at s, NULL if it is not before `end`; NULL: at a LF. */
    const char *(*find_end)(const struct points_file *f, const char *s, const char *end);
    void *parser; /* borrows: what parse_line keeps from line to line */
    const char
        *fault; /* why reading failed: a sentence, about line `line` if that is not 0; static or
                          in `text` */
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

/* Called now and then with the bytes and points read so far. */
typedef void points_file_progress_fn(void *ctx, uint64_t bytes, size_t points);

/* Reads all of the open file fd. False at the first bad line, on a read error or out of memory. *f must be
 * zeroed except parser and skip_bad; the caller frees it in any case. Memory: 16 bytes a point, doubled while
 * growing. */
bool points_file_read(struct points_file *f, int fd, points_file_progress_fn *progress, void *ctx);

/* Appends the point that two words give. False, with the fault set, if they are not numbers. */
bool points_file_add(struct points_file *f, const char *x, size_t x_len, const char *y,
                     size_t y_len);

/* Return false and set the fault: of this line; of the file as a whole, from a format. */
bool points_file_fault(struct points_file *f, const char *what);
__attribute__((format(printf, 2, 3))) bool points_file_stop(struct points_file *f,
                                                            const char *format, ...);

/* Counts what has just failed, the text s[len], as skipped; false if it may not be skipped. */
bool points_file_skip(struct points_file *f, const char *s, size_t len);

void points_file_free(struct points_file *f);

#endif
