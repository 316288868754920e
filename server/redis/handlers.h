/* handlers.h - the handlers of requests that only Redis's tools and libraries send, or that they want answered in Redis's form. */
#pragma once

#include "server/redis/redis_reply.h"

redis_handler redis_client; /* CLIENT, with subcommands that only libraries send; redis_client.c */

/* The version of Redis whose replies those in RESP are like: tools ask for it before they use a command. */
#define REDIS_VERSION "7.0.0"

redis_handler redis_info; /* our facts and Redis's, by its names, in its sections; redis_info.c */

/* ---- sets as keys: keys.c ---- */

redis_handler redis_dbsize, redis_exists, redis_keys, redis_scan, redis_type, redis_memory;
redis_handler redis_object, redis_unlink;

/* Whether the words of a DEL are names and not ids: then it is refused, with the name of the command that deletes sets. */
bool redis_del_is_misused(const struct request *q);

/* Whether sets may be shown, at the start not yet; if not, the error has been written. */
bool redis_sees_sets(struct server *s, struct answer *a);

/* The set of that name; NULL: there is none. */
struct dataset *redis_find(struct server *s, const struct word *name);

/* When sets are dropped, as integers of Redis: EXPIRE, PEXPIRE, EXPIREAT and PEXPIREAT with NX, XX, GT, LT; TTL, PTTL, EXPIRETIME,
 * PEXPIRETIME, PERSIST; redis_expire.c. */
redis_handler redis_expire, redis_ttl, redis_persist;

/* ---- transactions: transaction.c ----
 *
 * There are none: what follows MULTI is "queued" and never carried out, and EXEC says so.
 *
 * Some clients send MULTI, the commands and EXEC at once, others wait for each reply, and give up a connection whose MULTI has
 * failed without EXEC or DISCARD. For both a transaction that EXEC aborts is an outcome that Redis has, too. */

redis_handler redis_multi, redis_exec, redis_discard;

/* Whether a request of that name is carried out, not queued, after MULTI. */
bool redis_ends_multi(const struct word *name);

/* Any other request of such a connection; its body, if it has one, is skipped. */
redis_handler redis_queue;

/* ---- small requests that libraries and tools send by habit, and unknown ones: habit.c ---- */

redis_handler redis_time, redis_reset, redis_role, redis_wait, redis_latency, redis_module;
redis_handler redis_unknown;
