/* points_file.h - reads a file of points: lines `x y`, blank ones and those that start with '#'
 * skipped. */
#ifndef CLIENTS_POINTS_FILE_H
#define CLIENTS_POINTS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct points_file {
    double *xy; /* owns 2n */
    size_t n, cap;
    uint64_t line;     /* lines read so far; the last one's number, from 1 */
    const char *fault; /* why points_file_read returned false: a static sentence, about line `line`
                          if that is not 0 */
};

/* Called now and then with the bytes and points read so far. */
typedef void points_file_progress_fn(void *ctx, uint64_t bytes, size_t points);

/* Reads all of the open file fd. False at the first bad line, on a read error (errno tells) or out
 * of memory. *f must be zeroed and is the caller's to free, whatever the outcome. Memory: 16 bytes
 * a point, doubled while growing. */
bool points_file_read(struct points_file *f, int fd, points_file_progress_fn *progress, void *ctx);
void points_file_free(struct points_file *f);

#endif
