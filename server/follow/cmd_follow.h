/* cmd_follow.h - FOLLOW, SYNC and WAIT, and what INFO says about leaders and followers. */
#ifndef SERVER_CMD_FOLLOW_H
#define SERVER_CMD_FOLLOW_H

#include "server/command/command.h"
#include "server/ops/facts.h"

command_handler cmd_follow, cmd_sync, cmd_wait;

/* Appends the section REPLICATION. */
void follow_facts(const struct server *s, struct facts *f);

/* The same for server.replication. */
void follow_replication(const struct server *s, struct replication *r, follower_visit *visit,
                        void *ctx);

#endif
