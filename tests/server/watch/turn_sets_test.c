/* turn_sets_test.c - which watched sets are looked at when: with a session at one end of a pair of sockets, and a server that has
 * no threads. */
#include "server/watch/feed.h"

#include "server/clients/clients.h"
#include "server/jobs/submit.h"
#include "server/session/session.h"
#include "server/system/loop.h"
#include "server/watch/watch.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SETS = 60, ROOM = 1 << 16 };

static struct {
    struct local l;
    struct clients clients;
    struct session *session;
    int client; /* the other end */
} b;

static void begin(void)
{
    int pair[2];
    struct sock_peer peer = {.kind = SOCK_UNIX};
    local_start(&b.l, 0);
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    b.client = pair[0];
    b.session = session_new(&b.l.server, b.l.server.reactor, pair[1], &peer, NULL);
    CHECK(b.session != NULL && clients_add(&b.clients, b.session));
    b.l.server.clients = &b.clients;
}

static void end(void)
{
    conn_close(&b.session->conn);
    loop_clear(&b.l.server.reactor->loop);
    clients_clear(&b.clients);
    local_stop(&b.l);
    close(b.client);
}

/* A turn of the connection, at the beginning of one of the loop. */
static void turn(void)
{
    b.l.server.reactor->loop.turn_ns = clock_ns();
    conn_turn(&b.session->conn);
}

static void ask(const char *lines)
{
    buf_append_text(&b.session->conn.in, lines);
    while (buf_len(&b.session->conn.in) > 0)
        turn();
}

/* Returns the bytes that the client has been sent since the last call. */
static const char *heard(void)
{
    static char text[ROOM + 1];
    ssize_t n;
    size_t at = 0;
    do {
        turn();
        n = recv(b.client, text + at, ROOM - at, 0);
        at += n > 0 ? (size_t)n : 0;
    } while (n > 0);
    text[at] = '\0';
    return text;
}

static unsigned busy(void)
{
    const struct list *all = &b.l.server.watching.busy;
    unsigned n = 0;
    for (const struct list_link *k = list_first(all); k != NULL; k = list_next(all, k))
        n++;
    return n;
}

static bool is_idle(void)
{
    return busy() == 0 && list_is_empty(&b.l.server.watching.now);
}

/* Turns of the loop, until nothing is left to do. */
static void settle(void)
{
    for (int i = 0; i < 1000 && !is_idle(); i++) {
        watch_turn_end(&b.l.server);
        turn();
    }
    CHECK(is_idle());
}

static void watch_many(void)
{
    char line[64];
    for (int i = 0; i < SETS; i++) {
        snprintf(line, sizeof line, "ADD s%d 0 0 1 0 0 1\nWATCH s%d\n", i, i);
        ask(line);
        settle();
        heard();
    }
}

TEST(sets_that_are_merely_watched_are_not_looked_at)
{
    begin();
    watch_many();
    ask("PING\nGET s3 0\nADD other 1 1\nNEAREST s4 0 0\n");
    CHECK(busy() == 0);
    heard();
    ask("ADD s7 5 5\nADD s7 6 6\nADD s9 5 5\n");
    CHECK(busy() == 2);
    settle();
    const char *text = heard();
    CHECK_MSG(strstr(text, "EVENT 1 set=s9 ") != NULL, "%s", text);
    CHECK_MSG(strstr(text, "EVENT 2 set=s7 ") != NULL, "%s", text);
    end();
}

TEST(edit_of_a_watched_set_needs_no_reactor_that_is_alone)
{
    begin();
    ask("ADD s 0 0 1 0 0 1\nWATCH s\n");
    CHECK(local_set(&b.l, "s")->watched != NULL);
    CHECK(submit_shares(local_set(&b.l, "s"), CHANGE_ADD, 1));
    end();
}

TEST(watcher_whose_client_reads_again_gets_what_it_lacks)
{
    static char fill[CONN_OUT_LIMIT];
    begin();
    watch_many();
    do /* until the socket takes no more */
        buf_append(&b.session->conn.out, fill, sizeof fill);
    while (turn(), !conn_full(&b.session->conn));
    local_ask(&b.l, "ADD s5 5 5\nDROP s6\n");
    settle();
    CHECK(b.session->conn.wants_room);
    for (int i = 0; i < 100 && (b.session->conn.wants_room || busy() > 0); i++) {
        while (recv(b.client, fill, sizeof fill, 0) > 0)
            ;
        turn();
    }
    CHECK(busy() == 2);
    settle();
    const char *text = heard();
    CHECK_MSG(strstr(text, "set=s5 ") != NULL && strstr(text, "set=s6 dropped") != NULL, "%s",
              text);
    end();
}

TEST(set_that_is_watched_no_longer_is_forgotten_after_a_minute)
{
    enum { MINUTE_MS = 60 * 1000 };
    begin();
    watch_many();
    struct dataset *set = local_set(&b.l, "s1");
    static const char *const steps[] = {"UNWATCH s1\n", "UNWATCH s2\n", "UNWATCH s3\n",
                                        "ADD s3 7 7\n"};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        ask(steps[i]);
        settle();
    }
    struct watched *k = set->watched;
    CHECK(k != NULL && list_first(&b.l.server.watching.deserted) == (void *)&k->deserted);
    CHECK(list_last(&b.l.server.watching.deserted) == &local_set(&b.l, "s3")->watched->deserted);
    ask("WATCH s2\nDROP s3\n");
    settle();
    CHECK(list_last(&b.l.server.watching.deserted) == &k->deserted);
    k->deserted_ms -= MINUTE_MS - 1000;
    watch_turn_end(&b.l.server);
    CHECK(set->watched == k);
    k->deserted_ms -= 1000;
    watch_turn_end(&b.l.server);
    CHECK(set->watched == NULL && list_is_empty(&b.l.server.watching.deserted));
    CHECK(local_set(&b.l, "s2")->watched != NULL);
    end();
}
