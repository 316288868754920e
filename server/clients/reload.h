/* reload.h - reloads the tokens of --auth-file while the daemon runs: SIGHUP, CONFIG RELOAD. */
#pragma once

#include "server/jobs/server.h"

/* Reads the file again. Clients get the role that their token has now. A client whose token does not exist any more
 * is disconnected; the client `asker` only loses its role. False, with the reason on standard error: there is no
 * file, or it is not valid; the old tokens stay. */
bool reload_tokens(struct server *s, uint64_t asker);
