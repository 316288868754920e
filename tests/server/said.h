/* said.h - what daemons write on standard error, kept in a file.
 *
 *     struct said said = said_begin();
 *     struct daemon d = daemon_start(NULL);
 *     said_end(&said);
 *     ...
 *     said_await(&said, "warning: ", 1);
 *
 * A daemon's lines are written by a thread of their own, so they may come after the reply to the request that caused them. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct said {
    FILE *file;
    int before; /* where standard error went */
};

/* From now on standard error, which daemons inherit, goes to a new file. */
struct said said_begin(void);

/* Standard error goes to where it went before; daemons that run keep the file. */
void said_end(const struct said *s);

/* The number of lines until now that contain `text`. */
unsigned said_lines(const struct said *s, const char *text);

/* Waits until n lines contain `text`. */
void said_await(const struct said *s, const char *text, unsigned n);
