/* private_daemon.h - a daemon of our own for one task: in memory, on a Unix socket that nobody else can
 * reach, which has no name any more when this returns. It ends with this process, however that ends. */
#ifndef CLIENTS_PRIVATE_DAEMON_H
#define CLIENTS_PRIVATE_DAEMON_H

#include <sys/types.h>

#include "clients/lib/delaunay_client.h"

/* Starts $DELAUNAYD, or the delaunayd beside this program, or that of $PATH, and connects to it. NULL with
 * a sentence in why[room] on failure. */
struct delaunay_client *private_daemon_start(pid_t *pid, char *why, size_t room);

/* Closes the connection and ends the daemon. */
void private_daemon_end(struct delaunay_client *c, pid_t pid);

#endif
