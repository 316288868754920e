/* commands.h - all commands. */
#pragma once

#include "server/command/command.h"

extern const struct command commands[];
extern const size_t command_count;
