/* info.h - INFO: facts about the server, from all rooms. */
#ifndef SERVER_INFO_H
#define SERVER_INFO_H

#include "server/command/command.h"

command_handler cmd_info;

#endif
