/* private_daemon.h - a private daemon for one task (delaunayd --private): in memory, on a Unix socket that only
 * this user can access. It ends when this process ends, even if that crashes. */
#pragma once

#include <sys/types.h>

#include "clients/lib/delaunay_client.h"

struct private_daemon {
    struct delaunay_client *client; /* owns */
    pid_t pid;
    int owner; /* owns: a pipe at whose end the daemon ends */
};

/* Starts $DELAUNAYD, or the delaunayd beside this program, or that of $PATH, and connects to it. False with a sentence
 * in why[room] on failure. */
bool private_daemon_start(struct private_daemon *d, char *why, size_t room);

/* Closes the connection, and waits until the daemon has ended. */
void private_daemon_end(struct private_daemon *d);
