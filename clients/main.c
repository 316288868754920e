/* main.c - the `delaunay` command line: the options before the subcommand. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/dispatch.h"
#include "clients/lib/url.h"
#include "proto/version.h"

static const char help_head[] =
    "usage: delaunay [-h HOST] [-p PORT] [-u URL] COMMAND...\n"
    "\n"
    "Talks to a delaunayd. COMMAND is one of these; COMMAND --help shows more:\n"
    "\n";

static const char help_tail[] =
    "\n"
    "Any other words are sent as one request line, and the reply is printed: delaunay HELP\n"
    "Without a command, lines of the standard input are carried out one by one; on a terminal\n"
    "with history and completion where the program was built with libedit or readline, and with\n"
    "a private server, which ends with the prompt, if none listens at the default address.\n"
    "SET may be a URL, which names the server as well: delaunay://host:port/set\n"
    "\n"
    "  -h, --host HOST   default $DELAUNAY_HOST, or else localhost; a path with a '/' is a\n"
    "                    Unix socket\n"
    "  -p, --port PORT   default $DELAUNAY_PORT, or else 6374\n"
    "  -u, --url URL     both at once: delaunay://[:TOKEN@]HOST[:PORT]; default $DELAUNAY_URL;\n"
    "                    private: a private server, which ends with the command\n"
    "      --json        print replies and results as JSON, one object per line\n"
    "      --help        show this help\n"
    "      --version     show the version\n"
    "\n"
    "A token of the server's --auth-file may also be in $DELAUNAY_TOKEN.\n"
    "\n"
    "Exit status: 0 done, 1 refused (ERR) or not possible, 2 wrong usage, 3 no connection.\n";

static void print_help(void)
{
    fputs(help_head, stdout);
    for (size_t i = 0; i < subcommand_count; i++)
        printf("  %s\n", subcommands[i].usage);
    fputs(help_tail, stdout);
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

/* Reads the environment; false if its URL is malformed. */
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

/* Removes --json from the arguments, wherever it is; returns how many are left. */
static int take_json(int argc, char **argv)
{
    int n = 0;
    for (int i = 0; i < argc; i++)
        if (strcmp(argv[i], "--json") == 0)
            json_choose();
        else
            argv[n++] = argv[i];
    argv[n] = NULL;
    return n;
}

/* With --json an object is written even if the only message is on the standard error. */
static void finish_json(int status)
{
    static const char *const error[] = {
        [EXIT_REFUSED] = "REFUSED", [EXIT_USAGE] = "USAGE", [EXIT_NO_CONNECTION] = "CONNECTION"};
    if (!json_chosen() || json_written() || status == EXIT_DONE)
        return;
    json_begin(false);
    json_text("error", error[status]);
    if (message_last()[0] != '\0')
        json_text("message", message_last());
    json_finish();
}

/* The exit status, after what is left of the output has been written. */
static int finish_output(int status)
{
    bool flushed = fflush(stdout) == 0;
    if (flushed && !ferror(stdout))
        return status;
    if (message_last()[0] == '\0')
        message_print("standard output: %s", flushed ? "it cannot be written" : strerror(errno));
    return status == EXIT_DONE ? EXIT_REFUSED : status;
}

int main(int argc, char **argv)
{
    static const struct option options[] = {
        {"host", required_argument, NULL, 'h'}, {"port", required_argument, NULL, 'p'},
        {"url", required_argument, NULL, 'u'},  {"help", no_argument, NULL, 'H'},
        {"version", no_argument, NULL, 'V'},    {NULL, 0, NULL, 0}};
    struct url where;
    int option;
    argc = take_json(argc, argv);
    if (!read_environment(&where))
        return options_wrong("", "$DELAUNAY_URL is not " URL_FORM);
    while ((option = options_next(argc, argv, "+h:p:u:", options)) != -1) {
        if (option == 'H' || option == 'V') {
            option == 'H' ? print_help() : (void)puts("delaunay " DELAUNAY_VERSION);
            return finish_output(EXIT_DONE);
        }
        if (option == 'h')
            set_text(where.host, sizeof where.host, optarg);
        else if (option == 'p')
            set_text(where.port, sizeof where.port, optarg);
        else if (option != 'u')
            return options_unknown("", argv, option);
        else if (!url_read(optarg, &where))
            return options_wrong("", "%s is not " URL_FORM, optarg);
    }
    int status = dispatch(NULL, argc - optind, argv + optind, &where);
    finish_json(status);
    return finish_output(status);
}
