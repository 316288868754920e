/* connect.c - see connect.h. SO_SNDTIMEO limits the time of connect() for TCP and for Unix sockets; connect() then fails with
 * EINPROGRESS or EAGAIN (socket(7)). */
#include "clients/lib/connect.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

/* A connected, non-blocking socket, or -1 with the reason in errno. */
static int open_to(int family, int protocol, const struct sockaddr *addr, socklen_t len,
                   int timeout_ms)
{
    int fd = socket(family, SOCK_STREAM | SOCK_CLOEXEC, protocol);
    if (fd < 0)
        return -1;
    /* 0 would mean no limit. */
    struct timeval limit = {timeout_ms / 1000, timeout_ms > 0 ? timeout_ms % 1000 * 1000 : 1};
    if (timeout_ms >= 0)
        setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    if (connect(fd, addr, len) == 0 && fcntl(fd, F_SETFL, O_NONBLOCK) == 0)
        return fd;
    int reason = errno == EINPROGRESS || errno == EAGAIN ? ETIMEDOUT : errno;
    close(fd);
    errno = reason;
    return -1;
}

static int connect_unix(const char *path, int timeout_ms, char *why, size_t room)
{
    struct sockaddr_un addr = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof addr.sun_path) {
        snprintf(why, room, "too long for the path of a socket: %s", path);
        return -1;
    }
    memcpy(addr.sun_path, path, strlen(path));
    int fd = open_to(AF_UNIX, 0, (struct sockaddr *)&addr, sizeof addr, timeout_ms);
    if (fd < 0)
        snprintf(why, room, "%s: %s", path, strerror(errno));
    return fd;
}

/* Tries every address of the host: "localhost" may be ::1 first, and the server on 127.0.0.1. */
static int connect_tcp(const struct url *where, int timeout_ms, char *why, size_t room)
{
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *list;
    if (strtol(where->port, NULL, 10) > URL_MOST_PORT) { /* which the system would cut to 16 bits */
        snprintf(why, room, "%s:%s: a port is at most %d", where->host, where->port, URL_MOST_PORT);
        return -1;
    }
    int failed = getaddrinfo(where->host, where->port, &hints, &list);
    if (failed != 0) {
        snprintf(why, room, "%s:%s: %s", where->host, where->port, gai_strerror(failed));
        return -1;
    }
    int fd = -1;
    for (struct addrinfo *a = list; a != NULL && fd < 0; a = a->ai_next)
        fd = open_to(a->ai_family, a->ai_protocol, a->ai_addr, a->ai_addrlen, timeout_ms);
    if (fd < 0)
        snprintf(why, room, "%s:%s: %s", where->host, where->port, strerror(errno));
    else
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &(int){1}, sizeof(int));
    freeaddrinfo(list);
    return fd;
}

int connect_socket(const struct url *where, int timeout_ms, char *why, size_t room)
{
    return strchr(where->host, '/') != NULL ? connect_unix(where->host, timeout_ms, why, room)
                                            : connect_tcp(where, timeout_ms, why, room);
}
