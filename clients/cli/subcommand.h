/* subcommand.h - the table of the subcommands of `delaunay`: one row each, for dispatch, --help and completion. */
#pragma once

#include "clients/cli/command.h"

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
