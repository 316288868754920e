/* options.h - the options of subcommands, and messages about wrong arguments.
 *
 * A subcommand's options are words of a text (subcommand.h): NAME, `=` if it takes a value, and what it goes with:
 *
 *     limit=:angle,area     needs one of these options
 *     colour=:PICTURE       needs a picture to be written; kinds of files are in capitals
 *     cell=!width           is not given together with this one */
#pragma once

#include <getopt.h>
#include <stdbool.h>
#include <string.h>

#include "clients/meshes/crs.h"

/* getopt_long without messages of its own. */
int options_next(int argc, char **argv, const char *letters, const struct option *options);

/* Takes an option of that name, whose value is in optarg; returns the exit status. */
typedef int options_take_fn(void *ctx, const char *option, char **argv);

/* An option of that text; borrows from it. */
struct option_word {
    const char *name;
    size_t len;  /* of the name */
    bool valued; /* it takes a value */
    const char *needs,
        *excludes; /* names with a comma between them, up to a character that no name has */
};

/* Removes the first option of *rest; false at the end. */
bool option_word_next(const char **rest, struct option_word *o);

/* Reads all arguments of a subcommand: its options by `take`, and then `words` words, which begin at argv[optind]. An
 * error calls them `what`. If `words` is -1, their number does not matter. -f is --format, -c is --columns, --color is --colour. Checks
 * which options are given together. Returns the exit status. */
int options_read(int argc, char **argv, options_take_fn *take, void *ctx, int words,
                 const char *what);

/* Whether the options, which options_read has read, suit each other and what is written: `have` names its kinds, with a blank between
 * them; NULL: it is not known yet. Otherwise says what an option needs. Returns the exit status. */
int options_suit(char **argv, const char *have);

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
