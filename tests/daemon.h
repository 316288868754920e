/* daemon.h - starts a daemon for a test: $DELAUNAYD on a free port of the loopback address. It ends with
 * the test. Any failure ends the test. */
#pragma once

#include <sys/types.h>

struct daemon {
    pid_t pid;
    unsigned port;
    char port_text[8]; /* the same in digits */
};

/* Starts a daemon with these further arguments (NULL-terminated; NULL for none) and waits for its ready
 * line. */
struct daemon daemon_start(const char *const *arguments);

/* Sends the signal, waits, returns the exit status (-1: it was killed). */
int daemon_stop(const struct daemon *d, int sig);

/* Stops it with SIGTERM; its exit status must be 0. */
void daemon_end(const struct daemon *d);

/* Connects; the caller closes. */
int daemon_connect(const struct daemon *d);
