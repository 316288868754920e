/* session_test.c - a session at one end of a pair of sockets, with a server that has no threads. */
#include "server/clients.h"
#include "server/loop.h"
#include "server/session_inside.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

TEST(change_whose_client_was_killed_in_the_same_turn_holds_no_reply)
{
    int pair[2];
    struct local l;
    struct loop loop;
    struct sock_peer peer = {.kind = SOCK_UNIX};
    local_start(&l, 0);
    CHECK(loop_init(&loop));
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    struct session *s = session_new(&l.server, &loop, pair[1], &peer, NULL);
    CHECK(s != NULL);
    conn_close(&s->conn);
    struct answer a = session_answer(s);
    a.lsn = 1;
    session_take_over(s, &a);
    CHECK(l.server.held.first == NULL);
    loop_clear(&loop);
    local_stop(&l);
    close(pair[0]);
}

/* It was to be carried out again, for which the deadline itself answers nothing. */
TEST(request_whose_turn_comes_after_its_deadline_is_not_carried_out)
{
    int pair[2];
    char reply[100] = "";
    struct local l;
    struct loop loop;
    struct sock_peer peer = {.kind = SOCK_UNIX};
    local_start(&l, 0);
    CHECK(loop_init(&loop));
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    struct session *s = session_new(&l.server, &loop, pair[1], &peer, NULL);
    CHECK(s != NULL);
    loop.now_ms = 1000;
    s->deadline_ms = 999;
    buf_append(&s->conn.in, "ADD t 1 1\n", 10);
    s->held = 10;
    conn_turn(&s->conn);
    conn_turn(&s->conn); /* sends */
    CHECK(read(pair[0], reply, sizeof reply - 1) > 0);
    CHECK_MSG(strncmp(reply, "ERR TIMEOUT ", 12) == 0, "%s", reply);
    CHECK(l.server.sets.sets == 0 && buf_len(&s->conn.in) == 0 && s->deadline_ms == 0);
    conn_close(&s->conn);
    loop_clear(&loop);
    local_stop(&l);
    close(pair[0]);
}
