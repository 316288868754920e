/* redis_info.h - INFO in RESP: our facts and Redis's, by its names, in its sections. */
#ifndef SERVER_REDIS_INFO_H
#define SERVER_REDIS_INFO_H

#include "server/redis/redis_reply.h"

/* The version of Redis whose replies those in RESP are like: tools ask for it before they use a command. */
#define REDIS_VERSION "7.0.0"

redis_handler redis_info;

#endif
