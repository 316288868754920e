/* refused_body_test.c - the body of a refused request is never carried out as requests. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Each body contains requests that would create a set of this name. */
#define TRAP "ADD trap 1 1\n   " /* 16 bytes */
#define TRAP_LINE "ADD trap 1 1\n"

/* Sends the request, and checks that its answer is an error and that no byte of the body has been carried out. If the
 * connection stays open, the next request is found. */
static void check_refused(const struct daemon *d, const char *request, size_t n, bool stays_open)
{
    size_t got_n;
    int fd = daemon_connect(d);
    say_bytes(fd, request, n);
    say(fd, "PING\nQUIT\n");
    char *got = hear_all(fd, &got_n);
    const char *rest = strchr(got, '\n');
    CHECK_MSG(strncmp(got, "ERR ", 4) == 0 || got[0] == '-', "%s -> %s", request, got);
    CHECK_MSG(rest != NULL && strcmp(rest + 1, stays_open ? "OK 0\nOK 0\n" : "") == 0, "%s -> %s",
              request, got);
    free(got);
    close(fd);
    converse(d, "STAT trap\n", "ERR NOSET there is no set trap\n");
}

TEST(body_of_a_refused_request_is_not_carried_out)
{
    static const struct {
        const char *request;
        bool stays_open;
    } cases[] = {
        {"TIMEOUT 1 TIMEOUT 1 LOADB t 1\n" TRAP, true},
        {"TIMEOUT 1 TIMEOUT 1 TIMEOUT 1 LOADB t 2\n" TRAP TRAP, true},
        {"TIMEOUT 1 TIMEOUT 1 LOAD t 1\n" TRAP_LINE, true},
        {"TIMEOUT 1 TIMEOUT x LOAD t\n" TRAP_LINE ".\n", true},
        {"TIMEOUT 0 LOCATEB t 1\n" TRAP, true},
        {"timeout nan nearestb t 1 2\n" TRAP, true},
        {"TIMEOUT x FSETB t z 0 2\n" TRAP, true},
        {"TIMEOUT -1 INTERPOLATEB t z 1 MAXEDGE 1\n" TRAP, true},
        {"TIMEOUT x LOADB t 1 FIELDS a,b\n" TRAP TRAP, true},
        {"TIMEOUT LOADB t 1\n" TRAP, false},
        {"TIMEOUT TIMEOUT 1 LOADB t 1\n" TRAP, false},
        {"TIMEOUT 1 1 LOADB t 1\n" TRAP, false},
        {"TIMEOUT 1 TIMEOUT 1 LOADB t x\n" TRAP, false},
        {"TIMEOUT 1 TIMEOUT 1 LOADB t\n" TRAP, false},
        {"BINARY LOADB t 1\n" TRAP, false},
        {"INTERPOLATEB t z 1 MAXEDGE\n" TRAP, true},
        {"FSETB t z 0 1 2\n" TRAP, false},
        {"LOCATEB t 1 1\n" TRAP, false},
    };
    struct daemon d = daemon_start(NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_refused(&d, cases[i].request, strlen(cases[i].request), cases[i].stays_open);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The request as an array of bulk strings; the last word may be the body. */
static size_t frame(char *to, const char *const *word)
{
    size_t words = 0;
    while (word[words] != NULL)
        words++;
    char *at = to + sprintf(to, "*%zu\r\n", words);
    for (; *word != NULL; word++)
        at += sprintf(at, "$%zu\r\n%s\r\n", strlen(*word), *word);
    return (size_t)(at - to);
}

TEST(body_of_a_refused_request_in_resp_is_not_carried_out)
{
    static const struct {
        const char *word[10];
        const char *body; /* behind the request */
        bool stays_open;
    } cases[] = {
        {{"TIMEOUT", "1", "TIMEOUT", "1", "LOADB", "t", "1"}, TRAP, true},
        {{"TIMEOUT", "1", "TIMEOUT", "1", "LOADB", "t", "1", TRAP}, "", true},
        {{"TIMEOUT", "x", "LOAD", "t", "1", TRAP_LINE}, "", true},
        {{"TIMEOUT", "0", "FSETB", "t", "z", "0", "2", TRAP}, "", true},
        {{"TIMEOUT", "0", "NEARESTB", "t", "1", TRAP}, "", true},
        {{"NEARESTB", "t", "1", TRAP}, "", true},
        {{"TIMEOUT", "LOADB", "t", "1", TRAP}, "", false},
        {{"TIMEOUT", "LOADB", "t", "1"}, TRAP, false},
        {{"FSETB", "t", "z", "0", TRAP}, "", false},
        {{"LOADB", "t", TRAP}, "", false},
    };
    struct daemon d = daemon_start(NULL);
    char request[512];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        size_t n = frame(request, cases[i].word);
        n += (size_t)sprintf(request + n, "%s", cases[i].body);
        check_refused(&d, request, n, cases[i].stays_open);
    }
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(body_behind_multi_is_not_carried_out)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "*1\r\n$5\r\nMULTI\r\n");
    hear_line(fd);
    say(fd,
        "*7\r\n$7\r\nTIMEOUT\r\n$1\r\n1\r\n$7\r\nTIMEOUT\r\n$1\r\n1\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$1"
        "\r\n1\r\n" TRAP "PING\n");
    hear_line(fd);
    expect(fd, "OK 0\n");
    close(fd);
    converse(&d, "STAT trap\n", "ERR NOSET there is no set trap\n");
}

TEST(resp_takes_a_body_as_last_word_behind_timeout)
{
    struct daemon d = daemon_start(NULL);
    converse(&d,
             "*6\r\n$7\r\nTIMEOUT\r\n$1\r\n9\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$1\r\n1\r\n"
             "$16\r\nABCDEFG@ABCDEFG@\r\n"
             "*4\r\n$8\r\nNEARESTB\r\n$1\r\nt\r\n$1\r\n1\r\n$16\r\nABCDEFG@ABCDEFG@\r\nPING\n",
             "+OK first=0 added=1 coincident=0\r\n"
             "-UNTRIANGULATED TRIANGULATE the set first\r\nOK 0\n");
}

/* A row of NAMES fields is longer than the buffer of a connection. */
TEST(body_with_too_many_fields_is_skipped)
{
    enum { NAMES = 32000 };
    struct daemon d = daemon_start(NULL);
    char *line = malloc(2 * NAMES + 64), *body = malloc(8 * (NAMES + 2));
    CHECK(line != NULL && body != NULL);
    size_t n = (size_t)sprintf(line, "LOADB t 3 FIELDS a");
    for (int i = 1; i < NAMES; i++)
        n += (size_t)sprintf(line + n, ",a");
    strcpy(line + n, "\n");
    for (size_t i = 0; i < NAMES + 2; i++)
        memcpy(body + 8 * i, "ADD t 1\n", 8);
    int fd = daemon_connect(&d);
    say(fd, line);
    for (int i = 0; i < 3; i++)
        say_bytes(fd, body, 8 * (NAMES + 2));
    say(fd, "PING\n");
    CHECK(strncmp(hear_line(fd), "ERR TOOBIG ", 11) == 0);
    CHECK_STR(hear_line(fd), "OK 0");
    free(line);
    free(body);
}
