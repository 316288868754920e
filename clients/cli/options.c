/* options.c - see options.h. */
#include "clients/cli/options.h"

#include <stdarg.h>
#include <stdio.h>

#include "clients/cli/command.h"

int options_next(int argc, char **argv, const char *letters, const struct option *options)
{
    char with_colon[16];
    opterr = 0;
    /* ':' tells a missing value from an unknown option; '+' before it is getopt's, too */
    bool plus = letters[0] == '+';
    snprintf(with_colon, sizeof with_colon, "%s:%s", plus ? "+" : "", letters + plus);
    return getopt_long(argc, argv, with_colon, options, NULL);
}

int options_wrong(const char *command, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    fputs("delaunay: ", stderr);
    vfprintf(stderr, format, values);
    va_end(values);
    fprintf(stderr, "\nTry 'delaunay %s%s--help'.\n", command, command[0] != '\0' ? " " : "");
    return EXIT_USAGE;
}

int options_unknown(const char *command, char **argv, int option)
{
    /* A letter may stand among others in one word; a long option is the last word looked at. */
    const char letter[3] = {'-', (char)optopt, '\0'};
    const char *name =
        optopt != 0 && optopt < 128 && argv[optind - 1][1] != '-' ? letter : argv[optind - 1];
    return options_wrong(command,
                         option == ':' ? "the option %s needs a value" : "unknown option %s", name);
}
