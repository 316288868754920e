/* framing_test.c - requests cut at every byte, and input that is not a request. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void converse_alone(const char *request, const char *want)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, request, want);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(requests_may_be_cut_anywhere)
{
    static const char script[] = "ADD t 0 0\r\nLOAD t\n1 0\r\n0 1\n.\nTRIANGULATE u\nget t 1\n";
    struct daemon d = daemon_start(NULL);
    for (size_t cut = 0; cut < sizeof script; cut++) {
        int fd = daemon_connect(&d);
        say_bytes(fd, script, cut);
        pause_ms(2);
        say(fd, script + cut);
        expect(fd, "OK 0 first=0 added=1 coincident=0\nOK 0 first=1 added=2 coincident=0\n"
                   "ERR NOSET there is no set u\nOK 1\n1 1 0\n");
        say(fd, "DROP t\n");
        expect(fd, "OK 0\n");
        close(fd);
    }
}

TEST(requests_may_arrive_byte_by_byte)
{
    static const char script[] = "ADD t 0 0\r\nLOAD t 1\n1 0\r\nLOADB t 1\nabcdefghabcdefgXPING\n";
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (size_t i = 0; i < sizeof script - 1; i++) {
        say_bytes(fd, script + i, 1);
        pause_ms(1);
    }
    expect(fd, "OK 0 first=0 added=1 coincident=0\nOK 0 first=1 added=1 coincident=0\n"
               "ERR RANGE point 1: a coordinate is 0 or has a magnitude from 2^-142 to 2^201; "
               "nothing was loaded\nOK 0\n");
}

TEST(last_line_may_lack_its_lf)
{
    converse_alone("PING\nPING", "OK 0\nOK 0\n");
    converse_alone("", "");
}

/* Sends raw bytes and compares the reply before the daemon closes the connection. */
static void expect_refusal(const char *bytes, size_t n, const char *want)
{
    size_t got_n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say_bytes(fd, bytes, n);
    char *got = hear_all(fd, &got_n);
    CHECK_STR(got, want);
    free(got);
    close(fd);
    converse(&d, "SETS\n", "OK 0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(nul_closes_the_connection)
{
    expect_refusal("PING\nADD t 1\0 1\nADD t 1 1\n", 26, "OK 0\nERR SYNTAX NUL byte in request\n");
    expect_refusal("LOAD t\n1 1\0\n.\nADD t 1 1\n", 24, "ERR SYNTAX NUL byte in request\n");
    expect_refusal("PI\0", 3, "ERR SYNTAX NUL byte in request\n");
}

TEST(line_that_is_too_long_closes_the_connection)
{
    size_t n = 1000000;
    char *line = malloc(n);
    CHECK(line != NULL);
    memset(line, 'x', n);
    expect_refusal(line, n, "ERR TOOLONG line longer than 65536 bytes\n");
    memcpy(line, "LOAD t\n", 7);
    expect_refusal(line, n, "ERR TOOLONG line longer than 65536 bytes\n");
    free(line);
}

TEST(line_may_be_64_kib_long)
{
    char *line = malloc(65536 + 2);
    CHECK(line != NULL);
    memset(line, ' ', 65536);
    memcpy(line, "PING", 4);
    memcpy(line + 65536, "\n", 2);
    converse_alone(line, "OK 0\n");
    free(line);
}

TEST(body_line_may_be_64_kib_long_too)
{
    char *load = malloc(65536 + 100);
    CHECK(load != NULL);
    size_t n = (size_t)sprintf(load, "LOAD t\n1 1\n");
    memset(load + n, ' ', 65536);
    load[n + 65533] = '2';
    load[n + 65535] = '3';
    strcpy(load + n + 65536, "\n.\nGET t 1\n");
    converse_alone(load, "OK 0 first=0 added=2 coincident=0\nOK 1\n1 2 3\n");
    free(load);
}

TEST(line_of_16000_points_is_one_request)
{
    enum { POINTS = 16000 };
    struct daemon d = daemon_start(NULL);
    char *line = malloc(65536);
    CHECK(line != NULL);
    size_t n = (size_t)sprintf(line, "ADD t");
    for (int i = 0; i < POINTS; i++)
        n += (size_t)sprintf(line + n, " %d %d", i % 10, i % 7);
    strcpy(line + n, "\n");
    CHECK(n <= 65536);
    converse(&d, line, "OK 0 first=0 added=16000 coincident=15930\n");
    free(line);
}

TEST(browsers_are_disconnected)
{
    converse_alone("POST / HTTP/1.1\r\nADD t 1 1\r\nContent-Length: 10\r\n\r\nADD t 1 1\n", "");
    converse_alone("PING\nHost: example\nADD t 1 1\n", "OK 0\n");
}

TEST(quit_answers_the_requests_before_it)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "PING\nQUIT\nADD t 1 1\n");
    expect(fd, "OK 0\nOK 0\n");
    expect_end(fd);
    converse(&d, "SETS\n", "OK 0\n");
}

TEST(random_bytes_do_no_harm)
{
    struct daemon d = daemon_start(NULL);
    for (int round = 0; round < 200; round++) {
        char bytes[600];
        size_t got;
        for (size_t i = 0; i < sizeof bytes; i++)
            bytes[i] = (char)(round % 2 ? ' ' + (int)test_below(96) : (int)test_below(256));
        for (size_t i = 0; i < 20; i++)
            bytes[test_below(sizeof bytes)] = '\n';
        int fd = daemon_connect(&d);
        say_bytes(fd, bytes, sizeof bytes);
        shutdown(fd, SHUT_WR);
        free(hear_all(fd, &got));
        close(fd);
    }
    converse(&d, "PING\n", "OK 0\n");
}
