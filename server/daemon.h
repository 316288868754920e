/* daemon.h - the running daemon: listeners, signals, clients and workers in one event loop. */
#ifndef SERVER_DAEMON_H
#define SERVER_DAEMON_H

#include "server/ops/config.h"

/* Serves until SIGTERM or SIGINT, then finishes what was received and returns the process's exit
 * status. */
int daemon_run(struct config *config);

#endif
