/* session_test.c - a session at one end of a pair of sockets, with a server that has no threads. */
#include "server/clients.h"
#include "server/loop.h"
#include "server/session_inside.h"
#include "tests/server/local.h"
#include "tests/test.h"

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
