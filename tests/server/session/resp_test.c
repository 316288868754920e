/* resp_test.c - conversations in RESP framing with a real daemon. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

static void converse_alone(const char *request, const char *want)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, request, want);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(resp_and_lines_may_alternate)
{
    converse_alone("*4\r\n$3\r\nADD\r\n$1\r\nt\r\n$1\r\n1\r\n$1\r\n2\r\nGET t 0\n"
                   "*3\r\n$3\r\nGET\r\n$1\r\nt\r\n$1\r\n0\r\nPING\n*1\r\n$4\r\nping\r\n",
                   "+OK first=0 added=1 coincident=0\r\nOK 1\n0 1 2\n"
                   "*1\r\n$5\r\n0 1 2\r\nOK 0\n+PONG\r\n");
}

TEST(resp_may_arrive_byte_by_byte)
{
    static const char script[] = "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n$7\r\n1 2\n3 4\r\n"
                                 "*3\r\n$3\r\nGET\r\n$1\r\nt\r\n$1\r\n1\r\n";
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    for (size_t i = 0; i < sizeof script - 1; i++) {
        say_bytes(fd, script + i, 1);
        pause_ms(1);
    }
    expect(fd, "+OK first=0 added=2 coincident=0\r\n*1\r\n$5\r\n1 3 4\r\n");
}

TEST(resp_load_takes_its_points_as_last_word)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, "*4\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$1\r\n1\r\n$16\r\nABCDEFG@ABCDEFG@\r\nPING\n",
             "+OK first=0 added=1 coincident=0\r\nOK 0\n");
    converse(&d, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n$3\r\n1 2\r\nPING\n",
             "-SYNTAX line 2: the input ended too early; nothing was loaded\r\nOK 0\n");
    converse(&d, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n1\r\n$11\r\n1 2\n3 4\n5 6\r\nPING\n",
             "-SYNTAX more than 1 lines; nothing was loaded\r\nOK 0\n");
    converse(&d, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n0\r\n$0\r\n\r\nPING\n",
             "+OK first=1 added=0 coincident=0\r\nOK 0\n");
    converse(&d, "*4\r\n$4\r\nLOAD\r\n$3\r\nt/t\r\n$1\r\n1\r\n$3\r\n1 2\r\nPING\n",
             "-SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\r\nOK 0\n");
}

TEST(resp_broken_request_closes_the_connection)
{
    converse_alone("*1\r\n$4\r\nPING\r\n*1\r\n:4\r\nPING\n",
                   "+PONG\r\n-SYNTAX not an array of bulk strings\r\n");
    converse_alone("*33000\r\nPING\n",
                   "-TOOLONG a request has at most 131072 bytes; LOAD and LOADB "
                   "take many points\r\n");
}

TEST(resp_words_may_contain_any_byte)
{
    converse_alone("*2\r\n$4\r\nSTAT\r\n$3\r\na\nb\r\n*1\r\n$0\r\n\r\n*1\r\n$5\r\nA\r\nB:\r\n"
                   "*2\r\n$4\r\nECHO\r\n$4\r\n\r\n*1\r\n*0\r\nPING\n",
                   "-SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\r\n"
                   "-ERR unknown command '', with args beginning with: \r\n"
                   "-ERR unknown command 'A??B:', with args beginning with: \r\n"
                   "$4\r\n\r\n*1\r\nOK 0\n");
}

TEST(resp_greets_as_redis_tools_expect)
{
    converse_alone(
        "*2\r\n$6\r\nSELECT\r\n$1\r\n0\r\n*2\r\n$6\r\nSELECT\r\n$1\r\n1\r\n"
        "*3\r\n$6\r\nCLIENT\r\n$7\r\nSETNAME\r\n$1\r\nx\r\n"
        "*3\r\n$6\r\nCONFIG\r\n$3\r\nGET\r\n$4\r\nsave\r\n"
        "*2\r\n$7\r\nCOMMAND\r\n$4\r\nDOCS\r\n*2\r\n$5\r\nHELLO\r\n$1\r\n4\r\n",
        "+OK\r\n-RANGE there is only the database 0\r\n+OK\r\n"
        "*2\r\n$4\r\nsave\r\n$0\r\n\r\n*0\r\n-NOPROTO this server speaks RESP 2 and 3\r\n");
}

TEST(resp_needs_a_token_where_lines_do)
{
    char path[] = "/tmp/delaunayd-tokens-XXXXXX";
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, "rw secret\n", 10) == 10);
    close(file);
    const char *arguments[] = {"--auth-file", path, NULL};
    struct daemon d = daemon_start(arguments);
    converse(&d,
             "*1\r\n$4\r\nSETS\r\n*1\r\n$4\r\nINFO\r\n*1\r\n$4\r\nPING\r\n"
             "*3\r\n$4\r\nAUTH\r\n$1\r\nu\r\n$5\r\nwrong\r\n*3\r\n$4\r\nAUTH\r\n$1\r\nu\r\n$6\r\n"
             "secret\r\n*1\r\n$4\r\nSETS\r\n",
             "-NOAUTH authenticate first: AUTH token\r\n-NOAUTH authenticate first: AUTH token\r\n"
             "+PONG\r\n-WRONGPASS invalid username-password pair or user is "
             "disabled.\r\n+OK\r\n+OK\r\n");
    unlink(path);
}

/* Rows come from a stream and from workers, and the framing continues across pieces. */
TEST(resp_large_replies_are_complete)
{
    enum { N = 50000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char row[64];
    size_t n;
    load_random(fd, "big", N);
    say(fd, "TRIANGULATE big\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=50000 ", 18) == 0);
    close(fd);
    fd = daemon_connect(&d);
    say(fd,
        "*2\r\n$9\r\nTRIANGLES\r\n$3\r\nbig\r\n*3\r\n$6\r\nPOINTS\r\n$3\r\nbig\r\n$6\r\nBINARY\r\n"
        "*1\r\n$4\r\nQUIT\r\n");
    char *got = hear_all(fd, &n), *p = got;
    CHECK(*p == '*');
    unsigned long rows = strtoul(p + 1, &p, 10);
    CHECK(rows > N && rows < 2 * N);
    for (unsigned long i = 0; i < rows; i++) {
        CHECK(memcmp(p, "\r\n$", 3) == 0);
        unsigned long len = strtoul(p + 3, &p, 10);
        CHECK(len < 20 && memchr(p + 2, '\n', len) == NULL);
        p += 2 + len;
    }
    sprintf(row, "\r\n$%d\r\n", N * 20);
    CHECK(strncmp(p, row, strlen(row)) == 0);
    p += strlen(row) + N * 20;
    CHECK_STR(p, "\r\n+OK\r\n");
    free(got);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Types last as long as the connection, and only replies in RESP have them. */
TEST(resp_3_replies_are_typed_from_hello_3_to_hello_2)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 4 0 0 4\n*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n");
    CHECK_STR(hear_line(fd), "OK 0 first=0 added=3 coincident=0");
    CHECK_STR(hear_line(fd), "%7\r");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*3\r\n$3\r\nGET\r\n$1\r\nt\r\n$1\r\n1\r\nGET t 1\n"
            "*5\r\n$7\r\nNEAREST\r\n$1\r\nt\r\n$1\r\n1\r\n$1\r\n0\r\n$1\r\n1\r\n"
            "*2\r\n$6\r\nCLIENT\r\n$7\r\nGETNAME\r\n*1\r\n$4\r\nPING\r\n"
            "*2\r\n$4\r\nDROP\r\n$1\r\nu\r\n*1\r\n$5\r\nHELLO\r\n");
    expect(fd, "*1\r\n*3\r\n:1\r\n,4\r\n,0\r\nOK 1\n1 4 0\n*1\r\n*4\r\n:0\r\n,0\r\n,0\r\n,1\r\n"
               "_\r\n+PONG\r\n-NOSET there is no set u\r\n%7\r\n");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n2\r\n");
    CHECK_STR(hear_line(fd), "*14\r");
    while (strcmp(hear_line(fd), "modules\r") != 0)
        continue;
    expect(fd, "*0\r\n");
    say(fd, "*3\r\n$3\r\nGET\r\n$1\r\nt\r\n$1\r\n1\r\n");
    expect(fd, "*1\r\n$5\r\n1 4 0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Many rows, which workers make, and the rows of jobs. */
TEST(resp_3_types_large_replies)
{
    enum { N = 30000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n;
    load_random(fd, "big", N);
    say(fd, "*2\r\n$5\r\nHELLO\r\n$1\r\n3\r\n*2\r\n$11\r\nTRIANGULATE\r\n$3\r\nbig\r\n"
            "*2\r\n$6\r\nPOINTS\r\n$3\r\nbig\r\n*1\r\n$4\r\nQUIT\r\n");
    char *got = hear_all(fd, &n),
         *p = strstr(got, "modules\r\n*0\r\n%7\r\n$6\r\npoints\r\n:30000\r\n");
    CHECK(p != NULL);
    p = strstr(p, "*30000\r\n");
    CHECK(p != NULL);
    p += strlen("*30000\r\n");
    for (unsigned long i = 0; i < N; i++) {
        CHECK(memcmp(p, "*3\r\n:", 5) == 0 && strtoul(p + 5, &p, 10) == i);
        for (int k = 0; k < 2; k++) {
            CHECK(memcmp(p, "\r\n,", 3) == 0);
            strtod(p + 3, &p);
        }
        p += 2;
    }
    CHECK_STR(p, "+OK\r\n");
    free(got);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}
