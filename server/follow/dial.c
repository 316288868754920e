/* dial.c - see dial.h. */
#include "server/follow/dial.h"

#include "server/system/loop.h"

#include <errno.h>
#include <inttypes.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CONNECT_MS = 5 * 1000, SEND_MS = 10 * 1000 };

bool dial_read_token(const char *path, char token[DIAL_TOKEN])
{
    FILE *in = path == NULL ? NULL : fopen(path, "re");
    token[0] = '\0';
    if (path == NULL)
        return true;
    if (in == NULL)
        return false;
    bool ok = fgets(token, DIAL_TOKEN, in) != NULL;
    fclose(in);
    token[strcspn(token, " \r\n")] = '\0';
    return ok && token[0] != '\0';
}

bool dial_init(struct dial *d)
{
    d->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return d->wake >= 0;
}

void dial_clear(struct dial *d)
{
    close(d->wake);
}

void dial_wake(struct dial *d)
{
    eventfd_write(d->wake, 1);
}

void dial_stop(struct dial *d)
{
    d->stop = true;
    dial_wake(d);
}

bool dial_wait(struct dial *d, int fd, short events, int ms)
{
    struct pollfd p[] = {{.fd = d->wake, .events = POLLIN}, {.fd = fd, .events = events}};
    eventfd_t count;
    if (poll(p, fd >= 0 ? 2 : 1, ms) < 0 && errno != EINTR)
        return false;
    if ((p[0].revents & POLLIN) != 0)
        eventfd_read(d->wake, &count);
    return !d->stop && !d->again;
}

/* Waits until the socket is connected, or failed. False: it takes too long, or the thread is to end. */
static bool await_connection(struct dial *d, int fd)
{
    struct pollfd p = {.fd = fd, .events = POLLOUT};
    int64_t until = clock_ms() + (d->patience_ms < CONNECT_MS ? d->patience_ms : CONNECT_MS), now;
    while (poll(&p, 1, 0) != 1)
        if ((now = clock_ms()) >= until || !dial_wait(d, fd, POLLOUT, (int)(until - now)))
            return false;
    return true;
}

int dial_connect(struct dial *d)
{
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST}, *at = NULL;
    char port[12];
    snprintf(port, sizeof port, "%u", d->port);
    if (getaddrinfo(d->host, port, &hints, &at) != 0)
        return -1;
    int fd = socket(at->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    int error = fd < 0 ? errno : 0, on = 1;
    socklen_t size = sizeof error;
    if (fd >= 0) {
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on); /* acknowledgements do not wait */
        setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    }
    if (fd >= 0 && connect(fd, at->ai_addr, at->ai_addrlen) != 0) {
        error = errno;
        if (error == EINPROGRESS && !await_connection(d, fd))
            error = ETIMEDOUT;
        else if (error == EINPROGRESS)
            getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
    }
    freeaddrinfo(at);
    if (error != 0 && fd >= 0)
        close(fd);
    errno = error;
    return error != 0 ? -1 : fd;
}

bool dial_send(struct dial *d, int fd, const char *bytes, size_t n)
{
    while (n > 0) {
        ssize_t sent = send(fd, bytes, n, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent > 0) {
            bytes += sent;
            n -= (size_t)sent;
        } else if ((errno != EAGAIN && errno != EINTR) || !dial_wait(d, fd, POLLOUT, SEND_MS)) {
            return false;
        }
    }
    return true;
}

/* Receives a line. */
static bool hear_line(struct dial *d, int fd, struct buf *in, char *line)
{
    int64_t until = clock_ms() + d->patience_ms;
    for (;;) {
        const char *head = buf_head(in);
        const char *end = buf_len(in) > 0 ? memchr(head, '\n', buf_len(in)) : NULL;
        if (end != NULL) {
            size_t n = (size_t)(end - head) < DIAL_LINE ? (size_t)(end - head) : DIAL_LINE - 1;
            memcpy(line, head, n);
            line[n] = '\0';
            buf_consume(in, (size_t)(end - head) + 1);
            return true;
        }
        char *to = buf_len(in) <= DIAL_LINE ? buf_reserve(in, DIAL_LINE) : NULL;
        ssize_t n = to == NULL ? 0 : recv(fd, to, DIAL_LINE, MSG_DONTWAIT);
        if (n > 0)
            buf_commit(in, (size_t)n);
        else if (n == 0 || (errno != EAGAIN && errno != EINTR) || clock_ms() > until ||
                 !dial_wait(d, fd, POLLIN, 1000))
            return false;
    }
}

bool dial_hear_all(struct dial *d, int fd, struct buf *in, size_t most)
{
    int64_t until = clock_ms() + d->patience_ms, now;
    for (;;) {
        char *to = buf_len(in) < most ? buf_reserve(in, DIAL_LINE) : NULL;
        ssize_t n = to == NULL ? -1 : recv(fd, to, DIAL_LINE, MSG_DONTWAIT);
        if (n == 0)
            return true;
        if (n > 0)
            buf_commit(in, (size_t)n);
        else if (to == NULL || (errno != EAGAIN && errno != EINTR) || (now = clock_ms()) >= until ||
                 !dial_wait(d, fd, POLLIN, (int)(until - now)))
            return false;
    }
}

/* Waits for the reply to AUTH before SYNC, which discards replies that have not been sent yet. */
bool dial_sync(struct dial *d, int fd, const struct position *from, struct buf *in, char *line)
{
    char history[HISTORY_TEXT];
    bool heard = true, admitted = true;
    if (d->token[0] != '\0') {
        int n = snprintf(line, DIAL_LINE, "AUTH %s\n", d->token);
        heard = dial_send(d, fd, line, (size_t)n) && hear_line(d, fd, in, line);
        admitted = heard && strncmp(line, "OK", 2) == 0;
    }
    if (admitted) {
        history_write(history, &from->history);
        int n = snprintf(line, DIAL_LINE, "SYNC %s %" PRIu64 " %016" PRIx64 "\n", history,
                         from->lsn, from->digest);
        heard = dial_send(d, fd, line, (size_t)n) && hear_line(d, fd, in, line);
    }
    if (!heard)
        line[0] = '\0';
    return heard && admitted;
}
