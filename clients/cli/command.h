/* command.h - the subcommands of the `delaunay` command line. Each returns the exit status. If a subcommand takes argc and
 * argv, argv[0] is its own name, and options may be among the
 * arguments. */
#pragma once

#include "clients/lib/delaunay_client.h"
#include "clients/lib/url.h"

enum exit_status { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2, EXIT_NO_CONNECTION = 3 };

/* Connects, and authenticates if there is a token. NULL, with a sentence in why[room], on failure. */
struct delaunay_client *command_connect(const struct url *where, char *why, size_t room);

/* Sends the words as one request line and prints the reply. */
int command_any(struct delaunay_client *c, int words, char **word);

/* Sends the lines of the standard input one by one and prints the replies; the status of the last
 * one that failed. */
int command_prompt(struct delaunay_client *c);

/* load SET FILE: loads a whole file into a set, or nothing. */
int command_load(struct delaunay_client *c, int argc, char **argv);

/* draw FILE OUT, run FILE OUT: make a picture or a mesh from a file. c is NULL: they start a daemon. */
int command_draw(struct delaunay_client *c, int argc, char **argv);

/* export SET FILE: a triangulated set as a drawing or in another program's format. */
int command_export(struct delaunay_client *c, int argc, char **argv);

/* show SET: draws a triangulated set in the terminal. */
int command_show(struct delaunay_client *c, int argc, char **argv);

/* raster SET FIELD FILE, contour SET FIELD FILE, voronoi SET FILE, alpha SET RADIUS FILE: a surface as a grid, its contours, Voronoi
 * cells, the alpha shape. Without a file they send the words as a request line. */
int command_raster(struct delaunay_client *c, int argc, char **argv);
int command_contour(struct delaunay_client *c, int argc, char **argv);
int command_voronoi(struct delaunay_client *c, int argc, char **argv);
int command_alpha(struct delaunay_client *c, int argc, char **argv);

/* trace SET FILE: an animation of the paper's algorithm on a small set. */
int command_trace(struct delaunay_client *c, int argc, char **argv);

/* top: a live view of INFO until interrupted. */
int command_top(struct delaunay_client *c, int argc, char **argv);

/* metrics: INFO in the text format of Prometheus. */
int command_metrics(struct delaunay_client *c, int argc, char **argv);

/* watch SET: the events of a set, until it is dropped or the program is interrupted. */
int command_watch(struct delaunay_client *c, int argc, char **argv);

/* copy SET URL URL: a set from one daemon to another. c is NULL: it connects by itself. */
int command_copy(struct delaunay_client *c, int argc, char **argv);

/* completion SHELL: prints a completion script. c is NULL. */
int command_completion(struct delaunay_client *c, int argc, char **argv);

/* Reports the outcome of a request on the standard error, unless it is DELAUNAY_OK; returns the
 * exit status. */
int command_outcome(const struct delaunay_client *c, enum delaunay_result r);

/* Whether the output has no colours: it is not a terminal, or NO_COLOR is set. */
bool command_is_plain(void);

/* A delaunay_part_fn that shows the server's progress comments on a terminal and ignores the
 * rest. */
bool command_show_comment(void *ctx, const struct delaunay_part *part);
