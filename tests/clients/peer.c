/* peer.c - see peer.h. */
#include "tests/clients/peer.h"

#include <netinet/in.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/test.h"

static void serve_all(int listening, void (*serve)(int fd))
{
    pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid > 0) {
        close(listening);
        return;
    }
    signal(SIGPIPE, SIG_IGN);
    for (;;) {
        int fd = accept(listening, NULL, NULL);
        if (fd < 0)
            _exit(1);
        serve(fd);
        close(fd);
    }
}

void peer_start(char *port, void (*serve)(int fd))
{
    struct sockaddr_in addr = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t len = sizeof addr;
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&addr, len) == 0 && listen(fd, 8) == 0);
    CHECK(getsockname(fd, (struct sockaddr *)&addr, &len) == 0);
    snprintf(port, 8, "%u", ntohs(addr.sin_port));
    serve_all(fd, serve);
}

void peer_start_unix(const char *path, void (*serve)(int fd))
{
    struct sockaddr_un addr = {.sun_family = AF_UNIX};
    strncpy(addr.sun_path, path, sizeof addr.sun_path - 1);
    unlink(path);
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    CHECK(fd >= 0 && bind(fd, (struct sockaddr *)&addr, sizeof addr) == 0 && listen(fd, 8) == 0);
    serve_all(fd, serve);
}

void peer_send(int fd, const void *bytes, size_t n)
{
    const char *next = bytes;
    ssize_t wrote;
    while (n > 0 && (wrote = write(fd, next, n)) > 0) {
        next += wrote;
        n -= (size_t)wrote;
    }
}

void peer_say(int fd, const char *text)
{
    peer_send(fd, text, strlen(text));
}

bool peer_hear(int fd, char *line, size_t room)
{
    size_t n = 0;
    char c;
    while (n + 1 < room && read(fd, &c, 1) == 1) {
        if (c == '\n') {
            line[n] = 0;
            return true;
        }
        line[n++] = c;
    }
    return false;
}

const char *peer_shell(int *status, const char *format, ...)
{
    static char out[1 << 16];
    char command[4096];
    va_list ap;
    va_start(ap, format);
    CHECK((size_t)vsnprintf(command, sizeof command, format, ap) < sizeof command);
    va_end(ap);
    FILE *pipe = popen(command, "r");
    CHECK(pipe != NULL);
    size_t n = fread(out, 1, sizeof out - 1, pipe);
    out[n] = 0;
    *status = WEXITSTATUS(pclose(pipe));
    return out;
}
