/* cli.h - runs `delaunay` with a daemon and a directory of the test's own. Any failure ends the test. */
#pragma once

#include <stddef.h>

#include "tests/daemon.h"

/* The daemon that the functions below talk to. */
extern struct daemon cli_daemon;

/* Starts the daemon and creates the directory; stops the one and removes the other. */
void cli_begin(void);
void cli_finish(void);

/* The path of a file in the directory; lives until the next call. */
char *cli_path(const char *name);

/* Writes a file in the directory. */
void cli_write(const char *name, const char *text);

/* Runs `delaunay ARGUMENTS` and returns its output with its messages, valid until the next call; its exit
 * status goes to *status. cli_run_well expects success, cli_expect success and the output `want`. */
const char *cli_run(int *status, const char *arguments);
void cli_run_well(const char *arguments);
void cli_expect(const char *arguments, const char *want);

/* Runs `delaunay ARGUMENTS`, for the server at this port, on a terminal of its own; its output there goes
 * to out[room]. */
void cli_run_on_terminal(const char *port, const char *arguments, char *out, size_t room);
