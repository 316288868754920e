/* sender.c - see sender.h. */
#include "server/follow/sender.h"

#include "server/disk/segment_reader.h"
#include "server/system/loop.h"

#include <errno.h>
#include <fcntl.h>
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

enum {
    PIECE = 256 * 1024, /* bytes that are sent at a time */
    MEMORY = 4 * PIECE, /* of a sender: what it reads and what it sends, with room to grow */
    GATHER_MS = 6,      /* changes are gathered for at most so long */
    BEAT_MS = 1000,     /* a header is sent after so long without records */
    SEND_MS = 60 * 1000 /* a follower that reads nothing for so long is disconnected */
};

/* The state of the sending thread. */
struct sending {
    struct sender *s;
    struct buf out;
    struct buf in;              /* lines of the follower */
    struct position at;         /* up to where everything has been put into `out` */
    struct segment_reader file; /* the segment of at.lsn + 1 */
    bool open;
    uint64_t first;     /* of that segment */
    struct lineage now; /* of that segment */
    uint32_t version;   /* of the files that are sent */
};

static void notify(const struct sender *s)
{
    eventfd_write(s->event, 1);
}

static void close_file(struct sending *g)
{
    if (g->open)
        reader_close(&g->file);
    g->open = false;
}

/* ---- the socket ---- */

/* Takes the lines of the follower. False: they make no sense. */
static bool take_lines(struct sending *g)
{
    for (;;) {
        const char *line = buf_head(&g->in);
        const char *end = buf_len(&g->in) > 0 ? memchr(line, '\n', buf_len(&g->in)) : NULL;
        char text[64];
        uint64_t lsn, bytes;
        if (end == NULL)
            return buf_len(&g->in) < sizeof text;
        size_t n = (size_t)(end - line);
        if (n >= sizeof text)
            return false;
        memcpy(text, line, n);
        text[n] = '\0';
        buf_consume(&g->in, n + 1);
        if (sscanf(text, "ACK %" SCNu64 " %" SCNu64, &lsn, &bytes) != 2 || lsn > g->at.lsn)
            return false;
        g->s->acked_bytes = bytes;
        g->s->acked = lsn;
        g->s->silent_ms = bytes >= g->s->sent_bytes ? 0 : clock_ms();
        notify(g->s);
    }
}

/* Reads the lines that the follower has sent. False: the connection has ended. */
static bool hear(struct sending *g)
{
    char *to = buf_reserve(&g->in, 4096);
    if (to == NULL)
        return false;
    ssize_t n = recv(g->s->fd, to, 4096, MSG_DONTWAIT);
    if (n < 0)
        return errno == EAGAIN || errno == EINTR;
    buf_commit(&g->in, (size_t)n);
    return n > 0 && take_lines(g);
}

/* Waits until the socket has one of the events, or `durable` has grown, at most ms. False: the connection has
 * ended, or is to end. */
static bool wait_for(struct sending *g, short events, int ms)
{
    struct pollfd p[] = {{.fd = g->s->fd, .events = (short)(POLLIN | events)},
                         {.fd = g->s->wake, .events = POLLIN}};
    eventfd_t count;
    if (poll(p, 2, ms) < 0 && errno != EINTR)
        return false;
    if ((p[1].revents & POLLIN) != 0)
        eventfd_read(g->s->wake, &count);
    if (g->s->stop || (p[0].revents & (POLLERR | POLLNVAL)) != 0)
        return false;
    return (p[0].revents & (POLLIN | POLLHUP)) == 0 || hear(g);
}

/* Sends all of `out`. */
static bool flush(struct sending *g)
{
    int64_t until = clock_ms() + SEND_MS;
    while (buf_len(&g->out) > 0) {
        ssize_t n =
            send(g->s->fd, buf_head(&g->out), buf_len(&g->out), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (n > 0) {
            buf_consume(&g->out, (size_t)n);
            g->s->sent_bytes += (uint64_t)n;
            until = clock_ms() + SEND_MS;
            if (g->s->silent_ms == 0)
                g->s->silent_ms = clock_ms();
        } else if (errno != EAGAIN && errno != EINTR) {
            return false;
        } else if (clock_ms() > until || !wait_for(g, POLLOUT, 1000)) {
            return false;
        }
    }
    g->s->sent = g->at.lsn;
    return !g->s->stop && !g->out.failed;
}

/* ---- headers ---- */

static bool put_header(struct sending *g, enum segment_kind kind)
{
    struct segment h = {.version = g->version,
                        .kind = kind,
                        .lsn = kind == SEGMENT_LOG ? g->at.lsn + 1 : g->at.lsn,
                        .life = g->now.life,
                        .history = g->now.history,
                        .digest = g->at.digest};
    char *to = buf_reserve(&g->out, SEGMENT_HEADER);
    if (to == NULL)
        return false;
    segment_write(to, &h);
    buf_commit(&g->out, SEGMENT_HEADER);
    return true;
}

/* ---- the files ---- */

/* The records that follow are from a file with this header. */
static void take_header(struct sending *g, const struct segment *header)
{
    g->now = (struct lineage){header->life, header->history};
    g->version = header->version > RECORD_VERSION_PLAIN ? header->version : RECORD_VERSION_PLAIN;
}

/* Opens a file in place of the one that is open, and reads its header. */
static bool open_file(struct sending *g, const struct datafile *f, struct segment *header)
{
    close_file(g);
    g->open = true; /* also if it fails: there may be a descriptor */
    if (reader_open(&g->file, g->s->dir, f, header) == READER_OK)
        return true;
    close_file(g);
    return false;
}

/* Opens the segment that begins with that lsn and reads its header. */
static bool open_segment(struct sending *g, uint64_t first, struct segment *header)
{
    struct datafile f = {.kind = DATAFILE_LOG, .lsn = first};
    datafile_name(f.name, DATAFILE_LOG, first);
    if (!open_file(g, &f, header))
        return false;
    g->first = first;
    take_header(g, header);
    return true;
}

/* The last segment that begins at lsn or before; 0: there is none. */
static uint64_t find_segment(const struct sending *g, uint64_t lsn)
{
    struct datafile f;
    return datadir_find(g->s->dir, DATAFILE_LOG, lsn, &f) ? f.lsn : 0;
}

enum found { FOUND, FOUND_NOTHING, FOUND_OTHER };

/* Finds the position g->at in the log, and opens the segment after it. */
static enum found find_position(struct sending *g)
{
    struct segment header;
    struct record r;
    uint64_t first = find_segment(g, g->at.lsn + 1);
    if (first == 0 || !open_segment(g, first, &header))
        return FOUND_NOTHING;
    uint64_t lsn = first - 1, digest = header.digest;
    if (digest == 0) /* of a version without digests */
        return FOUND_NOTHING;
    if (lsn == g->at.lsn && digest != g->at.digest)
        return (header.flags & SEGMENT_BROKEN) != 0 ? FOUND_NOTHING : FOUND_OTHER;
    while (lsn < g->at.lsn) {
        if (reader_next(&g->file, &r) != READER_OK || r.lsn != lsn + 1)
            return FOUND_NOTHING;
        lsn++;
        digest = record_digest(digest, reader_bytes(&g->file), g->file.last);
    }
    return digest == g->at.digest ? FOUND : FOUND_OTHER;
}

/* ---- the log ---- */

enum step { STEP_GOOD, STEP_IDLE, STEP_BREAK, STEP_END };

/* Goes to the segment that begins with the next record. */
static enum step next_segment(struct sending *g)
{
    struct segment header;
    if (!open_segment(g, g->at.lsn + 1, &header))
        return STEP_BREAK;
    if (header.digest != g->at.digest)
        return STEP_BREAK;
    return put_header(g, SEGMENT_LOG) ? STEP_GOOD : STEP_END;
}

/* The file has no whole record where one is durable: it is being written, or another segment has it. */
static enum step miss_record(struct sending *g, unsigned *tries)
{
    char name[DATAFILE_NAME];
    enum { TRIES = 2000 }; /* milliseconds */
    g->file.eof = false;
    datafile_name(name, DATAFILE_LOG, g->at.lsn + 1);
    if (faccessat(g->s->dir->fd, name, F_OK, 0) == 0 && g->first != g->at.lsn + 1)
        return next_segment(g);
    if (++*tries > TRIES)
        return STEP_BREAK;
    if (*tries > 1) /* the name of the first one may be that of another file now */
        close_file(g);
    if (!wait_for(g, 0, *tries > 1))
        return STEP_END;
    if (g->open)
        return STEP_GOOD;
    return find_position(g) == FOUND ? STEP_GOOD : STEP_BREAK;
}

/* Puts the next record into `out`. */
static enum step put_record(struct sending *g, unsigned *tries)
{
    uint64_t durable = g->s->durable;
    if (g->at.lsn >= durable)
        return STEP_IDLE;
    struct record r;
    enum reader_result got = reader_next(&g->file, &r);
    if (got == READER_ERROR)
        return STEP_END;
    if (got != READER_OK)
        return miss_record(g, tries);
    if (r.lsn != g->at.lsn + 1)
        return STEP_BREAK;
    *tries = 0;
    const char *bytes = reader_bytes(&g->file);
    buf_append(&g->out, bytes, g->file.last);
    g->at.digest = record_digest(g->at.digest, bytes, g->file.last);
    g->at.lsn++;
    return g->out.failed ? STEP_END : STEP_GOOD;
}

/* Nothing is to be sent: waits. While the follower has not acknowledged what was sent, new changes are gathered. One
 * transmission costs both daemons, and the follower's disk, the same as a lot of changes. */
static bool idle(struct sending *g, int64_t *beat_ms)
{
    if (!flush(g))
        return false;
    if (g->s->acked < g->at.lsn && !wait_for(g, 0, GATHER_MS))
        return false;
    g->s->sleeping = true;
    if (g->at.lsn < g->s->durable) {
        g->s->sleeping = false;
        return true;
    }
    int64_t now = clock_ms();
    bool good = wait_for(g, 0, *beat_ms > now ? (int)(*beat_ms - now) : 0);
    g->s->sleeping = false;
    if (!good || clock_ms() < *beat_ms)
        return good;
    *beat_ms = clock_ms() + BEAT_MS;
    g->now = g->s->lineage; /* of the next record; the file may be of the history before it */
    return put_header(g, SEGMENT_LOG) && flush(g);
}

/* Sends the log from g->at on, until the log is broken or the connection ends. */
static enum step send_log(struct sending *g)
{
    int64_t beat_ms = 0;
    unsigned tries = 0;
    g->s->state = SENDER_LOG;
    notify(g->s);
    if (!put_header(g, SEGMENT_LOG))
        return STEP_END;
    for (;;)
        switch (put_record(g, &tries)) {
        case STEP_GOOD:
            if (buf_len(&g->out) >= PIECE && !flush(g))
                return STEP_END;
            break;
        case STEP_IDLE:
            if (!idle(g, &beat_ms))
                return STEP_END;
            break;
        case STEP_BREAK:
            return flush(g) ? STEP_BREAK : STEP_END;
        case STEP_END:
            return STEP_END;
        }
}

/* ---- a snapshot ---- */

/* Opens the newest snapshot, if it has every change up to `least`. */
static bool open_snapshot(struct sending *g, uint64_t least, struct segment *header)
{
    struct datafile newest;
    return datadir_find(g->s->dir, DATAFILE_SNAPSHOT, UINT64_MAX, &newest) && newest.lsn >= least &&
           open_file(g, &newest, header) && header->digest != 0;
}

/* Waits for a snapshot of changes up to at least `least`. */
static bool await_snapshot(struct sending *g, uint64_t least, struct segment *header)
{
    while (!open_snapshot(g, least, header)) {
        g->s->wants_snapshot = least + 1;
        notify(g->s);
        if (!wait_for(g, 0, 100))
            return false;
    }
    g->s->wants_snapshot = 0;
    return true;
}

/* Sends a snapshot; g->at becomes its position. */
static bool send_snapshot(struct sending *g, uint64_t least)
{
    struct segment header;
    struct record r;
    g->s->state = SENDER_SNAPSHOT;
    notify(g->s);
    if (!await_snapshot(g, least, &header))
        return false;
    take_header(g, &header);
    g->at.lsn = header.lsn;
    g->at.digest = header.digest;
    if (!put_header(g, SEGMENT_SNAPSHOT))
        return false;
    do {
        if (reader_next(&g->file, &r) != READER_OK)
            return false;
        buf_append(&g->out, reader_bytes(&g->file), g->file.last);
        if (g->out.failed || (buf_len(&g->out) >= PIECE && !flush(g)))
            return false;
    } while (r.type != RECORD_END);
    return flush(g);
}

/* ---- the conversation ---- */

static bool put_answer(struct sending *g, enum found found)
{
    static const char *const continues[] = {
        [FOUND] = "yes", [FOUND_NOTHING] = "no", [FOUND_OTHER] = "differs"};
    char history[HISTORY_TEXT], line[160];
    history_write(history, &g->s->lineage.history);
    int n = snprintf(line, sizeof line, "OK 0 history=%s lsn=%" PRIu64 " continues=%s\n", history,
                     (uint64_t)g->s->durable, continues[found]);
    buf_append(&g->out, line, (size_t)n);
    bool sent = flush(g);
    g->s->sent_bytes = 0; /* the stream begins after this line */
    return sent;
}

/* Looks for the position that the follower has asked for. */
static enum found find_start(struct sending *g)
{
    g->at = g->s->from;
    g->now = g->s->lineage;
    if (g->at.digest == 0)
        return FOUND_NOTHING;
    return g->at.lsn > g->s->durable ? FOUND_OTHER : find_position(g);
}

/* Sends the log, and a snapshot whenever the log does not have what comes next. */
static void converse(struct sending *g)
{
    enum found found = find_start(g);
    if (!put_answer(g, found) || found == FOUND_OTHER)
        return;
    enum step step = found == FOUND ? send_log(g) : STEP_BREAK;
    for (uint64_t least = 0; step == STEP_BREAK && send_snapshot(g, least); least = g->at.lsn + 1)
        step = find_position(g) == FOUND ? send_log(g) : STEP_BREAK;
}

static void *serve(void *arg)
{
    struct sender *s = arg;
    struct sending g = {.s = s};
    converse(&g);
    close_file(&g);
    buf_free(&g.out);
    buf_free(&g.in);
    shutdown(s->fd, SHUT_RDWR);
    s->state = SENDER_ENDED;
    notify(s);
    return NULL;
}

bool sender_start(struct sender *s)
{
    unsigned timeout = SENDER_TIMEOUT_MS;
    s->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (s->wake < 0)
        return false;
    /* Otherwise TCP would try for some 15 minutes, and changes would wait. Best effort. */
    (void)setsockopt(s->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &timeout, sizeof timeout);
    reservation_set(&s->memory, MEMORY);
    int error = pthread_create(&s->thread, NULL, serve, s);
    if (error == 0)
        return true;
    reservation_set(&s->memory, 0);
    close(s->wake);
    errno = error;
    return false;
}

void sender_advance(struct sender *s, uint64_t durable)
{
    s->durable = durable;
    if (s->sleeping)
        eventfd_write(s->wake, 1);
}

void sender_end(struct sender *s)
{
    s->stop = true;
    eventfd_write(s->wake, 1);
    shutdown(s->fd, SHUT_RDWR);
    pthread_join(s->thread, NULL);
    reservation_set(&s->memory, 0);
    close(s->wake);
    close(s->fd);
    free(s);
}
