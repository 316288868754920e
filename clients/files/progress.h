/* progress.h - a progress bar on the standard error, if that is a terminal. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct progress {
    const char *what;      /* borrows: "reading", "sending" */
    bool shown;            /* whether it is a terminal */
    double started, drawn; /* seconds */
};

void progress_start(struct progress *p, const char *what);

/* done of total (0: unknown) units of work, points among them so far. Draws at most ten times a
 * second. */
void progress_update(struct progress *p, uint64_t done, uint64_t total, uint64_t points);

/* Clears the line. */
void progress_end(struct progress *p);
