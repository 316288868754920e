/* systemd.c - see systemd.h. Protocols: sd_listen_fds(3), descriptors from 3 on for the process
 * named by LISTEN_PID; sd_notify(3), a datagram to the Unix socket NOTIFY_SOCKET, whose name may
 * be abstract ('@' for the leading NUL). */
#include "server/system/systemd.h"

#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { FIRST_FD = 3, MOST_FDS = 64 };

static long number(const char *name)
{
    const char *text = getenv(name);
    return text != NULL ? strtol(text, NULL, 10) : 0;
}

static int is_listening_stream(int fd)
{
    int type = 0, listening = 0;
    socklen_t len = sizeof type;
    if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &len) != 0 || type != SOCK_STREAM)
        return 0;
    len = sizeof listening;
    return getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listening, &len) == 0 && listening;
}

int systemd_sockets(int *fd, int most)
{
    long given = number("LISTEN_PID") == (long)getpid() ? number("LISTEN_FDS") : 0;
    int n = 0;
    for (int at = FIRST_FD; at < FIRST_FD + given && at < FIRST_FD + MOST_FDS; at++) {
        int flags = fcntl(at, F_GETFL);
        if (n == most || flags < 0 || !is_listening_stream(at))
            continue;
        fcntl(at, F_SETFL, flags | O_NONBLOCK);
        fcntl(at, F_SETFD, FD_CLOEXEC);
        fd[n++] = at;
    }
    unsetenv("LISTEN_PID");
    unsetenv("LISTEN_FDS");
    return n;
}

void systemd_notify(const char *state)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    const char *path = getenv("NOTIFY_SOCKET");
    size_t len = path != NULL ? strlen(path) : 0;
    if (len < 2 || len >= sizeof at.sun_path || (path[0] != '/' && path[0] != '@'))
        return;
    memcpy(at.sun_path, path, len);
    if (path[0] == '@')
        at.sun_path[0] = '\0';
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return;
    sendto(fd, state, strlen(state), MSG_NOSIGNAL, (const struct sockaddr *)&at,
           (socklen_t)(offsetof(struct sockaddr_un, sun_path) + len));
    close(fd);
}
