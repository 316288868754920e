/* daemon.c - see daemon.h. */
#include "tests/daemon.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/test.h"

enum { MOST_ARGUMENTS = 16 };

static void run_daemon(const char *const *arguments)
{
    const char *path = getenv("DELAUNAYD");
    const char *argv[MOST_ARGUMENTS + 6] = {path, "--port", "0", "--log-level", "warning"};
    size_t n = 5;
    for (; arguments != NULL && *arguments != NULL && n < MOST_ARGUMENTS; arguments++)
        argv[n++] = *arguments;
    if (path != NULL)
        execv(path, (char *const *)(uintptr_t)argv);
    perror("DELAUNAYD");
    _exit(127);
}

struct daemon daemon_start(const char *const *arguments)
{
    struct daemon d = {0};
    int out[2];
    char line[128];
    CHECK(pipe(out) == 0);
    d.pid = fork();
    CHECK(d.pid >= 0);
    if (d.pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        close(out[0]);
        close(out[1]);
        run_daemon(arguments);
    }
    close(out[1]);
    FILE *f = fdopen(out[0], "r");
    CHECK(f != NULL && fgets(line, sizeof line, f) != NULL);
    CHECK_MSG(sscanf(line, "ready on 127.0.0.1:%u", &d.port) == 1, "not a ready line: %s", line);
    snprintf(d.port_text, sizeof d.port_text, "%u", d.port & 0xFFFF);
    fclose(f);
    return d;
}

int daemon_stop(const struct daemon *d, int sig)
{
    int status;
    CHECK(kill(d->pid, sig) == 0);
    CHECK(waitpid(d->pid, &status, 0) == d->pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void daemon_end(const struct daemon *d)
{
    int status = daemon_stop(d, SIGTERM);
    CHECK_MSG(status == 0, "the daemon ended with status %d", status);
}

int daemon_connect(const struct daemon *d)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons((in_port_t)d->port)};
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    CHECK_MSG(fd >= 0 && connect(fd, (struct sockaddr *)&at, sizeof at) == 0, "connect: %s",
              strerror(errno));
    return fd;
}
