/* redis.h - requests of Redis tools and client libraries that are not commands of ours, or that need a reply in
 * Redis's form. Only in RESP framing (proto/resp.h).
 *
 *     redis.c      HELLO 2 and 3, PING, ECHO, SELECT, CONFIG GET, COMMAND, AUTH
 *     handlers.h   the others */
#pragma once

#include "server/command/command.h"

/* Whether q is one of these requests; then the reply, in RESP, has been appended to a->out. */
bool redis_answer(struct server *s, const struct request *q, struct answer *a);
