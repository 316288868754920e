/* prompt.c - `delaunay` without a command: lines from the standard input are sent as requests, one
 * by one, and the replies printed. The terminal's own line editing serves; on a terminal there is a
 * prompt. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "clients/command.h"

/* LOAD's and LOADB's points would be taken for requests here. */
static bool has_body(const char *line)
{
    size_t word = strcspn(line, " \t");
    return (word == 4 && strncasecmp(line, "LOAD", 4) == 0) ||
           (word == 5 && strncasecmp(line, "LOADB", 5) == 0);
}

int command_prompt(struct delaunay_client *c)
{
    bool terminal = isatty(STDIN_FILENO);
    char *line = NULL;
    size_t room = 0;
    int status = EXIT_DONE;
    ssize_t n;
    while (status != EXIT_NO_CONNECTION) {
        if (terminal)
            fputs("delaunay> ", stdout);
        fflush(stdout);
        if ((n = getline(&line, &room, stdin)) < 0)
            break;
        while (n > 0 && (line[n - 1] == '\n' || line[n - 1] == '\r'))
            line[--n] = '\0';
        if (strspn(line, " \t") == (size_t)n)
            continue;
        if (has_body(line)) {
            fprintf(stderr, "delaunay: to load points use delaunay load SET FILE\n");
            status = EXIT_USAGE;
            continue;
        }
        int outcome = command_any(c, 1, &line);
        status = outcome != EXIT_DONE ? outcome : status;
        if (strcasecmp(line, "quit") == 0)
            break;
    }
    if (terminal)
        putchar('\n');
    free(line);
    return status;
}
