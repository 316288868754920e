/* main.c - the `delaunay` command line: options, the connection, then the subcommand. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "clients/options.h"
#include "clients/subcommand.h"
#include "clients/url.h"

#ifndef DELAUNAY_VERSION /* the Makefile knows it */
#define DELAUNAY_VERSION "unknown"
#endif

static const char help_head[] =
    "usage: delaunay [-h HOST] [-p PORT] [-u URL] COMMAND...\n"
    "\n"
    "Talks to a delaunayd. COMMAND is one of these; COMMAND --help tells more:\n"
    "\n";

static const char help_tail[] =
    "\n"
    "Any other words are sent as one request line, and the reply is printed: delaunay HELP\n"
    "Without a command, lines from the standard input are sent one by one.\n"
    "In place of SET a URL may stand, and it is sent there: delaunay://host:port/set\n"
    "\n"
    "  -h, --host HOST   default $DELAUNAY_HOST, or else localhost; a path with a '/' is a Unix "
    "socket\n"
    "  -p, --port PORT   default $DELAUNAY_PORT, or else 6374\n"
    "  -u, --url URL     both at once: delaunay://[:TOKEN@]HOST[:PORT]; default $DELAUNAY_URL\n"
    "      --help        this text\n"
    "      --version     which version this is\n"
    "\n"
    "A token of the server's --auth-file may also be in $DELAUNAY_TOKEN.\n"
    "\n"
    "Exit status: 0 done, 1 refused (ERR) or not possible, 2 wrong usage, 3 no connection.\n";

static int print_help(void)
{
    fputs(help_head, stdout);
    for (size_t i = 0; i < subcommand_count; i++)
        printf("  %s\n", subcommands[i].usage);
    return fputs(help_tail, stdout) < 0;
}

static void set_text(char *to, size_t room, const char *from)
{
    snprintf(to, room, "%s", from);
}

static void take_setting(const char *name, char *to, size_t room)
{
    const char *value = getenv(name);
    if (value != NULL && value[0] != '\0')
        set_text(to, room, value);
}

/* What the environment says; false if its URL is malformed. */
static bool read_environment(struct url *where)
{
    const char *url = getenv("DELAUNAY_URL");
    *where = (struct url){.host = DELAUNAY_HOST, .port = DELAUNAY_PORT};
    if (url != NULL && url[0] != '\0' && !url_read(url, where))
        return false;
    take_setting("DELAUNAY_HOST", where->host, sizeof where->host);
    take_setting("DELAUNAY_PORT", where->port, sizeof where->port);
    take_setting("DELAUNAY_TOKEN", where->token, sizeof where->token);
    return true;
}

/* A set's name at that place, or the URL of one: then *where becomes what it says. */
static const char *find_set_fault(char **word, struct url *where)
{
    if (url_is(*word)) {
        if (!url_read(*word, where) || where->set[0] == '\0')
            return "a set's URL is delaunay://host:port/set";
        *word = where->set;
    }
    if (!word_is_set_name(&(struct word){*word, strlen(*word)}))
        return "a set's name is 1 to 64 of the characters A-Z a-z 0-9 _ . : -";
    return NULL;
}

/* What is wrong with the command, before anybody is bothered with it; NULL if nothing is. */
static const char *find_fault(const struct subcommand *s, int words, char **word, struct url *where)
{
    if (s != NULL && s->set && words < 2)
        return "the name of a set is missing";
    if (s != NULL && s->set && (s->run == NULL || word[1][0] != '-'))
        return find_set_fault(&word[1], where);
    if (words > 0 && strcasecmp(word[0], "loadb") == 0)
        return "for binary loads use load, which sends points in binary form";
    return NULL;
}

static int run(const struct subcommand *s, int words, char **word, const struct url *where)
{
    char why[256];
    if (s != NULL && s->alone)
        return s->run(NULL, words, word);
    struct delaunay_client *c = url_connect(where, why, sizeof why);
    if (c == NULL) {
        fprintf(stderr, "delaunay: %s\n", why);
        return EXIT_NO_CONNECTION;
    }
    int status = words == 0                    ? command_prompt(c)
                 : s != NULL && s->run != NULL ? s->run(c, words, word)
                                               : command_any(c, words, word);
    delaunay_close(c);
    return status;
}

static bool asks_for_help(int words, char **word)
{
    for (int i = 1; i < words; i++)
        if (strcmp(word[i], "--help") == 0)
            return true;
    return false;
}

int main(int argc, char **argv)
{
    static const struct option options[] = {
        {"host", required_argument, NULL, 'h'}, {"port", required_argument, NULL, 'p'},
        {"url", required_argument, NULL, 'u'},  {"help", no_argument, NULL, 'H'},
        {"version", no_argument, NULL, 'V'},    {NULL, 0, NULL, 0}};
    struct url where;
    int option;
    if (!read_environment(&where))
        return options_wrong("", "DELAUNAY_URL is not of the form delaunay://host:port");
    while ((option = options_next(argc, argv, "+h:p:u:", options)) != -1) {
        if (option == 'H')
            return print_help();
        if (option == 'V')
            return puts("delaunay " DELAUNAY_VERSION) < 0;
        if (option == 'h')
            set_text(where.host, sizeof where.host, optarg);
        else if (option == 'p')
            set_text(where.port, sizeof where.port, optarg);
        else if (option != 'u')
            return options_unknown("", argv, option);
        else if (!url_read(optarg, &where))
            return options_wrong("", "%s is no URL delaunay://host:port", optarg);
    }
    int words = argc - optind;
    char **word = argv + optind;
    const struct subcommand *s = words > 0 ? subcommand_find(word[0]) : NULL;
    if (s != NULL && asks_for_help(words, word)) {
        subcommand_print_help(s);
        return EXIT_DONE;
    }
    const char *fault = find_fault(s, words, word, &where);
    if (fault != NULL)
        return options_wrong("", "%s", fault);
    int status = run(s, words, word, &where);
    if (fflush(stdout) != 0 && status == EXIT_DONE)
        status = EXIT_REFUSED;
    return status;
}
