/* main.c - the `delaunay` command line. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "clients/command.h"
#include "proto/request.h"

static const char help[] =
    "usage: delaunay [-h HOST] [-p PORT] COMMAND...\n"
    "\n"
    "Talks to a delaunayd. COMMAND is one of\n"
    "\n"
    "  load SET FILE         loads a file of lines `x y` into the set (- for the standard input); "
    "blank\n"
    "                        lines and lines that start with # are skipped, a bad line loads "
    "nothing\n"
    "  export SET FILE.svg   draws the triangulated set (- for the standard output)\n"
    "  any other words       are sent as one request line, and the reply is printed:\n"
    "                            delaunay TRIANGULATE cities\n"
    "                            delaunay NEAREST cities 2.35 48.85 3\n"
    "                            delaunay HELP\n"
    "\n"
    "  -h, --host HOST       default $DELAUNAY_HOST, or else localhost; a path with a '/' is a "
    "Unix socket\n"
    "  -p, --port PORT       default $DELAUNAY_PORT, or else 6374\n"
    "      --help            this text\n"
    "\n"
    "Exit status: 0 done, 1 refused (ERR) or not possible, 2 wrong usage, 3 no connection.\n";

static int usage(const char *what)
{
    fprintf(stderr, "delaunay: %s\nTry 'delaunay --help'.\n", what);
    return EXIT_USAGE;
}

static const char *setting(const char *name, const char *otherwise)
{
    const char *value = getenv(name);
    return value != NULL && value[0] != '\0' ? value : otherwise;
}

static bool is_subcommand(const char *word)
{
    return strcasecmp(word, "load") == 0 || strcasecmp(word, "export") == 0;
}

/* What is wrong with the command, before anybody is bothered with it; NULL if nothing is. */
static const char *find_fault(int words, char **word)
{
    if (words == 0)
        return "a command is missing";
    if (is_subcommand(word[0]) && words != 3)
        return "load and export take a set and a file";
    if (is_subcommand(word[0]) && !word_is_set_name(&(struct word){word[1], strlen(word[1])}))
        return "a set's name is 1 to 64 of the characters A-Z a-z 0-9 _ . : -";
    if (strcasecmp(word[0], "loadb") == 0)
        return "for binary loads use load, which sends points in binary form";
    return NULL;
}

static int run(struct delaunay_client *c, int words, char **word)
{
    if (strcasecmp(word[0], "load") == 0)
        return command_load(c, word[1], word[2]);
    if (strcasecmp(word[0], "export") == 0)
        return command_export(c, word[1], word[2]);
    return command_any(c, words, word);
}

int main(int argc, char **argv)
{
    static const struct option options[] = {{"host", required_argument, NULL, 'h'},
                                            {"port", required_argument, NULL, 'p'},
                                            {"help", no_argument, NULL, 'H'},
                                            {NULL, 0, NULL, 0}};
    const char *host = setting("DELAUNAY_HOST", DELAUNAY_HOST),
               *port = setting("DELAUNAY_PORT", DELAUNAY_PORT);
    int option;
    while ((option = getopt_long(argc, argv, "+h:p:", options, NULL)) != -1) {
        if (option == 'H')
            return fputs(help, stdout) < 0;
        if (option == 'h')
            host = optarg;
        else if (option == 'p')
            port = optarg;
        else
            return usage("unknown option");
    }
    const char *fault = find_fault(argc - optind, argv + optind);
    if (fault != NULL)
        return usage(fault);
    char why[256];
    struct delaunay_client *c = delaunay_connect(host, port, why, sizeof why);
    if (c == NULL) {
        fprintf(stderr, "delaunay: %s\n", why);
        return EXIT_NO_CONNECTION;
    }
    int status = run(c, argc - optind, argv + optind);
    delaunay_close(c);
    if (fflush(stdout) != 0 && status == EXIT_DONE)
        status = EXIT_REFUSED;
    return status;
}
