/* session_test.c - a session at one end of a pair of sockets, with a server that has no threads. */
#include "server/clients/clients.h"
#include "server/session/session.h"
#include "server/session/session_inside.h"
#include "server/system/loop.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct bench {
    struct local l;
    struct session *session;
    int client; /* the other end */
};

static void begin(struct bench *b)
{
    int pair[2];
    struct sock_peer peer = {.kind = SOCK_UNIX};
    local_start(&b->l, 0);
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    b->client = pair[0];
    b->session = session_new(&b->l.server, b->l.server.reactor, pair[1], &peer, NULL);
    CHECK(b->session != NULL);
}

static void end(struct bench *b)
{
    conn_close(&b->session->conn);
    loop_clear(&b->l.server.reactor->loop);
    local_stop(&b->l);
    close(b->client);
}

TEST(change_whose_client_was_killed_in_the_same_turn_delays_no_reply)
{
    struct bench b;
    begin(&b);
    conn_close(&b.session->conn);
    struct answer a;
    session_answer(b.session, &a);
    a.lsn = 1;
    session_take_over(b.session, &a);
    CHECK(list_is_empty(&b.l.server.held.holds[0]));
    end(&b);
}

/* The request waits to be tried again, so the expired deadline alone sends no reply. */
TEST(request_whose_turn_comes_after_its_deadline_is_not_carried_out)
{
    char reply[100] = "";
    struct bench b;
    begin(&b);
    struct session *s = b.session;
    b.l.server.reactor->loop.now_ms = 1000;
    s->deadline_ms = 999;
    buf_append(&s->conn.in, "ADD t 1 1\n", 10);
    s->held = 10;
    conn_turn(&s->conn);
    conn_turn(&s->conn); /* sends */
    CHECK(read(b.client, reply, sizeof reply - 1) > 0);
    CHECK_MSG(strncmp(reply, "ERR TIMEOUT ", 12) == 0, "%s", reply);
    CHECK(b.l.server.sets.sets == 0 && buf_len(&s->conn.in) == 0 && s->deadline_ms == 0);
    end(&b);
}
