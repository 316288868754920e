/* cmd_follow.h - FOLLOW, SYNC and WAIT, and what INFO says about leaders and followers. */
#pragma once

#include "server/command/command.h"
#include "server/ops/facts.h"

command_handler cmd_follow, cmd_sync, cmd_wait;

/* Appends the section REPLICATION. */
void follow_facts(const struct server *s, struct facts *f);
