/* cli.c - see cli.h. */
#include "tests/clients/cli.h"

#include "tests/clients/peer.h"
#include "tests/test.h"

#include <fcntl.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

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

void cli_run_on_terminal(const char *port, const char *arguments, char *out, size_t room)
{
    char command[500];
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    CHECK(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);
    CHECK(terminal >= 0);
    snprintf(command, sizeof command, "exec %s -h 127.0.0.1 -p %s %s", getenv("DELAUNAY"), port,
             arguments);
    pid_t pid = fork();
    if (pid == 0) {
        dup2(terminal, STDOUT_FILENO);
        dup2(terminal, STDERR_FILENO);
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    close(terminal);
    size_t n = 0;
    ssize_t got;
    while ((got = read(master, out + n, room - 1 - n)) > 0)
        n += (size_t)got;
    out[n] = 0;
    waitpid(pid, NULL, 0);
    close(master);
}
