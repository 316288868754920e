/* false_leader.c - see false_leader.h. */
#include "tests/server/follow/false_leader.h"

#include "tests/test.h"

#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct false_leader false_leader_new(void)
{
    struct false_leader l = {.listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0),
                             .fd = -1,
                             .history = {.origin = 7, .generation = 1, .nonce = 5}};
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    CHECK(l.listener >= 0 && bind(l.listener, (struct sockaddr *)&at, size) == 0);
    CHECK(getsockname(l.listener, (struct sockaddr *)&at, &size) == 0);
    CHECK(listen(l.listener, 5) == 0);
    snprintf(l.address, sizeof l.address, "127.0.0.1:%u", ntohs(at.sin_port));
    return l;
}

int false_leader_dial(const struct false_leader *l)
{
    struct sockaddr_in at;
    socklen_t size = sizeof at;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    CHECK(fd >= 0 && getsockname(l->listener, (struct sockaddr *)&at, &size) == 0);
    CHECK(connect(fd, (struct sockaddr *)&at, size) == 0 || errno == EINPROGRESS);
    return fd;
}

static void hang_up(struct false_leader *l)
{
    if (l->fd >= 0)
        close(l->fd);
    l->fd = -1;
}

void false_leader_end(struct false_leader *l)
{
    hang_up(l);
    close(l->listener);
    buf_free(&l->out);
}

void false_leader_accept(struct false_leader *l, const char *continues)
{
    struct pollfd p = {.fd = l->listener, .events = POLLIN};
    char history[HISTORY_TEXT], line[200];
    CHECK_MSG(poll(&p, 1, 60 * 1000) == 1, "no follower connects");
    hang_up(l);
    l->fd = accept(l->listener, NULL, NULL);
    CHECK(l->fd >= 0);
    snprintf(l->asked, sizeof l->asked, "%s", hear_line(l->fd));
    CHECK_MSG(strncmp(l->asked, "SYNC ", 5) == 0, "%s", l->asked);
    history_write(history, &l->history);
    snprintf(line, sizeof line, "OK 0 history=%s lsn=1000 continues=%s\n", history, continues);
    say(l->fd, line);
}

static void add_header(struct false_leader *l, enum segment_kind kind, uint64_t lsn)
{
    struct segment h = {.version = RECORD_VERSION,
                        .kind = kind,
                        .lsn = lsn,
                        .life = 3,
                        .history = l->history,
                        .digest = l->digest};
    char bytes[SEGMENT_HEADER];
    segment_write(bytes, &h);
    buf_append(&l->out, bytes, sizeof bytes);
}

void false_leader_header(struct false_leader *l)
{
    add_header(l, SEGMENT_LOG, l->lsn + 1);
}

void false_leader_snapshot_header(struct false_leader *l)
{
    add_header(l, SEGMENT_SNAPSHOT, l->lsn);
}

void false_leader_record(struct false_leader *l, struct record r)
{
    size_t at = buf_len(&l->out);
    r.lsn = ++l->lsn;
    record_write(&l->out, &r);
    l->digest = record_digest(l->digest, buf_head(&l->out) + at, buf_len(&l->out) - at);
}

void false_leader_snapshot(struct false_leader *l, uint64_t lsn)
{
    struct record end = {.type = RECORD_END, .lsn = 1};
    l->lsn = lsn;
    l->digest = 1000 + lsn;
    false_leader_snapshot_header(l);
    record_write(&l->out, &end);
    false_leader_header(l);
}

bool false_leader_send(struct false_leader *l)
{
    CHECK(!l->out.failed);
    while (buf_len(&l->out) > 0) {
        ssize_t n = send(l->fd, buf_head(&l->out), buf_len(&l->out), MSG_NOSIGNAL);
        if (n <= 0)
            break;
        buf_consume(&l->out, (size_t)n);
    }
    bool sent = buf_len(&l->out) == 0;
    buf_rewind(&l->out, 0);
    return sent;
}
