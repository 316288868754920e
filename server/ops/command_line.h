/* command_line.h - the command line of the daemon: settings by name (setting.h), and --check, --repair,
 * --help, --version and --commands, with which it does not serve. */
#pragma once

#include "server/ops/config.h"

enum command_line {
    COMMAND_LINE_GOOD,
    COMMAND_LINE_ANSWERED,
    COMMAND_LINE_COMMANDS,
    COMMAND_LINE_BAD
};

/* Reads the command line; strings are borrowed from argv. COMMAND_LINE_ANSWERED: --help or --version has been answered on standard output.
 * COMMAND_LINE_COMMANDS: --commands is left to the caller. COMMAND_LINE_BAD: the reason is on standard error. */
enum command_line command_line_read(struct config *c, int argc, char **argv);
