/* daemon.h - a real daemon for a test: $DELAUNAYD on a free port, gone when the test ends. */
#ifndef TESTS_CLIENTS_DAEMON_H
#define TESTS_CLIENTS_DAEMON_H

#include <sys/types.h>

struct daemon {
    pid_t pid;
    char port[8];
};

/* Starts one and waits until it is ready. */
struct daemon daemon_start(void);

/* Ends it with SIGTERM; it must leave with status 0. */
void daemon_stop(struct daemon *d);

/* A connection of its own; the caller closes it. */
int daemon_connect(const struct daemon *d);

#endif
