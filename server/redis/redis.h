/* redis.h - requests of Redis tools and client libraries that are not commands of ours, or that need a reply in
 * Redis's form: HELLO 2 and 3, PING, ECHO, SELECT, CLIENT, CONFIG GET, COMMAND, INFO, AUTH with a user's name, sets as
 * keys (keys.h) and when they expire (redis_expire.h), transactions, which are not carried out (transaction.h), small ones (habit.h),
 * and requests that neither Redis's table nor ours has. Only in RESP framing (proto/resp.h). */
#ifndef SERVER_REDIS_REDIS_H
#define SERVER_REDIS_REDIS_H

#include "server/command/command.h"

/* Whether q is one of these requests; then the reply, in RESP, has been appended to a->out. */
bool redis_answer(struct server *s, const struct request *q, struct answer *a);

#endif
