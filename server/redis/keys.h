/* keys.h - sets as the keys of Redis's commands: DBSIZE, EXISTS, TOUCH, KEYS, SCAN, TYPE, MEMORY USAGE, OBJECT, UNLINK, and
 * DEL, which is about points here. */
#ifndef SERVER_REDIS_KEYS_H
#define SERVER_REDIS_KEYS_H

#include "server/redis/redis_reply.h"

redis_handler redis_dbsize, redis_exists, redis_keys, redis_scan, redis_type, redis_memory;
redis_handler redis_object, redis_unlink;

/* Whether the words of a DEL are names and not ids: then redis_del refuses it, and names the command that deletes sets. */
bool redis_del_is_misused(const struct request *q);
redis_handler redis_del;

/* Whether sets may be shown, at the start not yet; if not, the error has been written. */
bool redis_sees_sets(struct server *s, struct answer *a);

/* The set of that name; NULL: there is none. */
struct dataset *redis_find(struct server *s, const struct word *name);

#endif
