/* cli.c - see cli.h. */
#include "tests/clients/cli.h"

#include "tests/clients/peer.h"
#include "tests/test.h"

#include <string.h>

struct daemon cli_daemon;
static char directory[64];

void cli_begin(void)
{
    cli_daemon = daemon_start(NULL);
    snprintf(directory, sizeof directory, "/tmp/delaunay_cli_XXXXXX");
    CHECK(mkdtemp(directory) != NULL);
}

void cli_finish(void)
{
    int status;
    peer_shell(&status, "rm -rf %s", directory);
    daemon_end(&cli_daemon);
}

char *cli_path(const char *name)
{
    static char text[128];
    snprintf(text, sizeof text, "%s/%s", directory, name);
    return text;
}

void cli_write(const char *name, const char *text)
{
    FILE *f = fopen(cli_path(name), "w");
    CHECK(f != NULL && fputs(text, f) >= 0 && fclose(f) == 0);
}

const char *cli_run(int *status, const char *arguments)
{
    return peer_shell(status, "%s -h 127.0.0.1 -p %s %s 2>&1", getenv("DELAUNAY"),
                      cli_daemon.port_text, arguments);
}

void cli_run_well(const char *arguments)
{
    int status;
    const char *out = cli_run(&status, arguments);
    CHECK_MSG(status == 0, "%s: %s", arguments, out);
}

void cli_expect(const char *arguments, const char *want)
{
    int status;
    CHECK_STR(cli_run(&status, arguments), want);
    CHECK(status == 0);
}
