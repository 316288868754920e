/* options.h - messages about wrong arguments, the same for all subcommands. */
#pragma once

#include <getopt.h>
#include <stdbool.h>
#include <string.h>

#include "clients/meshes/crs.h"

/* getopt_long without messages of its own. */
int options_next(int argc, char **argv, const char *letters, const struct option *options);

/* Takes an option of that name, whose value is in optarg; returns the exit status. */
typedef int options_take_fn(void *ctx, const char *option, char **argv);

/* Reads all arguments of a subcommand: its options (subcommand.h) by `take`, and then `words` words, which begin at argv[optind]. An
 * error calls them `what`. If `words` is -1, their number does not matter. -f is --format, -c is --columns, --color is --colour. Returns the exit status. */
int options_read(int argc, char **argv, options_take_fn *take, void *ctx, int words,
                 const char *what);

static inline bool options_is(const char *option, const char *name)
{
    return strcmp(option, name) == 0;
}

/* Reports wrong arguments of the command, "" for `delaunay` itself; returns the exit status. */
__attribute__((format(printf, 2, 3))) int options_wrong(const char *command, const char *format,
                                                        ...);

/* The same for what options_next has just returned: an unknown option or one without a value. */
int options_unknown(const char *command, char **argv, int option);

/* Whether the arguments belong to a subcommand that writes a file, not to the request of the same name. Then one of
 * them is an option, or names a file: "-", or a word with a '.' or '/' that is not a number. */
bool options_name_file(int argc, char **argv);

/* Take optarg, the value of --viewport: X0,Y0,X1,Y1 from lower left to upper right; of --crs; of --inside: `any`, or the number of a
 * border. Return the exit status. */
int options_viewport(double *box, bool *has_box, char **argv);
int options_crs(struct crs *crs, char **argv);
int options_inside(const char **inside, char **argv);
