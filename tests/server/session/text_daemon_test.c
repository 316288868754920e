/* text_daemon_test.c - texts of points that are long enough to be parsed by workers: cut anywhere, with faults, from several
 * clients at once, and from clients that disconnect. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LINES = 30000, SOME = 900 * 1024 /* bytes; workers parse from 256 KiB on */ };

static double xy[2 * LINES];
static char text[LINES * 50];
static size_t text_n;

static void make_text(void)
{
    text_n = 0;
    for (int i = 0; i < 2 * LINES; i++) {
        xy[i] = test_uniform();
        text_n += (size_t)sprintf(text + text_n, "%.17g%c", xy[i], i % 2 == 0 ? ' ' : '\n');
    }
    CHECK(text_n > SOME + 10000);
}

static void say_text(int fd, size_t from, size_t to)
{
    say_bytes(fd, text + from, to - from);
}

/* The set has the points of the text `times` times, under the ids in their order. */
static void check_points(int fd, int times)
{
    enum { ROW = 20 };
    say(fd, "POINTS t BINARY\n");
    const char *line = hear_line(fd), *bytes = strstr(line, "bytes=");
    size_t n = (size_t)times * LINES * ROW;
    CHECK_MSG(bytes != NULL && strtoul(bytes + 6, NULL, 10) == n, "%s", line);
    char *got = malloc(n);
    CHECK(got != NULL && recv(fd, got, n, MSG_WAITALL) == (ssize_t)n);
    for (int i = 0; i < times * LINES; i++)
        CHECK(memcmp(got + (size_t)i * ROW + 4, &xy[2 * (i % LINES)], 16) == 0);
    free(got);
}

/* Loads the text after this beginning of the request, in pieces, for every cut of a line; `end` follows. */
static void check_cuts(const char *request, const char *end, const char *reply)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_text();
    for (size_t cut = 0; cut <= 40; cut += 1 + cut % 3) {
        say(fd, request);
        say_text(fd, 0, SOME + cut);
        pause_ms(20);
        say_text(fd, SOME + cut, text_n - cut);
        pause_ms(5);
        say_text(fd, text_n - cut, text_n);
        say(fd, end);
        say(fd, "PING\n");
        expect(fd, reply);
        expect(fd, "OK 0\n");
        check_points(fd, 1);
        say(fd, "DROP t\n");
        expect(fd, "OK 0\n");
    }
}

TEST_TIMEOUT(long_text_may_be_cut_anywhere, 60)
{
    check_cuts("LOAD t 30000\n", "", "OK 0 first=0 added=30000 coincident=0\n");
}

TEST_TIMEOUT(long_text_that_ends_with_a_dot_may_be_cut_anywhere, 60)
{
    check_cuts("LOAD t\n", ".\n", "OK 0 first=0 added=30000 coincident=0\n");
}

TEST_TIMEOUT(long_text_in_resp_may_be_cut_anywhere, 60)
{
    char request[200];
    make_text();
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (size_t cut = 0; cut <= 40; cut++) {
        snprintf(request, sizeof request, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$5\r\n30000\r\n$%zu\r\n",
                 text_n);
        say(fd, request);
        say_text(fd, 0, SOME + cut);
        pause_ms(20);
        say_text(fd, SOME + cut, text_n);
        say(fd, "\r\nPING\n");
        expect(fd, "+OK first=0 added=30000 coincident=0\r\nOK 0\n");
        check_points(fd, 1);
        say(fd, "DROP t\n");
        expect(fd, "OK 0\n");
    }
}

TEST(bad_line_of_a_long_text_is_named_and_the_next_request_is_found)
{
    static const int bad[] = {0, 9000, 20000, 29999};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (int i = 0; i < 4; i++) {
        char want[100], *line = text;
        make_text();
        for (int k = 0; k < bad[i]; k++)
            line = strchr(line, '\n') + 1;
        *strchr(line, ' ') = 'x';
        say(fd, "LOAD t 30000\n");
        say_text(fd, 0, text_n);
        say(fd, "SETS\n");
        snprintf(want, sizeof want, "ERR SYNTAX line %d: not `x y`; nothing was loaded\nOK 0\n",
                 bad[i] + 1);
        expect(fd, want);
    }
    CHECK(daemon_info(&d, "loading") == 0);
}

TEST(long_texts_of_several_clients_arrive_at_once)
{
    enum { CLIENTS = 4, PIECE = 100000 };
    struct daemon d = daemon_start(NULL);
    int fd[CLIENTS];
    make_text();
    for (int i = 0; i < CLIENTS; i++) {
        fd[i] = daemon_connect(&d);
        say(fd[i], "LOAD t 30000\n");
    }
    for (size_t at = 0; at < text_n; at += PIECE)
        for (int i = 0; i < CLIENTS; i++)
            say_text(fd[i], at, at + PIECE < text_n ? at + PIECE : text_n);
    for (int i = 0; i < CLIENTS; i++)
        CHECK(strncmp(hear_line(fd[i]), "OK 0 first=", 11) == 0);
    check_points(fd[0], CLIENTS);
}

TEST(requests_behind_a_long_text_are_answered_in_order)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_text();
    for (int i = 0; i < 3; i++) {
        say(fd, i % 2 == 0 ? "LOAD t\n" : "LOAD t 30000\n");
        say_text(fd, 0, text_n);
        say(fd, i % 2 == 0 ? ".\nPING\nGET t 0\n" : "PING\nGET t 0\n");
    }
    for (int i = 0; i < 3; i++) {
        char want[100];
        snprintf(want, sizeof want, "OK 0 first=%d added=30000 coincident=%d\n", i * LINES,
                 i == 0 ? 0 : LINES);
        expect(fd, want);
        expect(fd, "OK 0\nOK 1\n");
        CHECK(strncmp(hear_line(fd), "0 ", 2) == 0);
    }
    check_points(fd, 3);
}

TEST(client_that_disconnects_in_a_long_text_leaves_nothing)
{
    struct daemon d = daemon_start(NULL);
    make_text();
    for (int i = 0; i < 20; i++) {
        int fd = daemon_connect(&d);
        say(fd, "LOAD t\n");
        say_text(fd, 0, SOME + (size_t)i * 1000);
        pause_ms((unsigned)i % 3);
        close(fd);
    }
    await_info(&d, "loading", 0);
    converse(&d, "SETS\n", "OK 0\n");
}

TEST(long_text_may_end_with_the_input_and_without_its_last_line_end)
{
    struct daemon d = daemon_start(NULL);
    make_text();
    for (int whole = 0; whole < 2; whole++) {
        size_t n;
        int fd = daemon_connect(&d);
        say(fd, whole ? "LOAD t 30000\n" : "LOAD t 30001\n");
        say_text(fd, 0, text_n - 1);
        CHECK(shutdown(fd, SHUT_WR) == 0);
        char *got = hear_all(fd, &n);
        test_drop_versions(got);
        CHECK_STR(got,
                  whole ? "OK 0 first=0 added=30000 coincident=0\n"
                        : "ERR SYNTAX line 30001: the input ended too early; nothing was loaded\n");
        free(got);
        close(fd);
    }
}

TEST(nul_in_a_line_of_a_long_text_that_has_no_end_yet_is_refused_at_once)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_text();
    say(fd, "LOAD t\n");
    say_text(fd, 0, text_n);
    say_bytes(fd, "1 \0", 3);
    expect(fd, "ERR SYNTAX NUL byte in request\n");
    expect_end(fd);
    close(fd);
    await_info(&d, "loading", 0);
}

TEST(daemon_that_is_stopped_does_not_wait_for_the_rest_of_a_long_text)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    make_text();
    say(fd, "LOAD t\n");
    say_text(fd, 0, SOME);
    double before = seconds();
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    CHECK(seconds() - before < 5 * test_slowness());
    close(fd);
}

TEST(long_text_that_does_not_fit_into_the_memory_is_refused_and_the_client_stays)
{
    static const char *const arguments[] = {"--max-memory", "2m", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    make_text();
    for (int i = 0; i < 3; i++) {
        say(fd, "LOAD t\n");
        for (int k = 0; k < 6; k++)
            say_text(fd, 0, text_n);
        say(fd, ".\nPING\n");
        const char *line = hear_line(fd);
        CHECK_MSG(strncmp(line, "ERR NOMEM", 9) == 0 || strncmp(line, "ERR BUSY", 8) == 0, "%s",
                  line);
        expect(fd, "OK 0\n");
    }
    CHECK(daemon_info(&d, "loading") == 0);
}
