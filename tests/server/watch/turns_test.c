/* turns_test.c - the amount of work for many watchers that one turn of the loop does. Many sessions, each at one end of a
 * pair of sockets, and a server that has no threads. */
#include "server/clients/clients.h"
#include "server/session/session.h"
#include "server/system/loop.h"
#include "server/watch/watch.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { WATCHERS = 200 };

static struct {
    struct local l;
    struct clients clients;
    struct session *session[WATCHERS];
    int client[WATCHERS]; /* the other ends */
} b;

static void ask(struct session *s, const char *lines)
{
    buf_append_text(&s->conn.in, lines);
    while (buf_len(&s->conn.in) > 0) {
        b.l.server.reactor->loop.turn_ns = clock_ns();
        conn_turn(&s->conn);
    }
}

/* A set of 100 * 100 points, and many watchers of boxes of 1 by 1: each of another one, or all of the same. */
static void begin(bool same)
{
    struct sock_peer peer = {.kind = SOCK_UNIX};
    char line[64];
    local_start(&b.l, 0);
    b.l.server.clients = &b.clients;
    for (int i = 0; i < 10000; i++) {
        snprintf(line, sizeof line, "ADD t %d %d\n", i % 100, i / 100);
        local_ask(&b.l, line);
    }
    local_ask(&b.l, "TRIANGULATE t\n");
    for (int i = 0; i < WATCHERS; i++) {
        int pair[2];
        CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
        b.client[i] = pair[0];
        b.session[i] = session_new(&b.l.server, b.l.server.reactor, pair[1], &peer, NULL);
        CHECK(b.session[i] != NULL && clients_add(&b.clients, b.session[i]));
        double x = same ? 50 : 0.4 * i;
        snprintf(line, sizeof line, "WATCH t WITHIN %g 50 %g 51\n", x, x + 1);
        ask(b.session[i], line);
    }
}

static void end(void)
{
    for (int i = 0; i < WATCHERS; i++) {
        conn_close(&b.session[i]->conn);
        close(b.client[i]);
    }
    loop_clear(&b.l.server.reactor->loop);
    clients_clear(&b.clients);
    local_stop(&b.l);
}

/* Events that are sent in the next turn. */
static uint64_t turn(void)
{
    uint64_t before = b.l.server.count.events;
    watch_turn_end(&b.l.server);
    return b.l.server.count.events - before;
}

/* The first turn in which events are sent; how many. */
static uint64_t first_turn(void)
{
    uint64_t n = 0;
    for (int i = 0; i < 1000000 && n == 0; i++)
        n = turn();
    CHECK(n > 0 && n <= WATCH_TURN);
    return n;
}

/* Turns until `events` events have been sent. */
static void settle(uint64_t events)
{
    for (int i = 0; i < 1000000 && events > 0; i++) {
        uint64_t n = turn();
        CHECK_MSG(n <= WATCH_TURN && n <= events, "%u in a turn", (unsigned)n);
        events -= n;
    }
    CHECK(events == 0);
    CHECK(turn() == 0);
}

/* Returns the bytes that the client has been sent since the last call. */
static const char *heard(int i)
{
    static char text[1 << 16];
    ssize_t n = recv(b.client[i], text, sizeof text - 1, 0);
    text[n > 0 ? n : 0] = '\0';
    return text;
}

TEST(change_is_reported_to_so_many_watchers_in_a_turn_and_to_the_others_later)
{
    begin(false);
    settle(WATCHERS);
    local_ask(&b.l, "MOVE t 5050 50.2 50.3\n");
    settle(WATCHERS);
    end();
}

TEST(edits_between_two_turns_of_a_watcher_are_one_event)
{
    begin(false);
    settle(WATCHERS);
    for (int i = 0; i < WATCHERS; i++)
        heard(i);
    local_ask(&b.l, "MOVE t 5050 50.2 50.3\n");
    first_turn();
    local_ask(&b.l, "MOVE t 5050 50.4 50.6\nADD t 50.5 50.5\nDEL t 10000\n");
    settle(WATCHERS);
    const char *text = heard(125); /* its box is from 50 to 51 */
    CHECK_MSG(strstr(text, "point 5050 50.4 50.6\n") != NULL, "%s", text);
    CHECK_MSG(strstr(text, "10000") == NULL, "%s", text);
    end();
}

/* The text of an event is kept for those who have not been sent it; some of those who have been leave. */
TEST(point_that_leaves_a_box_is_gone_for_all_its_watchers_when_some_leave_meanwhile)
{
    begin(true);
    settle(WATCHERS);
    for (int i = 0; i < WATCHERS; i++)
        heard(i);
    local_ask(&b.l, "MOVE t 5050 7.5 7.5\n");
    uint64_t left = first_turn(), told = 0;
    for (int i = 0; i < WATCHERS; i++)
        if (strstr(heard(i), "gone 5050\n") != NULL)
            ask(b.session[i], "UNWATCH t\n");
    settle(WATCHERS - left);
    for (int i = 0; i < WATCHERS; i++)
        told += strstr(heard(i), "gone 5050\n") != NULL;
    CHECK(left + told == WATCHERS);
    end();
}

TEST(first_event_of_a_watcher_is_not_older_than_its_request)
{
    char line[100];
    begin(true);
    struct session *last = b.session[WATCHERS - 1];
    ask(last, "UNWATCH t\n");
    first_turn(); /* has made the first event of the others */
    local_ask(&b.l, "MOVE t 5050 7.5 7.5\n");
    heard(WATCHERS - 1);
    ask(last, "WATCH t WITHIN 50 50 51 51\n");
    for (int i = 0; i < 1000000 && !list_is_empty(&b.l.server.watching.busy); i++)
        turn();
    snprintf(line, sizeof line, "EVENT 6 set=t version=%" PRIu64 " reset\n",
             local_set(&b.l, "t")->version);
    const char *text = heard(WATCHERS - 1);
    CHECK_MSG(strncmp(strstr(text, "EVENT "), line, strlen(line)) == 0, "%s", text);
    end();
}

/* Two points are added in a turn, and the first one is deleted. The client knows the version between. */
TEST(client_that_comes_back_is_told_that_a_point_is_gone_which_was_new_in_its_version)
{
    static const char *const boxes[] = {" WITHIN 50 50 51 51", ""};
    char line[100];
    begin(true);
    settle(WATCHERS);
    local_ask(&b.l, "ADD t 50.5 50.5\n");
    uint64_t version = local_set(&b.l, "t")->version;
    local_ask(&b.l, "ADD t 50.6 50.5\nDEL t 10000\n");
    settle(WATCHERS);
    for (int i = 0; i < 2; i++) {
        heard(i);
        snprintf(line, sizeof line, "UNWATCH t\nWATCH t SINCE %" PRIu64 "%s\n", version, boxes[i]);
        ask(b.session[i], line);
        settle(1);
        const char *text = heard(i);
        CHECK_MSG(strstr(text, "gone 10000\n") != NULL && strstr(text, "point 10001 ") != NULL &&
                      strstr(text, "reset") == NULL,
                  "%s", text);
    }
    end();
}

/* The box holds enough points that the whole set is swept, and the first points are outside. */
TEST(first_event_of_a_sweep_that_finds_something_is_the_reset)
{
    enum { OUTSIDE = 25, ALL = 60, ADDED = 1000 };
    static char line[ADDED * 24];
    begin(true);
    settle(WATCHERS);
    for (int i = 0; i < ALL; i++) {
        size_t at = (size_t)snprintf(line, sizeof line, "ADD u");
        for (int k = 0; k < ADDED; k++)
            at += (size_t)snprintf(line + at, sizeof line - at, " %d %d",
                                   i < OUTSIDE ? -1 - k : 1 + k, i);
        snprintf(line + at, sizeof line - at, "\n");
        local_ask(&b.l, line);
    }
    local_ask(&b.l, "TRIANGULATE u\n");
    heard(0);
    ask(b.session[0], "WATCH u WITHIN 0 0 2000 2000\n");
    first_turn();
    const char *event = strstr(heard(0), "EVENT ");
    CHECK(event != NULL && strncmp(event, "EVENT 0 ", 8) != 0);
    CHECK_MSG(strncmp(strchr(event, '\n') - 11, " reset more", 11) == 0, "%.80s", event);
    end();
}
