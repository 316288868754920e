/* daemon.h - a daemon of its own for a test: $DELAUNAYD on a free port of the loopback address. It
 * goes when the test goes. Whatever fails ends the test. */
#ifndef TESTS_DAEMON_H
#define TESTS_DAEMON_H

#include <sys/types.h>

struct daemon {
    pid_t pid;
    unsigned port;
    char port_text[8]; /* the same in digits */
};

/* Starts one with these further arguments (NULL-terminated; NULL for none) and waits for its ready
 * line. */
struct daemon daemon_start(const char *const *arguments);

/* Sends the signal, waits, returns the exit status (-1: it was killed). */
int daemon_stop(const struct daemon *d, int sig);

/* Ends it with SIGTERM; it must leave with status 0. */
void daemon_end(const struct daemon *d);

/* Connects; the caller closes. */
int daemon_connect(const struct daemon *d);

#endif
