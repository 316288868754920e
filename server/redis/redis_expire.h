/* redis_expire.h - when sets are dropped, as Redis's commands set and show it: EXPIRE, PEXPIRE, EXPIREAT and PEXPIREAT with NX, XX,
 * GT, LT; TTL, PTTL, EXPIRETIME, PEXPIRETIME, PERSIST. They answer with Redis's integers. */
#ifndef SERVER_REDIS_EXPIRE_H
#define SERVER_REDIS_EXPIRE_H

#include "server/redis/redis_reply.h"

redis_handler redis_expire, redis_ttl, redis_persist;

#endif
