/* terminal.c - see terminal.h. */
#include "tests/clients/terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

static struct {
    int fd;
    pid_t pid;
    char out[20000];
    size_t n, seen;
} term;

void terminal_start(const char *arguments)
{
    char command[400];
    struct winsize size = {.ws_row = 24, .ws_col = 80};
    term.fd =
        posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC); /* so that it closes when the test ends */
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

void terminal_wait_for(const char *text)
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

void terminal_type(const char *text)
{
    CHECK(write(term.fd, text, strlen(text)) == (ssize_t)strlen(text));
}

int terminal_finish(void)
{
    char rest[1000];
    int status;
    while (read(term.fd, rest, sizeof rest) > 0) /* it waits until its output is read */
        continue;
    CHECK(waitpid(term.pid, &status, 0) == term.pid);
    close(term.fd);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}
