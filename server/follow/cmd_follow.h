/* cmd_follow.h - FOLLOW, SYNC and WAIT, and what INFO says about leaders and followers. */
#pragma once

#include "server/command/command.h"
#include "server/follow/role.h"
#include "server/ops/facts.h"

command_handler cmd_follow, cmd_sync, cmd_wait;

/* Appends the section REPLICATION. */
void follow_facts(const struct server *s, struct facts *f);

/* The place of this daemon among leaders and followers. */
struct follow_place {
    char leader[ROLE_TEXT]; /* ADDR:PORT; empty: it has none */
    bool receiving;         /* it gets the changes of its leader */
    uint64_t lsn;           /* of its last change */
    unsigned followers;
};
struct follow_place follow_place(const struct server *s);
