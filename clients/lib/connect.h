/* connect.h - a connected socket to a daemon. */
#pragma once

#include <stddef.h>

#include "clients/lib/url.h"

/* Connects to a host and port, or, if the host contains a '/', to the Unix socket of that path. Each address of the host gets
 * timeout_ms (-1: the system's limit); looking up a name takes its own time. Returns a non-blocking socket that the caller owns, or
 * -1 with a sentence in why[room]. */
int connect_socket(const struct url *where, int timeout_ms, char *why, size_t room);
