/* habit.h - small requests that Redis's libraries and tools send by habit, before or beside the requests of their users: TIME, RESET, ROLE,
 * WAIT, LATENCY, MODULE, CLUSTER and others. Also the answer to unknown requests. */
#ifndef SERVER_HABIT_H
#define SERVER_HABIT_H

#include "server/redis/redis_reply.h"

redis_handler redis_time, redis_reset, redis_role, redis_wait, redis_latency, redis_module;
redis_handler redis_cluster, redis_unknown;

#endif
