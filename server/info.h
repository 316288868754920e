/* info.h - INFO: facts about the server, from all rooms. */
#ifndef SERVER_INFO_H
#define SERVER_INFO_H

#include "server/command/command.h"
#include "server/ops/facts.h"

command_handler cmd_info;

/* Appends the facts of the section of that name, in capitals. */
void info_section(const struct server *s, const char *name, struct facts *f);

#endif
