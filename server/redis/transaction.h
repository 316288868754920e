/* transaction.h - MULTI, EXEC, DISCARD, WATCH and UNWATCH of Redis. There are no transactions: what follows MULTI is "queued" and never
 * carried out, and EXEC says so.
 *
 * Some clients send MULTI, the commands and EXEC at once, others wait for each reply, and give up a connection whose MULTI has
 * failed without EXEC or DISCARD. For both a transaction that EXEC aborts is an outcome that Redis has, too. */
#ifndef SERVER_TRANSACTION_H
#define SERVER_TRANSACTION_H

#include "server/redis/redis_reply.h"

redis_handler redis_multi, redis_exec, redis_discard, redis_watch, redis_unwatch;

/* Whether a request of that name is carried out, not queued, after MULTI. */
bool redis_ends_multi(const struct word *name);

/* Any other request of such a connection; its body, if it has one, is skipped. */
redis_handler redis_queue;

#endif
