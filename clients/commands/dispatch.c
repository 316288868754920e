/* dispatch.c - see dispatch.h. */
#include "clients/commands/dispatch.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/cli/private_daemon.h"
#include "clients/cli/subcommand.h"

/* A set's name at that place, or its URL, which is read into *where. */
static const char *find_set_fault(char **word, struct url *where)
{
    if (where == NULL && url_is(*word))
        return "a set of another server needs a command of its own, outside of the prompt";
    if (url_is(*word)) {
        if (!url_read(*word, where) || where->set[0] == '\0')
            return "a set's URL is delaunay://host:port/set";
        *word = where->set;
    }
    if (!word_is_set_name(&(struct word){*word, strlen(*word)}))
        return URL_SET_NAMES;
    return NULL;
}

/* The error in the command that can be found without a server; NULL: none. */
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

static int run_connected(struct delaunay_client *c, const struct subcommand *s, int words,
                         char **word)
{
    if (words == 0)
        return command_prompt(c);
    return s != NULL && s->run != NULL ? s->run(c, words, word)
                                       : request_send_words(c, words, word);
}

/* With a private server, which ends with this process. */
static int run_alone(const struct subcommand *s, int words, char **word)
{
    char why[300];
    struct private_daemon own;
    if (!private_daemon_start(&own, why, sizeof why)) {
        message_print("%s", why);
        return EXIT_NO_CONNECTION;
    }
    int status = run_connected(own.client, s, words, word);
    private_daemon_end(&own);
    return status;
}

static bool is_default(const struct url *where)
{
    return strcmp(where->host, DELAUNAY_HOST) == 0 && strcmp(where->port, DELAUNAY_PORT) == 0;
}

/* Whether the command makes sense on an empty private server: a person at a prompt sees the notice, but a
 * script would lose the data that it adds. */
static bool needs_no_sets(int words, char **word)
{
    return words == 0 ? isatty(STDIN_FILENO) : strcasecmp(word[0], "help") == 0;
}

static int run(const struct subcommand *s, int words, char **word, const struct url *where)
{
    char why[256];
    if (url_is_private(where))
        return run_alone(s, words, word);
    struct delaunay_client *c = request_connect(where, why, sizeof why);
    if (c == NULL && is_default(where) && needs_no_sets(words, word)) {
        if (words == 0)
            fprintf(stderr, "%s. This is a private server; its sets end with this prompt.\n", why);
        return run_alone(s, words, word);
    }
    if (c == NULL) {
        message_print("%s", why);
        if (is_default(where))
            fprintf(stderr,
                    "Start a server with 'delaunayd &'. 'delaunay draw FILE' and the prompt "
                    "('delaunay' alone) need none.\n");
        return EXIT_NO_CONNECTION;
    }
    int status = run_connected(c, s, words, word);
    delaunay_close(c);
    return status;
}

static bool has_option(int words, char **word, const char *option)
{
    for (int i = 1; i < words; i++)
        if (strcmp(word[i], option) == 0)
            return true;
    return false;
}

int dispatch(struct delaunay_client *c, int words, char **word, struct url *where)
{
    const struct subcommand *s = words > 0 ? subcommand_find(word[0]) : NULL;
    if (s != NULL && has_option(words, word, "--help")) {
        subcommand_print_help(s);
        return EXIT_DONE;
    }
    const char *fault = find_fault(s, words, word, where);
    if (fault != NULL)
        return options_wrong("", "%s", fault);
    if (s != NULL && (s->alone || (s->run == command_load && has_option(words, word, "--dry-run"))))
        return s->run(NULL, words, word);
    return c != NULL ? run_connected(c, s, words, word) : run(s, words, word, where);
}
