/* sock.c - see sock.h. */
#include "server/system/sock.h"

#include "proto/number.h"

#include "server/system/notice.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

enum {
    BACKLOG = 1024,
    /* An unreachable client is detected after IDLE + PROBES * INTERVAL seconds of silence. */
    KEEPALIVE_IDLE_S = 60,
    KEEPALIVE_INTERVAL_S = 15,
    KEEPALIVE_PROBES = 4
};

/* Reports errno, which stays as it is. */
static int fail(int fd, const char *what)
{
    int error = errno;
    notice_error("cannot listen on %s: %s", what, strerror(error));
    if (fd >= 0)
        close(fd);
    errno = error;
    return -1;
}

/* Parses a numeric address; returns the length of the socket address, 0 on failure. */
static socklen_t parse_address(const char *text, unsigned port, struct sockaddr_storage *at)
{
    struct sockaddr_in *v4 = (struct sockaddr_in *)at;
    struct sockaddr_in6 *v6 = (struct sockaddr_in6 *)at;
    memset(at, 0, sizeof *at);
    if (inet_pton(AF_INET, text, &v4->sin_addr) == 1) {
        v4->sin_family = AF_INET;
        v4->sin_port = htons((in_port_t)port);
        return sizeof *v4;
    }
    if (inet_pton(AF_INET6, text, &v6->sin6_addr) == 1) {
        v6->sin6_family = AF_INET6;
        v6->sin6_port = htons((in_port_t)port);
        return sizeof *v6;
    }
    return 0;
}

static bool is_loopback(const struct sockaddr_storage *at)
{
    if (at->ss_family == AF_INET6)
        return IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)at)->sin6_addr);
    uint32_t v4 = ntohl(((const struct sockaddr_in *)at)->sin_addr.s_addr);
    return at->ss_family == AF_INET && v4 >> 24 == 127;
}

bool sock_is_address(const char *text, bool *loopback)
{
    struct sockaddr_storage at;
    bool good = parse_address(text, 0, &at) > 0;
    if (good && loopback != NULL)
        *loopback = is_loopback(&at);
    return good;
}

static unsigned port_of(const struct sockaddr_storage *at)
{
    return ntohs(at->ss_family == AF_INET ? ((const struct sockaddr_in *)at)->sin_port
                                          : ((const struct sockaddr_in6 *)at)->sin6_port);
}

static void set(int fd, int level, int option, int value)
{
    setsockopt(fd, level, option, &value, sizeof value);
}

void sock_prepare(int listener)
{
    set(listener, IPPROTO_TCP, TCP_NODELAY, 1);
    set(listener, SOL_SOCKET, SO_KEEPALIVE, 1);
    set(listener, IPPROTO_TCP, TCP_KEEPIDLE, KEEPALIVE_IDLE_S);
    set(listener, IPPROTO_TCP, TCP_KEEPINTVL, KEEPALIVE_INTERVAL_S);
    set(listener, IPPROTO_TCP, TCP_KEEPCNT, KEEPALIVE_PROBES);
}

int sock_listen(const char *address, unsigned *port)
{
    struct sockaddr_storage at;
    socklen_t len = parse_address(address, *port, &at);
    int fd = len > 0 ? socket(at.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0) : -1;
    if (fd < 0)
        return fail(fd, address);
    set(fd, SOL_SOCKET, SO_REUSEADDR, 1);
    sock_prepare(fd);
    if (bind(fd, (struct sockaddr *)&at, len) != 0 || listen(fd, BACKLOG) != 0)
        return fail(fd, address);
    len = sizeof at;
    if (getsockname(fd, (struct sockaddr *)&at, &len) == 0)
        *port = port_of(&at);
    return fd;
}

/* Removes a socket file if a connection to it is refused. */
static void remove_stale(const struct sockaddr_un *at)
{
    struct stat st;
    if (stat(at->sun_path, &st) != 0 || !S_ISSOCK(st.st_mode))
        return;
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return;
    if (connect(fd, (const struct sockaddr *)at, sizeof *at) != 0 && errno == ECONNREFUSED)
        unlink(at->sun_path);
    close(fd);
}

int sock_listen_unix(const char *path)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof at.sun_path) {
        errno = ENAMETOOLONG;
        return fail(-1, path);
    }
    strcpy(at.sun_path, path);
    remove_stale(&at);
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return fail(fd, path);
    if (bind(fd, (struct sockaddr *)&at, sizeof at) != 0 || chmod(path, 0660) != 0 ||
        listen(fd, BACKLOG) != 0)
        return fail(fd, path);
    return fd;
}

static socklen_t name_of(int fd, struct sockaddr_storage *at)
{
    socklen_t len = sizeof *at;
    memset(at, 0, sizeof *at);
    return getsockname(fd, (struct sockaddr *)at, &len) == 0 ? len : 0;
}

bool sock_is_local(int fd)
{
    struct sockaddr_storage at;
    return name_of(fd, &at) > 0 && (at.ss_family == AF_UNIX || is_loopback(&at));
}

unsigned sock_port(int fd)
{
    struct sockaddr_storage at;
    bool inet = name_of(fd, &at) > 0 && at.ss_family != AF_UNIX;
    return inet ? port_of(&at) : 0;
}

static void read_peer(const struct sockaddr_storage *at, struct sock_peer *peer)
{
    const struct sockaddr_in *v4 = (const struct sockaddr_in *)at;
    const struct sockaddr_in6 *v6 = (const struct sockaddr_in6 *)at;
    *peer = (struct sock_peer){.kind = SOCK_UNIX};
    if (at->ss_family == AF_INET) {
        peer->kind = SOCK_V4;
        memcpy(peer->address, &v4->sin_addr, sizeof v4->sin_addr);
    } else if (at->ss_family == AF_INET6) {
        peer->kind = SOCK_V6;
        memcpy(peer->address, &v6->sin6_addr, sizeof v6->sin6_addr);
    }
    if (peer->kind != SOCK_UNIX)
        peer->port = (uint16_t)port_of(at);
}

/* Faster than inet_ntop: CLIENT LIST writes thousands of these. */
static char *write_v4(char *to, const uint8_t *address)
{
    for (int i = 0; i < 4; i++) {
        to += proto_write_u32(to, address[i]);
        *to++ = i < 3 ? '.' : ':';
    }
    return to;
}

void sock_peer_text(const struct sock_peer *peer, char text[SOCK_PEER_TEXT])
{
    char address[INET6_ADDRSTRLEN];
    if (peer->kind == SOCK_UNIX) {
        strcpy(text, "unix");
    } else if (peer->kind == SOCK_V4) {
        char *to = write_v4(text, peer->address);
        to[proto_write_u32(to, peer->port)] = '\0';
    } else if (inet_ntop(AF_INET6, peer->address, address, sizeof address) != NULL) {
        snprintf(text, SOCK_PEER_TEXT, "[%s]:%u", address, peer->port);
    }
}

int sock_accept(int listener, struct sock_peer *peer)
{
    struct sockaddr_storage at = {.ss_family = AF_UNSPEC};
    socklen_t len = sizeof at;
    int fd = accept4(listener, (struct sockaddr *)&at, &len, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd >= 0)
        read_peer(&at, peer);
    return fd;
}

void sock_refuse(int fd, const char *line)
{
    char scratch[4096];
    ssize_t ignored = send(fd, line, strlen(line), MSG_NOSIGNAL | MSG_DONTWAIT);
    ignored = recv(fd, scratch, sizeof scratch, MSG_DONTWAIT);
    (void)ignored;
    close(fd);
}
