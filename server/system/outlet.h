/* outlet.h - lines for standard error or standard output that are written by a thread of their own.
 *
 *     outlet_put --> line line line --> thread --> write(2)
 *
 * So the caller never waits for a pipe without a reader, a stopped terminal or a disk that stalls. The descriptor stays
 * as it is, because other processes may share it. Lines that find no room, or cannot be written, are counted as lost. Any
 * thread may call; the lock is held for a copy of a line. */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    OUTLET_LINE = 480, /* bytes, and less than a pipe takes at once */
    OUTLET_LINES = 64  /* that may wait to be written */
};

struct outlet_line {
    size_t len;
    uint32_t worth; /* lost lines, if it is lost: 1, or more if it reports lost ones */
    char text[OUTLET_LINE];
};

/* Start with OUTLET(fd). The first line starts the thread, which never ends. */
struct outlet {
    int fd;
    pthread_mutex_t mutex;
    pthread_cond_t came;
    bool started;
    bool torn;      /* the end of the last line was not written */
    unsigned first; /* the line that is written next, or being written */
    unsigned n;     /* lines that wait or are being written */
    uint32_t lost;
    struct outlet_line line[OUTLET_LINES];
};

#define OUTLET(FD)                                                                                 \
    {                                                                                              \
        .fd = (FD), .mutex = PTHREAD_MUTEX_INITIALIZER, .came = PTHREAD_COND_INITIALIZER           \
    }

/* Writes the line text[n], which ends with LF, soon; of a longer one the first OUTLET_LINE bytes. worth: by how much `lost`
 * grows if it cannot be written. */
void outlet_put(struct outlet *o, const char *text, size_t n, uint32_t worth);

/* The number of lines that have been lost since the last call. */
uint32_t outlet_take_lost(struct outlet *o);

/* Waits until all lines have been written, at most `ms` milliseconds. */
void outlet_flush(struct outlet *o, unsigned ms);
