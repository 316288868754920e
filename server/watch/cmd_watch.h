/* cmd_watch.h - WATCH and UNWATCH. */
#pragma once

#include "server/command/command.h"

command_handler cmd_watch, cmd_unwatch;
