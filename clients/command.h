/* command.h - the subcommands of the `delaunay` command line. Each returns the exit status. */
#ifndef CLIENTS_COMMAND_H
#define CLIENTS_COMMAND_H

#include "clients/delaunay_client.h"

enum exit_status { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2, EXIT_NO_CONNECTION = 3 };

/* Sends the words as one request line and prints the reply. */
int command_any(struct delaunay_client *c, int words, char **word);

/* Loads a file of `x y` lines, "-" for the standard input, into a set: all of it or nothing. */
int command_load(struct delaunay_client *c, const char *set, const char *path);

/* Draws a triangulated set as an SVG file, "-" for the standard output. */
int command_export(struct delaunay_client *c, const char *set, const char *path);

/* Reports the outcome of a request on the standard error, unless it is DELAUNAY_OK; returns the
 * exit status. */
int command_outcome(const struct delaunay_client *c, enum delaunay_result r);

/* A delaunay_part_fn that shows the server's progress comments on a terminal and ignores the rest.
 */
bool command_show_comment(void *ctx, const struct reply_part *part);

#endif
