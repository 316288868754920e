/* points_file.h - reads a file of points: lines `x y`, blank ones and those that start with '#'
 * skipped; or whatever f->parse_line makes of a line (table_file.h); or GeoJSON. */
#ifndef CLIENTS_POINTS_FILE_H
#define CLIENTS_POINTS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct points_file {
    double *xy; /* owns 2n */
    size_t n, cap;
    uint64_t line; /* lines read so far; the last one's number, from 1 */
    /* Reads one line, its number in f->line, which may be changed meanwhile; NULL: `x y`. */
    bool (*parse_line)(struct points_file *f, const char *s, const char *end);
    void *parser;      /* borrows: what parse_line keeps from line to line */
    const char *fault; /* why points_file_read returned false: a static sentence, about line `line`
                          if that is not 0 */
};

/* Called now and then with the bytes and points read so far. */
typedef void points_file_progress_fn(void *ctx, uint64_t bytes, size_t points);

/* Reads all of the open file fd. False at the first bad line, on a read error (errno tells) or out
 * of memory. *f must be zeroed and is the caller's to free, whatever the outcome. Memory: 16 bytes
 * a point, doubled while growing. */
bool points_file_read(struct points_file *f, int fd, points_file_progress_fn *progress, void *ctx);

/* Appends the point that two words say. False, with the fault told, if they do not. */
bool points_file_add(struct points_file *f, const char *x, size_t x_len, const char *y,
                     size_t y_len);
bool points_file_fault(struct points_file *f, const char *what);

/* The same for a file of GeoJSON: every Point and MultiPoint in it, in any Feature or collection,
 * in order; other geometries are faults. Reads the whole file into memory. */
bool points_file_read_geojson(struct points_file *f, int fd);

void points_file_free(struct points_file *f);

#endif
