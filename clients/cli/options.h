/* options.h - what is wrong with the arguments of a subcommand, in the same words for all. */
#ifndef CLIENTS_OPTIONS_H
#define CLIENTS_OPTIONS_H

#include <getopt.h>

/* getopt_long without messages of its own. */
int options_next(int argc, char **argv, const char *letters, const struct option *options);

/* Says that something is wrong with the arguments of the command, "" for `delaunay` itself; returns the exit
 * status. */
__attribute__((format(printf, 2, 3))) int options_wrong(const char *command, const char *format,
                                                        ...);

/* The same for what options_next has just returned: an unknown option or one without a value. */
int options_unknown(const char *command, char **argv, int option);

#endif
