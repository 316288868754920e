/* cmd_watch.h - WATCH and UNWATCH. */
#ifndef SERVER_CMD_WATCH_H
#define SERVER_CMD_WATCH_H

#include "server/command/command.h"

command_handler cmd_watch, cmd_unwatch;

#endif
