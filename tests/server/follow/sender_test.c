/* sender_test.c - what a leader's thread sends to a follower, without a daemon: the test is the follower, at the other end
 * of a socket. */
#include "server/follow/sender.h"

#include "proto/records/record.h"
#include "server/disk/log.h"
#include "server/system/loop.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <inttypes.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- a leader: its directory, with a log of records, and the thread ---- */

struct stand {
    struct directory directory;
    struct datadir dir;
    int event;
    struct log *log;
    struct log_status status;
    struct sender *sender;
    int fd; /* the follower's end */
    bool tcp;
};

static const struct history first_history = {.origin = 7, .generation = 1, .nonce = 5};

/* Starts a sender with a log of `records` records. */
static void begin(struct stand *t, unsigned records)
{
    *t = (struct stand){.directory = directory_quick(), .event = eventfd(0, EFD_CLOEXEC), .fd = -1};
    CHECK(t->event >= 0 && datadir_open(&t->dir, t->directory.path, false));
    t->dir.lineage = (struct lineage){.life = 3, .history = first_history};
    t->log = log_new(&t->dir, LOG_ALWAYS, 1, 1, t->event);
    CHECK(t->log != NULL);
    for (unsigned i = 0; i < records; i++) {
        struct record r = {.type = RECORD_DROP, .name = "t", .name_len = 1};
        log_append(t->log, &r);
    }
    log_push(t->log);
    for (log_status(t->log, &t->status); t->status.durable < records; pause_ms(1))
        log_status(t->log, &t->status);
}

/* The two ends of a connection by TCP. */
static void tcp_pair(int fd[2])
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    int listener = socket(AF_INET, SOCK_STREAM, 0);
    CHECK(listener >= 0 && bind(listener, (struct sockaddr *)&at, size) == 0);
    CHECK(listen(listener, 1) == 0 && getsockname(listener, (struct sockaddr *)&at, &size) == 0);
    fd[1] = socket(AF_INET, SOCK_STREAM, 0);
    CHECK(fd[1] >= 0 && connect(fd[1], (struct sockaddr *)&at, size) == 0);
    fd[0] = accept(listener, NULL, NULL);
    CHECK(fd[0] >= 0);
    close(listener);
}

/* A follower with that position connects. */
static void connect_from(struct stand *t, uint64_t lsn, uint64_t digest)
{
    int fd[2];
    if (t->tcp)
        tcp_pair(fd);
    else
        CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fd) == 0);
    t->fd = fd[1];
    t->sender = calloc(1, sizeof *t->sender);
    CHECK(t->sender != NULL);
    t->sender->fd = fd[0];
    t->sender->event = t->event;
    t->sender->dir = &t->dir;
    t->sender->lineage = t->dir.lineage;
    t->sender->from = (struct position){first_history, lsn, digest};
    t->sender->durable = t->status.durable;
    CHECK(sender_start(t->sender));
}

static void end(struct stand *t)
{
    if (t->sender != NULL)
        sender_end(t->sender);
    if (t->fd >= 0)
        close(t->fd);
    log_free(t->log);
    datadir_close(&t->dir);
    close(t->event);
    directory_remove(&t->directory);
}

/* ---- what the follower receives ---- */

/* Receives n bytes; fewer if the connection ends. */
static size_t hear_bytes(struct stand *t, char *to, size_t n)
{
    size_t got = 0;
    while (got < n) {
        struct pollfd p = {.fd = t->fd, .events = POLLIN};
        CHECK_MSG(poll(&p, 1, 60 * 1000) == 1, "nothing comes");
        ssize_t r = recv(t->fd, to + got, n - got, 0);
        if (r <= 0)
            break;
        got += (size_t)r;
    }
    return got;
}

/* The answer is the leader's last durable change, and that. */
static void expect_answer(struct stand *t, const char *continues)
{
    char line[200] = "", want[200];
    for (size_t n = 0; n + 1 < sizeof line && hear_bytes(t, line + n, 1) == 1; n++)
        if (line[n] == '\n')
            break;
    snprintf(want, sizeof want,
             "OK 0 history=%016" PRIx64 ".%u.%08x lsn=%" PRIu64 " continues=%s\n",
             t->dir.lineage.history.origin, t->dir.lineage.history.generation,
             t->dir.lineage.history.nonce, t->status.durable, continues);
    CHECK_STR(line, want);
}

/* Expects a header, and returns it. */
static struct segment expect_header(struct stand *t)
{
    char bytes[SEGMENT_HEADER];
    struct segment h;
    CHECK(hear_bytes(t, bytes, sizeof bytes) == sizeof bytes);
    CHECK(segment_read(bytes, sizeof bytes, &h) == sizeof bytes);
    return h;
}

/* Expects the DROP of that lsn. */
static void expect_drop(struct stand *t, uint64_t lsn)
{
    char bytes[RECORD_HEADER + 100];
    struct record r;
    CHECK(hear_bytes(t, bytes, RECORD_HEADER) == RECORD_HEADER);
    size_t n = record_outline(bytes).length;
    CHECK(n < 100 && hear_bytes(t, bytes + RECORD_HEADER, n) == n);
    CHECK(record_read(bytes, RECORD_HEADER + n, &r) > 0);
    CHECK(r.type == RECORD_DROP && r.lsn == lsn);
}

static bool has_ended(struct stand *t)
{
    char rest[4096];
    while (hear_bytes(t, rest, sizeof rest) == sizeof rest)
        ;
    return true;
}

/* ---- positions ---- */

TEST(follower_without_a_position_gets_a_snapshot_first)
{
    struct stand t;
    begin(&t, 3);
    connect_from(&t, 0, 0);
    expect_answer(&t, "no");
    for (unsigned i = 0; i < 1000 * test_slowness() && t.sender->wants_snapshot == 0; i++)
        pause_ms(1);
    CHECK(t.sender->wants_snapshot == 1 && t.sender->state == SENDER_SNAPSHOT);
    end(&t);
}

TEST(follower_continues_at_its_position)
{
    struct stand t;
    begin(&t, 3);
    connect_from(&t, 0, 1);
    expect_answer(&t, "yes");
    struct segment h = expect_header(&t);
    CHECK(h.kind == SEGMENT_LOG && h.lsn == 1 && h.digest == 1);
    for (uint64_t lsn = 1; lsn <= 3; lsn++)
        expect_drop(&t, lsn);
    h = expect_header(&t);
    CHECK(h.lsn == 4 && h.digest == t.status.digest);
    end(&t);
}

TEST(position_after_the_last_change_differs)
{
    struct stand t;
    begin(&t, 3);
    connect_from(&t, 4, 99);
    expect_answer(&t, "differs");
    CHECK(has_ended(&t));
    end(&t);
}

TEST(position_with_another_digest_differs)
{
    struct stand t;
    begin(&t, 3);
    connect_from(&t, 2, 99);
    expect_answer(&t, "differs");
    CHECK(has_ended(&t));
    close(t.fd);
    sender_end(t.sender);
    connect_from(&t, 3, t.status.digest);
    expect_answer(&t, "yes");
    end(&t);
}

TEST(only_durable_changes_are_sent)
{
    struct stand t;
    begin(&t, 3);
    uint64_t durable = t.status.durable;
    t.status.durable = 2;
    connect_from(&t, 0, 1);
    expect_answer(&t, "yes");
    expect_header(&t);
    expect_drop(&t, 1);
    expect_drop(&t, 2);
    CHECK(expect_header(&t).lsn == 3);
    sender_advance(t.sender, durable);
    expect_drop(&t, 3);
    end(&t);
}

/* ---- histories ---- */

/* After a promotion the file of a segment may have the history before it, for a moment or until the next change. */
TEST(header_of_a_log_that_is_idle_has_the_history_of_the_leader)
{
    struct stand t;
    begin(&t, 3);
    t.dir.lineage = (struct lineage){.life = 4, .history = history_next(&first_history, 9)};
    connect_from(&t, 3, t.status.digest);
    expect_answer(&t, "yes");
    struct segment h = expect_header(&t);
    for (int i = 0; i < 3 && h.life == 3; i++)
        h = expect_header(&t);
    CHECK(h.life == 4 && h.history.generation == 2 && h.history.nonce == 9);
    end(&t);
}

/* ---- acknowledgements ---- */

/* Sends the line and returns whether it is taken; otherwise the connection has ended. */
static bool takes(const char *line)
{
    struct stand t;
    begin(&t, 3);
    connect_from(&t, 0, 1);
    expect_answer(&t, "yes");
    expect_header(&t);
    expect_drop(&t, 1);
    expect_drop(&t, 2);
    expect_drop(&t, 3);
    CHECK(send(t.fd, line, strlen(line), MSG_NOSIGNAL) == (ssize_t)strlen(line));
    int state;
    while (t.sender->acked != 3 && (state = t.sender->state) != SENDER_ENDED)
        pause_ms(1);
    bool taken = t.sender->acked == 3;
    CHECK(!taken || t.sender->acked_bytes == 77);
    end(&t);
    return taken;
}

TEST(acknowledgement_must_be_of_a_change_that_was_sent)
{
    CHECK(takes("ACK 3 77\n"));
    CHECK(takes("ACK 1 5\nACK 2 6\nACK 3 77\n"));
    CHECK(!takes("ACK 4 77\n"));
    CHECK(!takes("ACK -1 77\n"));
    CHECK(!takes("ACK 3\n"));
    CHECK(!takes("NAK 3 77\n"));
    CHECK(!takes("\n"));
    CHECK(!takes("ACK 0000000000000000000000000000000000000000000000000000000000003 77\n"));
    CHECK(!takes("ACK 0000000000000000000000000000000000000000000000000000000000003"));
}

/* The test checks only the timeout that the sender sets: a test cannot take the network away. */
TEST(system_disconnects_a_follower_whose_machine_is_gone)
{
    struct stand t;
    unsigned ms = 0;
    socklen_t size = sizeof ms;
    begin(&t, 1);
    t.tcp = true;
    connect_from(&t, 0, 0);
    CHECK(getsockopt(t.sender->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &ms, &size) == 0);
    CHECK(ms == SENDER_TIMEOUT_MS);
    end(&t);
}
