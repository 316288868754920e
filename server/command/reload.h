/* reload.h - the tokens of --auth-file are read again while the daemon runs: SIGHUP, CONFIG RELOAD. */
#ifndef SERVER_RELOAD_H
#define SERVER_RELOAD_H

#include "server/jobs/server.h"

/* Reads the file again. Clients keep the role of their token, or get the one that it has now; one
 * whose token is gone is disconnected, or, if it is the client `asker`, only loses its role. False,
 * with the reason on standard error: there is no file, or it is not a good one; the old tokens stay. */
bool reload_tokens(struct server *s, uint64_t asker);

#endif
