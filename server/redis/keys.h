/* keys.h - sets as the keys of Redis's commands: DBSIZE, EXISTS, KEYS, SCAN, TYPE, MEMORY USAGE, EXPIRE, TTL,
 * PTTL, PERSIST. */
#ifndef SERVER_REDIS_KEYS_H
#define SERVER_REDIS_KEYS_H

#include "server/command/command.h"

typedef void redis_handler(struct server *s, const struct request *q, struct answer *a);

redis_handler redis_dbsize, redis_exists, redis_keys, redis_scan, redis_type, redis_memory;
redis_handler redis_expire, redis_ttl, redis_persist;

#endif
