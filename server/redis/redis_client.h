/* redis_client.h - CLIENT in RESP: replies in Redis's form, and the subcommands that only its libraries send. */
#ifndef SERVER_REDIS_CLIENT_H
#define SERVER_REDIS_CLIENT_H

#include "server/redis/redis_reply.h"

redis_handler redis_client;

#endif
