/* info.h - INFO: facts about the server, from all rooms. */
#pragma once

#include "server/command/command.h"
#include "server/ops/facts.h"

command_handler cmd_info;

/* Appends the facts of the section of that name, in capitals. */
void info_section(const struct server *s, const char *name, struct facts *f);
