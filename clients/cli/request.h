/* request.h - the requests of subcommands: the connection, words that are sent unchanged, progress, and the outcome as an exit status. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/lib/url.h"

enum exit_status { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2, EXIT_NO_CONNECTION = 3 };

/* Connects, and authenticates if there is a token. NULL, with a sentence in why[room], on failure. */
struct delaunay_client *request_connect(const struct url *where, char *why, size_t room);

/* Sends the words as one request line and prints the reply. */
int request_send_words(struct delaunay_client *c, int words, char **word);

/* Reports the outcome of a request on the standard error, unless it is DELAUNAY_OK; returns the
 * exit status. */
int request_outcome(const struct delaunay_client *c, enum delaunay_result r);

/* A delaunay_part_fn that shows the server's progress comments on a terminal and ignores the
 * rest. */
bool request_show_comment(void *ctx, const struct delaunay_part *part);
