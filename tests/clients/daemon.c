/* daemon.c - see daemon.h. */
#include "tests/clients/daemon.h"

#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/test.h"

struct daemon daemon_start(void)
{
    const char *path = getenv("DELAUNAYD");
    struct daemon d;
    int out[2];
    CHECK_MSG(path != NULL, "DELAUNAYD must name the daemon to test");
    CHECK(pipe(out) == 0);
    d.pid = fork();
    CHECK(d.pid >= 0);
    if (d.pid == 0) {
        dup2(out[1], STDOUT_FILENO);
        close(out[0]);
        close(out[1]);
        execl(path, "delaunayd", "--port", "0", (char *)NULL);
        _exit(127);
    }
    close(out[1]);
    char line[128];
    size_t n = 0;
    while (n + 1 < sizeof line && read(out[0], line + n, 1) == 1 && line[n] != '\n')
        n++;
    line[n] = 0;
    close(out[0]);
    CHECK_MSG(strncmp(line, "ready on 127.0.0.1:", 19) == 0, "the daemon said: %s", line);
    snprintf(d.port, sizeof d.port, "%.7s", line + 19);
    return d;
}

void daemon_stop(struct daemon *d)
{
    int status;
    kill(d->pid, SIGTERM);
    CHECK(waitpid(d->pid, &status, 0) == d->pid);
    CHECK_MSG(WIFEXITED(status) && WEXITSTATUS(status) == 0, "the daemon ended with status %x",
              (unsigned)status);
}

int daemon_connect(const struct daemon *d)
{
    struct sockaddr_in addr = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    addr.sin_port = htons((uint16_t)atoi(d->port));
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    CHECK(fd >= 0 && connect(fd, (struct sockaddr *)&addr, sizeof addr) == 0);
    return fd;
}
