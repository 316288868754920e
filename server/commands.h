/* commands.h - all commands. */
#ifndef SERVER_COMMANDS_H
#define SERVER_COMMANDS_H

#include "server/command/command.h"

extern const struct command commands[];
extern const size_t command_count;

#endif
