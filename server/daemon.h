/* daemon.h - the running daemon: listeners, signals, clients and workers in one event loop. */
#pragma once

#include "server/ops/config.h"

/* Serves until SIGTERM or SIGINT, then finishes what was received and returns the process's exit
 * status. */
int daemon_run(struct config *config);
