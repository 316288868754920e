/* session_fuzz.c - libFuzzer target: any bytes from a client, to a whole session at one end of a pair
 * of sockets, with a server of its own that has no threads. The first byte chooses where the rest
 * is cut in two. The session must end when the input has ended, and its output must be
 * replies. */
#include "proto/reply_read.h"
#include "server/clients/clients.h"
#include "server/jobs/server.h"
#include "server/lifecycle.h"
#include "server/session/session.h"
#include "server/system/loop.h"
#include "server/system/notice.h"
#include "server/watch/watch.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { ROOM = 64 * 1024 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct {
    struct server server;
    struct clients clients;
    int fd; /* the client's end */
    const uint8_t *rest;
    size_t left;
    struct buf replies;
} f;

static void require(bool condition)
{
    if (!condition)
        abort();
}

static void on_closed(struct session *s)
{
    clients_remove(&f.clients, s);
    loop_stop(&f.server.reactor->loop);
}

static void hear(void)
{
    ssize_t n;
    do {
        char *to = buf_reserve(&f.replies, ROOM);
        require(to != NULL);
        n = recv(f.fd, to, ROOM, MSG_DONTWAIT);
        if (n > 0)
            buf_commit(&f.replies, (size_t)n);
    } while (n > 0);
}

/* The client: sends the rest of its input, then reads. */
static void on_turn_end(struct loop *loop)
{
    (void)loop;
    watch_turn_end(&f.server);
    if (f.rest != NULL) {
        send(f.fd, f.rest, f.left, MSG_NOSIGNAL | MSG_DONTWAIT);
        shutdown(f.fd, SHUT_WR);
        f.rest = NULL;
    }
    hear();
}

static void converse(const uint8_t *data, size_t size, size_t cut)
{
    int pair[2];
    struct sock_peer peer = {.kind = SOCK_UNIX};
    require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    f.server.reactor->loop.stopped = false;
    f.fd = pair[0];
    send(f.fd, data, cut, MSG_NOSIGNAL | MSG_DONTWAIT);
    f.rest = data + cut;
    f.left = size - cut;
    struct session *s = session_new(&f.server, f.server.reactor, pair[1], &peer, on_closed);
    require(s != NULL && clients_add(&f.clients, s));
    conn_again(&s->conn); /* so that a turn ends even if nothing was sent first */
    loop_run(&f.server.reactor->loop);
    hear();
    close(f.fd);
}

/* If no request is in RESP, the output consists of replies in lines, with events between them. */
static void look_at_replies(void)
{
    struct reply_reader reader = {.events = true};
    struct reply_part part;
    size_t at = 0, n = buf_len(&f.replies);
    while (at < n) {
        ptrdiff_t took = reply_read(&reader, buf_head(&f.replies) + at, n - at, &part);
        require(took > 0);
        at += (size_t)took;
    }
    require(reply_reader_idle(&reader));
}

/* The server is started once; its sets are dropped after each input. */
static void start_once(void)
{
    static struct config config;
    if (f.server.config != NULL)
        return;
    config_init(&config);
    config.threads = 0;
    config.max_points = 5000; /* otherwise some inputs would take too long */
    notice_set_level(NOTICE_ERROR);
    require(server_init(&f.server, &config));
    f.server.clients = &f.clients;
    f.server.reactor->loop.turn_end = on_turn_end;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    start_once();
    converse(data + 1, size - 1, size > 1 ? data[0] % (size - 1) : 0);
    require(f.clients.n == 0 && budget_of(&f.server.budget, BUDGET_LOADS) == 0);
    if (memchr(data + 1, '*', size - 1) == NULL)
        look_at_replies();
    buf_consume(&f.replies, buf_len(&f.replies));
    watch_clear(&f.server); /* otherwise what has changed in its sets is kept for a minute */
    registry_clear(&f.server.sets);
    require(f.server.sets.sets == 0 && budget_of(&f.server.budget, BUDGET_SETS) == 0);
    return 0;
}
