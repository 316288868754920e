/* subcommand.h - the table of the subcommands of `delaunay`: one row each, for dispatch, --help and completion. */
#pragma once

#include "clients/cli/request.h"

struct subcommand {
    const char *name;
    int (*run)(struct delaunay_client *c, int argc, char **argv); /* NULL: sent as a request line */
    bool alone;                                                   /* it needs no connection */
    bool set; /* the first argument names a set */
    const char *usage, *help;
    const char *options; /* besides --help and --json; options.h reads them; NULL: none */
    bool files;          /* it takes names of files */
    const char *words;   /* arguments that completion offers; NULL: none */
};

extern const struct subcommand subcommands[];
extern const size_t subcommand_count;

/* The row of that name, in upper or lower case; NULL if there is none. */
const struct subcommand *subcommand_find(const char *name);

/* Prints its help. */
void subcommand_print_help(const struct subcommand *s);

/* ---- what the rows run: clients/commands. Each returns the exit status. If a function takes argc and argv, argv[0] is the
 * subcommand's name, and options may be among the arguments. ---- */

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
