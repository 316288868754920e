/* conn_test.c - one connection, with the turns of its loop one by one and a simulated clock. */
#include "server/clients/conn.h"

#include "server/ops/limits.h"
#include "tests/test.h"

#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LINGER_MS = 2000, LINGER_BYTES = 64 * 1024 * 1024 };

struct bench {
    struct loop loop;
    struct conn conn;
    int client;
    unsigned closed, calls; /* of closed and data */
    size_t answer;          /* bytes that the next data appends */
};

static struct bench b;

static void on_data(struct conn *c)
{
    static const char zeros[CONN_OUT_LIMIT];
    b.calls++;
    if (b.answer > 0)
        buf_append(&c->out, zeros, b.answer);
    b.answer = 0;
}

static void on_closed(struct conn *c)
{
    (void)c;
    b.closed++;
}

static void end_of_turn(struct loop *loop)
{
    loop_stop(loop);
}

static void begin(void)
{
    static const struct conn_events events = {.data = on_data, .closed = on_closed};
    int fd[2];
    struct reservation memory = {0};
    b = (struct bench){0};
    CHECK(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fd) == 0 &&
          loop_init(&b.loop, NULL, 0));
    b.loop.turn_end = end_of_turn;
    b.client = fd[1];
    CHECK(conn_init(&b.conn, &b.loop, fd[0], &events, &memory));
}

static void turn(void)
{
    b.loop.stopped = false;
    loop_run(&b.loop);
}

static void end(void)
{
    conn_close(&b.conn);
    loop_clear(&b.loop);
    CHECK(b.closed == 1);
    close(b.client);
}

static void send_some(size_t n)
{
    static const char zeros[1 << 16];
    CHECK(n <= sizeof zeros && send(b.client, zeros, n, 0) == (ssize_t)n);
}

/* Appends to the output until the client's side accepts no further byte. */
static void stall(void)
{
    while (conn_sendable(&b.conn) == 0) {
        b.answer = CONN_OUT_LIMIT;
        conn_turn(&b.conn);
    }
}

TEST(client_that_takes_nothing_is_closed_after_a_while)
{
    begin();
    stall();
    b.loop.awake_ms += LIMIT_STALL_S * 1000;
    conn_check_timeouts(&b.conn);
    CHECK(!b.conn.closed);
    b.loop.awake_ms += 1;
    conn_check_timeouts(&b.conn);
    CHECK(b.conn.closed);
    end();
}

TEST(output_that_the_client_takes_at_last_is_sent_before_it_is_judged)
{
    static char bytes[1 << 20];
    begin();
    stall();
    while (recv(b.client, bytes, sizeof bytes, MSG_DONTWAIT) > 0)
        ;
    b.loop.awake_ms += LIMIT_STALL_S * 1000 + 1;
    conn_check_timeouts(&b.conn);
    CHECK(!b.conn.closed && b.conn.progress_ms == b.loop.awake_ms);
    end();
}

TEST(output_from_outside_is_sent_at_once_and_overtakes_nothing)
{
    char got[8];
    begin();
    CHECK(conn_write(&b.conn, "one", 3));
    CHECK(recv(b.client, got, sizeof got, 0) == 3 && memcmp(got, "one", 3) == 0);
    buf_append(&b.conn.out, "two", 3);
    CHECK(!conn_write(&b.conn, "three", 5));
    turn();
    CHECK(recv(b.client, got, sizeof got, 0) == 8 && memcmp(got, "twothree", 8) == 0);
    end();
}

TEST(nothing_is_read_from_a_client_that_takes_no_replies)
{
    begin();
    stall();
    while (!conn_full(&b.conn)) {
        b.answer = CONN_OUT_LIMIT;
        conn_turn(&b.conn);
    }
    send_some(1000);
    for (int i = 0; i < 3; i++) {
        conn_again(&b.conn); /* so that the loop does not wait */
        turn();
    }
    CHECK(buf_len(&b.conn.in) == 0 && (b.conn.interest & EPOLLIN) == 0);
    end();
}

TEST(owner_that_receives_itself_gets_the_input_and_its_end)
{
    char got[200];
    begin();
    b.conn.receives = true;
    send_some(100);
    turn();
    CHECK(b.calls == 1 && buf_len(&b.conn.in) == 0);
    CHECK(conn_receive(&b.conn, got, 60) == 60 && conn_receive(&b.conn, got, 200) == 40);
    CHECK(conn_receive(&b.conn, got, 200) == 0 && !b.conn.eof && !b.conn.closed);
    shutdown(b.client, SHUT_WR);
    CHECK(conn_receive(&b.conn, got, 200) == 0 && b.conn.eof && !b.conn.closed);
    end();
}

TEST(owner_that_receives_itself_is_called_until_what_has_arrived_before_a_stop_is_read)
{
    char got[200];
    begin();
    b.conn.receives = true;
    send_some(100);
    conn_drain(&b.conn);
    turn();
    CHECK(b.calls > 0 && conn_receive(&b.conn, got, 60) == 60);
    turn();
    CHECK(conn_receive(&b.conn, got, 60) == 40 && !b.conn.eof);
    turn();
    CHECK(conn_receive(&b.conn, got, 60) == 0 && b.conn.eof);
    end();
}

TEST(connection_that_is_deferred_and_closed_in_one_turn_is_freed_in_the_next)
{
    begin();
    conn_again(&b.conn);
    conn_close(&b.conn);
    CHECK(task_is_queued(&b.conn.turn) && task_is_queued(&b.conn.disposal));
    list_remove(&b.conn.disposal.link); /* as the loop does at the end of its turn */
    b.conn.disposal.run(&b.conn.disposal);
    CHECK(b.closed == 0);
    turn();
    CHECK(b.closed == 1 && b.calls == 0);
    loop_clear(&b.loop);
    close(b.client);
}

TEST(short_rest_of_input_is_kept_in_a_small_block)
{
    begin();
    send_some(10);
    turn();
    CHECK(b.calls == 1 && buf_len(&b.conn.in) == 10 && b.conn.in.cap <= CONN_SMALL);
    CHECK(b.loop.spare_in.cap > CONN_SMALL);
    end();
}

TEST(last_reply_is_followed_by_the_end_and_what_the_client_still_sends_is_dropped)
{
    char bytes[16];
    begin();
    b.answer = 3;
    conn_turn(&b.conn);
    conn_finish(&b.conn);
    conn_turn(&b.conn);
    CHECK(recv(b.client, bytes, sizeof bytes, 0) == 3 && recv(b.client, bytes, 3, 0) == 0);
    CHECK(b.conn.lingering && !b.conn.closed);
    send_some(1000);
    turn();
    CHECK(!b.conn.closed && b.conn.dropped == 1000 && buf_len(&b.conn.in) == 0);
    end();
}

TEST(client_that_sends_on_after_its_last_reply_is_closed_after_so_many_bytes_or_seconds)
{
    for (int i = 0; i < 2; i++) {
        begin();
        conn_finish(&b.conn);
        conn_turn(&b.conn);
        CHECK(b.conn.lingering);
        b.conn.dropped = LINGER_BYTES - 1;
        b.loop.awake_ms = b.conn.linger_ms + LINGER_MS;
        conn_check_timeouts(&b.conn);
        CHECK(!b.conn.closed);
        if (i == 0) {
            send_some(2);
            turn();
            CHECK(b.closed == 1);
            loop_clear(&b.loop);
            close(b.client);
        } else {
            b.loop.awake_ms += 1;
            conn_check_timeouts(&b.conn);
            CHECK(b.conn.closed);
            end();
        }
    }
}
