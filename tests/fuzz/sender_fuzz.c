/* sender_fuzz.c - libFuzzer target: any bytes from a follower that has been sent everything, to the thread of its leader. The
 * thread ends with the connection, and believes no acknowledgement of a change that it has not sent. */
#include "server/follow/sender.h"

#include "proto/records/record.h"
#include "server/disk/log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

enum { RECORDS = 3, DIGEST = 1 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

/* A directory with a log, made once, in memory if possible. */
static struct datadir dir = {.fd = -1};
static int event;

static void make_log(void)
{
    static char path[] = "/dev/shm/sender_fuzz.XXXXXX", other[] = "/tmp/sender_fuzz.XXXXXX";
    require(datadir_open(&dir, mkdtemp(path) != NULL ? path : mkdtemp(other), false));
    event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    dir.lineage =
        (struct lineage){.life = 3, .history = {.origin = 7, .generation = 1, .nonce = 5}};
    struct log *log = log_new(&dir, LOG_ALWAYS, 1, DIGEST, event);
    require(event >= 0 && log != NULL);
    log_close_mark(log, false);
    for (int i = 0; i < RECORDS; i++) {
        struct record r = {.type = RECORD_DROP, .name = "t", .name_len = 1};
        log_append(log, &r);
    }
    log_free(log);
}

/* libFuzzer's timer interrupts it. */
static ssize_t hear(int fd, char *to, size_t n)
{
    ssize_t got;
    do
        got = recv(fd, to, n, 0);
    while (got < 0 && errno == EINTR);
    return got;
}

static void read_bytes(int fd, size_t n)
{
    char bytes[512];
    ssize_t got;
    for (; n > 0; n -= (size_t)got) {
        got = hear(fd, bytes, n < sizeof bytes ? n : sizeof bytes);
        require(got > 0);
    }
}

/* The answer, the header and all records. */
static void read_everything(int fd)
{
    char byte;
    do
        require(hear(fd, &byte, 1) == 1);
    while (byte != '\n');
    read_bytes(fd, SEGMENT_HEADER + RECORDS * (RECORD_HEADER + 1));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    int fd[2];
    char rest[512];
    if (dir.fd < 0)
        make_log();
    require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fd) == 0);
    struct sender *s = calloc(1, sizeof *s);
    require(s != NULL);
    s->fd = fd[0];
    s->event = event;
    s->dir = &dir;
    s->lineage = dir.lineage;
    s->from = (struct position){dir.lineage.history, 0, DIGEST};
    s->durable = RECORDS;
    require(sender_start(s));
    read_everything(fd[1]);
    for (size_t at = 0; at < size;) {
        ssize_t n = send(fd[1], data + at, size - at, MSG_NOSIGNAL);
        if (n < 0 && errno != EINTR)
            break; /* it makes no sense to the thread */
        at += n > 0 ? (size_t)n : 0;
    }
    shutdown(fd[1], SHUT_WR);
    while (hear(fd[1], rest, sizeof rest) > 0)
        ;
    require(s->acked <= RECORDS);
    sender_end(s);
    close(fd[1]);
    return 0;
}
