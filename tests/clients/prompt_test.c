/* prompt_test.c - `delaunay` without a command, on a terminal and from a pipe. */
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static struct {
    int fd;
    pid_t pid;
    char out[20000];
    size_t n, seen;
} term;

/* Starts `delaunay ARGUMENTS` on a terminal of 24 lines of 80 columns, its history in the test's own directory. */
static void start(const char *arguments)
{
    char command[400];
    struct winsize size = {.ws_row = 24, .ws_col = 80};
    term.fd = posix_openpt(O_RDWR | O_NOCTTY);
    CHECK(term.fd >= 0 && grantpt(term.fd) == 0 && unlockpt(term.fd) == 0);
    CHECK(ioctl(term.fd, TIOCSWINSZ, &size) == 0);
    const char *name = ptsname(term.fd);
    snprintf(command, sizeof command, "HOME=%s TERM=xterm exec %s -h 127.0.0.1 -p %s %s",
             cli_path(""), getenv("DELAUNAY"), cli_daemon.port_text, arguments);
    term.n = term.seen = 0;
    term.out[0] = '\0';
    term.pid = fork();
    if (term.pid == 0) {
        setsid();
        int fd = open(name, O_RDWR);
        for (int i = 0; i < 3; i++)
            dup2(fd, i);
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
}

/* Waits until the text appears behind what was waited for before. */
static void wait_for(const char *text)
{
    char *found;
    while ((found = strstr(term.out + term.seen, text)) == NULL) {
        struct pollfd p = {.fd = term.fd, .events = POLLIN};
        CHECK_MSG(poll(&p, 1, 10000) == 1, "%s does not come after: %s", text,
                  term.out + term.seen);
        ssize_t got = read(term.fd, term.out + term.n, sizeof term.out - 1 - term.n);
        CHECK_MSG(got > 0, "%s did not come: %s", text, term.out + term.seen);
        term.n += (size_t)got;
        term.out[term.n] = '\0';
    }
    term.seen = (size_t)(found - term.out) + strlen(text);
}

static void type(const char *text)
{
    CHECK(write(term.fd, text, strlen(text)) == (ssize_t)strlen(text));
}

static int finish(void)
{
    char rest[1000];
    int status;
    while (read(term.fd, rest, sizeof rest) > 0) /* it waits until its output is read */
        continue;
    CHECK(waitpid(term.pid, &status, 0) == term.pid);
    close(term.fd);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Whether the client was built with a library for editing; says so if not. */
static bool can_edit(void)
{
    int status;
    peer_shell(&status, "ldd %s | grep -qE 'libedit|libreadline'", getenv("DELAUNAY"));
    if (status != 0)
        puts("skipped: built without libedit and readline");
    return status == 0;
}

TEST(prompt_carries_out_requests_and_subcommands_until_exit)
{
    char line[200];
    cli_begin();
    cli_write("a b.csv", "x,y\n0,0\n4,0\n0,4\n");
    start("");
    wait_for("delaunay> ");
    type("ping\r");
    wait_for("OK 0");
    wait_for("delaunay> ");
    snprintf(line, sizeof line, "load t \"%s\"\r", cli_path("a b.csv"));
    type(line);
    wait_for("OK 0 first=0 added=3");
    wait_for("delaunay> ");
    type("triangulate t\r");
    wait_for("triangles=1");
    type("show t --width 4 --height 2 --plain\r");
    wait_for("\xE2\xA3"); /* braille */
    wait_for("delaunay> ");
    type("points delaunay://elsewhere/t\r");
    wait_for("ERR");
    type("export t\r");
    wait_for("export takes a set and a file");
    wait_for("delaunay> ");
    type("exit\r");
    CHECK(finish() == 2); /* the status of what failed last */
    cli_finish();
}

TEST(prompt_has_history_and_editing)
{
    cli_begin();
    if (can_edit()) {
        start("");
        wait_for("delaunay> ");
        type("add t 1 2\r");
        wait_for("first=0");
        wait_for("delaunay> ");
        type("\033[A\r"); /* the line before */
        wait_for("first=1");
        wait_for("delaunay> ");
        type("pinx\177g\r");
        wait_for("OK 0");
        wait_for("delaunay> ");
        type("auth secret\r");
        wait_for("delaunay> ");
        type("poi\t t\r"); /* completes the command */
        wait_for("OK 2");
        wait_for("delaunay> ");
        type("quit\r");
        finish();
        start("");
        wait_for("delaunay> ");
        type("\033[A\033[A\r"); /* the one before quit, of the last time */
        wait_for("OK 2");
        wait_for("delaunay> ");
        type("\004"); /* end of the input */
        finish();
        int status;
        struct stat st;
        peer_shell(&status, "grep -q secret %s", cli_path(".delaunay_history"));
        CHECK(status == 1);
        CHECK(stat(cli_path(".delaunay_history"), &st) == 0 && (st.st_mode & 0077) == 0);
    }
    cli_finish();
}

TEST(prompt_takes_lines_of_a_pipe_with_subcommands)
{
    int status;
    cli_begin();
    cli_write("a.xy", "0 0\n4 0\n0 4\n");
    const char *got = peer_shell(&status,
                                 "printf 'load t %s\\ntriangulate t\\nexport t - -f ele\\nhull "
                                 "--help\\nexit\\nping\\n' | %s -p %s 2>&1",
                                 cli_path("a.xy"), getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_MSG(status == 0 && strstr(got, "added=3") != NULL &&
                  strstr(got, "\n1 3 0\n0 0 1 2\nusage: ") != NULL,
              "%s", got);
    got = peer_shell(&status, "printf 'load t \"a\\nLOADB t 1\\n' | %s -p %s 2>&1",
                     getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(got, "delaunay: a quote is open, or too many words\n"
                   "delaunay: to load points use load SET FILE\n");
    CHECK(status == 2);
    cli_finish();
}
