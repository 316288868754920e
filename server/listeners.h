/* listeners.h - the sockets that clients connect to, and who may: clients are refused when there are too many, or memory or
 * descriptors are short. */
#pragma once

#include "server/jobs/server.h"

/* Listens where s->config says, or at the socket `handed` of a service manager; -1: there is none. s->clients gets a session for each
 * client. Sets the TCP port. False with a notice when it cannot. s must live until listeners_close; there are one daemon's alone. */
bool listeners_begin(struct server *s, int handed, unsigned *port);

/* To be called once a second: accepts again what could not be accepted for lack of descriptors or memory. */
void listeners_refill(void);

/* No client can connect any more. The loop of the first reactor stops when the last client has left. */
void listeners_close(void);
