/* options.h - what is wrong with the arguments of a subcommand, in the same words for all. */
#ifndef CLIENTS_OPTIONS_H
#define CLIENTS_OPTIONS_H

#include <getopt.h>

/* getopt_long without messages of its own, and with options and other words in any order. */
int options_next(int argc, char **argv, const char *letters, const struct option *options);

/* Says that something is wrong with the arguments of the command argv[0] (its name); returns the exit
 * status. */
__attribute__((format(printf, 2, 3))) int options_wrong(char **argv, const char *format, ...);

/* The same for what options_next returned: an unknown option or one without a value, '?' or ':'. */
int options_unknown(char **argv, int option);

#endif
