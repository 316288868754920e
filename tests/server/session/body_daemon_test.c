/* body_daemon_test.c - large binary bodies, which are received right into their array: cut anywhere, with faults, from
 * several clients at once, and from clients that disconnect. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { POINTS = 10000, BYTES = POINTS * 16, DIRECT = 80 * 1024 /* received so from here on */ };

static double body[2 * POINTS];

static void make_body(void)
{
    for (int i = 0; i < 2 * POINTS; i++)
        body[i] = test_uniform();
}

/* Sends the part of the body from `from` on, up to `to`. */
static void say_body(int fd, size_t from, size_t to)
{
    say_bytes(fd, (const char *)body + from, to - from);
}

/* The points and values of the set, as bytes, which the caller frees; *n: how many. */
static char *table(int fd, bool fields, size_t *n)
{
    say(fd, fields ? "POINTS t FIELDS a,b,c BINARY\n" : "POINTS t BINARY\n");
    const char *line = hear_line(fd), *bytes = strstr(line, "bytes=");
    CHECK_MSG(bytes != NULL, "%s", line);
    *n = strtoul(bytes + strlen("bytes="), NULL, 10);
    char *got = malloc(*n);
    CHECK(got != NULL && recv(fd, got, *n, MSG_WAITALL) == (ssize_t)*n);
    return got;
}

/* Loads the body after this beginning of the request, in two pieces, for every cut of two points; `end` follows. The set is
 * always the same. */
static void check_cuts(const struct daemon *d, const char *request, const char *end,
                       const char *reply)
{
    char *want = NULL;
    size_t n = 0;
    bool fields = strstr(request, "FIELDS") != NULL;
    for (size_t cut = 0; cut <= 40; cut++) {
        size_t got_n;
        int fd = daemon_connect(d);
        say(fd, request);
        say_body(fd, 0, DIRECT - 1000);
        pause_ms(5);
        say_body(fd, DIRECT - 1000, DIRECT + cut);
        pause_ms(5);
        say_body(fd, DIRECT + cut, BYTES);
        say(fd, end);
        say(fd, "PING\n");
        expect(fd, reply);
        expect(fd, "OK 0\n");
        char *got = table(fd, fields, &got_n);
        if (cut == 0)
            want = got, n = got_n;
        CHECK(got_n == n && memcmp(got, want, n) == 0);
        if (cut > 0)
            free(got);
        say(fd, "DROP t\n");
        expect(fd, "OK 0\n");
        close(fd);
    }
    free(want);
}

TEST_TIMEOUT(large_binary_body_may_be_cut_anywhere, 60)
{
    struct daemon d = daemon_start(NULL);
    make_body();
    check_cuts(&d, "LOADB t 10000\n", "", "OK 0 first=0 added=10000 coincident=0\n");
    check_cuts(&d, "LOADB t 4000 FIELDS a,b,c\n", "", /* 5 numbers a point */
               "OK 0 first=0 added=4000 coincident=0\n");
}

TEST_TIMEOUT(large_binary_body_in_resp_may_be_cut_anywhere, 60)
{
    struct daemon d = daemon_start(NULL);
    make_body();
    check_cuts(&d, "*4\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$5\r\n10000\r\n$160000\r\n", "\r\n",
               "+OK first=0 added=10000 coincident=0\r\n");
}

TEST(points_of_a_large_body_get_ids_in_the_order_in_which_they_arrive)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char want[100];
    make_body();
    say(fd, "LOADB t 10000\n");
    for (size_t at = 0; at < BYTES; at += 10007)
        say_body(fd, at, at + 10007 < BYTES ? at + 10007 : BYTES);
    expect(fd, "OK 0 first=0 added=10000 coincident=0\n");
    for (int id = 0; id < POINTS; id += 7) {
        char get[30];
        double x, y;
        int got;
        snprintf(get, sizeof get, "GET t %d\n", id);
        say(fd, get);
        expect(fd, "OK 1\n");
        snprintf(want, sizeof want, "%s", hear_line(fd));
        CHECK(sscanf(want, "%d %lf %lf", &got, &x, &y) == 3);
        CHECK(got == id && x == body[2 * id] && y == body[2 * id + 1]);
    }
}

TEST(invalid_point_of_a_large_body_is_named_and_the_next_request_is_found)
{
    static const int at[] = {0, 4095, 4096, 5000, 9999};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (int i = 0; i < 5; i++) {
        char want[200];
        make_body();
        body[2 * at[i] + 1] = (double)NAN;
        body[2 * 9999] = 1e300;
        say(fd, "LOADB t 10000\n");
        say_body(fd, 0, DIRECT + 5);
        pause_ms(10);
        say_body(fd, DIRECT + 5, BYTES);
        say(fd, "SETS\n");
        snprintf(want, sizeof want, "ERR NUMBER point %d: not a number; nothing was loaded\n",
                 at[i] + 1);
        expect(fd, want);
        expect(fd, "OK 0\n");
    }
}

TEST(large_body_beyond_the_limit_of_points_is_refused_at_that_point)
{
    static const char *const arguments[] = {"--max-points", "9000", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    make_body();
    say(fd, "LOADB t 10000\n");
    say_body(fd, 0, DIRECT + 5);
    pause_ms(10);
    say_body(fd, DIRECT + 5, BYTES);
    say(fd, "PING\n");
    expect(fd, "ERR TOOBIG point 9001: a set holds at most 9000 points (--max-points); nothing was "
               "loaded\nOK 0\n");
}

/* A client stops in the middle of its body: it disconnects, or (half) it first shuts its sending side down. */
static void end_in_the_middle(bool half)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_body();
    say(fd, "LOADB t 10000\n");
    say_body(fd, 0, DIRECT + 5);
    await_info_least(&d, "loading", DIRECT);
    if (half) {
        size_t n;
        CHECK(shutdown(fd, SHUT_WR) == 0);
        char *got = hear_all(fd, &n);
        CHECK_STR(got, "ERR SYNTAX point 5121: the input ended too early; nothing was loaded\n");
        free(got);
    }
    close(fd);
    await_info(&d, "loading", 0);
    converse(&d, "SETS\n", "OK 0\n");
}

TEST(client_that_disconnects_in_a_large_body_leaves_nothing)
{
    end_in_the_middle(false);
}

TEST(large_body_that_ends_too_early_is_refused)
{
    end_in_the_middle(true);
}

TEST(large_bodies_of_several_clients_arrive_at_once)
{
    enum { CLIENTS = 5 };
    struct daemon d = daemon_start(NULL);
    int fd[CLIENTS];
    make_body();
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "LOADB t 10000\n");
    }
    for (size_t at = 0; at < BYTES; at += 16000)
        for (int i = 0; i < CLIENTS; i++)
            say_body(fd[i], at, at + 16000);
    for (int i = 0; i < CLIENTS; i++)
        CHECK(strncmp(hear_line(fd[i]), "OK 0 first=", 11) == 0);
    for (int id = 0; id < CLIENTS * POINTS; id += 997) {
        char get[30];
        double x, y;
        int got;
        snprintf(get, sizeof get, "GET t %d\n", id);
        say(fd[0], get);
        expect(fd[0], "OK 1\n");
        CHECK(sscanf(hear_line(fd[0]), "%d %lf %lf", &got, &x, &y) == 3);
        CHECK(got == id && x == body[2 * (id % POINTS)] && y == body[2 * (id % POINTS) + 1]);
    }
}

TEST(requests_behind_a_large_body_are_answered_in_order)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_body();
    for (int i = 0; i < 3; i++) {
        say(fd, "LOADB t 10000\n");
        say_body(fd, 0, BYTES);
        say(fd, "PING\nSETS\n");
    }
    for (int i = 0; i < 3; i++) {
        char want[100];
        snprintf(want, sizeof want, "OK 0 first=%d added=10000 coincident=%d\n", i * POINTS,
                 i == 0 ? 0 : POINTS);
        expect(fd, want);
        expect(fd, "OK 0\nOK 1\n");
        CHECK(strncmp(hear_line(fd), "t ", 2) == 0);
    }
}

TEST(daemon_that_is_stopped_does_not_wait_for_the_rest_of_a_large_body)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_body();
    say(fd, "LOADB t 10000\n");
    say_body(fd, 0, DIRECT + 5);
    pause_ms(20);
    double before = seconds();
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    CHECK(seconds() - before < 5 * test_slowness());
    close(fd);
}
