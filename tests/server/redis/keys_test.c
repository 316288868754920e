/* keys_test.c - sets as the keys of Redis's commands, in conversations with a real daemon. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

/* Sends the words of the text as a request in RESP. */
static void ask(int fd, const char *text)
{
    char words[1024], out[2048];
    size_t n = 0, len = 0;
    snprintf(words, sizeof words, "%s", text);
    for (char *w = words; *w != '\0'; w++)
        n += *w == ' ';
    len = (size_t)sprintf(out, "*%zu\r\n", n + 1);
    for (char *rest = words, *w = strsep(&rest, " "); w != NULL; w = strsep(&rest, " "))
        len += (size_t)sprintf(out + len, "$%zu\r\n%s\r\n", strlen(w), w);
    say_bytes(fd, out, len);
}

static void answers(int fd, const char *request, const char *want)
{
    ask(fd, request);
    expect(fd, want);
}

TEST(keys_are_sets)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "DBSIZE", ":0\r\n");
    answers(fd, "KEYS *", "*0\r\n");
    answers(fd, "SCAN 0", "*2\r\n$1\r\n0\r\n*0\r\n");
    answers(fd, "ADD t 1 2", "+OK first=0 added=1 coincident=0\r\n");
    answers(fd, "DBSIZE", ":1\r\n");
    answers(fd, "EXISTS t u t", ":2\r\n");
    answers(fd, "TYPE t", "+pointset\r\n");
    answers(fd, "TYPE u", "+none\r\n");
    answers(fd, "KEYS T*", "*0\r\n");
    answers(fd, "KEYS [s-u]", "*1\r\n$1\r\nt\r\n");
    answers(fd, "MEMORY USAGE u", "$-1\r\n");
    ask(fd, "MEMORY USAGE t SAMPLES 0");
    CHECK(hear_line(fd)[0] == ':');
    answers(fd, "DROP t", "+OK\r\n");
    answers(fd, "DBSIZE", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(commands_about_keys_refuse_wrong_arguments)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    char request[400];
    answers(fd, "DBSIZE x", "-SYNTAX usage: DBSIZE\r\n");
    answers(fd, "EXISTS", "-SYNTAX usage: EXISTS set [set ...]\r\n");
    answers(fd, "TYPE", "-SYNTAX usage: TYPE set\r\n");
    answers(fd, "MEMORY DOCTOR", "-SYNTAX usage: MEMORY USAGE set\r\n");
    answers(fd, "KEYS", "-SYNTAX usage: KEYS pattern\r\n");
    answers(fd, "SCAN", "-SYNTAX usage: SCAN cursor [MATCH pattern] [COUNT n] [TYPE type]\r\n");
    answers(fd, "SCAN x", "-NUMBER that is not a cursor of SCAN\r\n");
    answers(fd, "SCAN 99999999999999999999", "-NUMBER that is not a cursor of SCAN\r\n");
    answers(fd, "SCAN 0 COUNT 0",
            "-SYNTAX SCAN takes MATCH pattern, COUNT n with n from 1 on, TYPE type\r\n");
    sprintf(request, "KEYS %0*d", 257, 0);
    answers(fd, request, "-SYNTAX a pattern has at most 256 bytes\r\n");
    sprintf(request, "SCAN 0 MATCH %0*d", 257, 0);
    answers(fd, request, "-SYNTAX a pattern has at most 256 bytes\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(keys_expire_as_in_redis)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    answers(fd, "CREATE t", "+OK\r\n");
    answers(fd, "TTL t", ":-1\r\n");
    answers(fd, "TTL u", ":-2\r\n");
    answers(fd, "EXPIRE u 10", ":0\r\n");
    answers(fd, "EXPIRE t 1000", ":1\r\n");
    ask(fd, "PTTL t");
    unsigned long left = strtoul(hear_line(fd) + 1, NULL, 10);
    CHECK(left > 900000 && left <= 1000000);
    ask(fd, "TTL t");
    left = strtoul(hear_line(fd) + 1, NULL, 10);
    CHECK(left > 900 && left <= 1000);
    answers(fd, "PERSIST t", ":1\r\n");
    answers(fd, "PERSIST t", ":0\r\n");
    answers(fd, "PERSIST u", ":0\r\n");
    answers(fd, "TTL t", ":-1\r\n");
    answers(fd, "EXPIRE t x", "-NUMBER x is not a number\r\n");
    answers(fd, "EXPIRE t/ 1", "-SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\r\n");
    answers(fd, "EXPIRE t 5 NX", "-SYNTAX usage: EXPIRE set seconds\r\n");
    answers(fd, "TTL", "-SYNTAX usage: TTL set\r\n");
    answers(fd, "PTTL", "-SYNTAX usage: PTTL set\r\n");
    answers(fd, "PERSIST", "-SYNTAX usage: PERSIST set\r\n");
    answers(fd, "EXPIRE t 0", ":1\r\n");
    answers(fd, "KEYS *", "*0\r\n");
    answers(fd, "EXISTS t", ":0\r\n");
    answers(fd, "DBSIZE", ":0\r\n");
    answers(fd, "PERSIST t", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* Reads an array of names `set<i>` and counts each in seen[]; returns how many there are. */
static size_t hear_names(int fd, int *seen)
{
    size_t n = strtoul(hear_line(fd) + 1, NULL, 10);
    for (size_t i = 0; i < n; i++) {
        hear_line(fd);
        const char *name = hear_line(fd);
        CHECK(strncmp(name, "set", 3) == 0);
        seen[strtoul(name + 3, NULL, 10)]++;
    }
    return n;
}

static size_t scan_all(int fd, const char *options, int *seen)
{
    char cursor[64] = "0", request[200];
    size_t n = 0;
    do {
        snprintf(request, sizeof request, "SCAN %s%s", cursor, options);
        ask(fd, request);
        hear_line(fd);
        hear_line(fd);
        snprintf(cursor, sizeof cursor, "%s", hear_line(fd));
        cursor[strcspn(cursor, "\r")] = '\0';
        n += hear_names(fd, seen);
    } while (strcmp(cursor, "0") != 0);
    return n;
}

/* More sets than KEYS lists in one piece. */
TEST(keys_scan_and_keys_find_every_set_once)
{
    enum { N = 3000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), seen[N] = {0};
    char line[64];
    for (int i = 0; i < N; i++) {
        sprintf(line, "CREATE set%d\n", i);
        say(fd, line);
        expect(fd, "OK 0\n");
    }
    CHECK(scan_all(fd, "", seen) == N);
    CHECK(scan_all(fd, " COUNT 1000 TYPE pointset", seen) == N);
    CHECK(scan_all(fd, " MATCH set[0-9] COUNT 5", seen) == 10);
    CHECK(scan_all(fd, " TYPE string COUNT 1000", seen) == 0);
    ask(fd, "KEYS *");
    CHECK(hear_names(fd, seen) == N);
    for (int i = 0; i < N; i++)
        CHECK(seen[i] == (i < 10 ? 4 : 3));
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* A set that exists from the first SCAN to the last is found, whatever is created meanwhile. */
TEST(keys_scan_misses_no_set_while_others_are_created)
{
    enum { N = 100, ALL = 1000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), seen[ALL] = {0}, made = 0;
    char request[64], cursor[64] = "0";
    do {
        for (int i = made == 0 ? 0 : N - 20; i < N && made < ALL; i++) {
            sprintf(request, "CREATE set%d\n", made++);
            say(fd, request);
            expect(fd, "OK 0\n");
        }
        sprintf(request, "SCAN %.40s COUNT 5", cursor);
        ask(fd, request);
        hear_line(fd);
        hear_line(fd);
        snprintf(cursor, sizeof cursor, "%s", hear_line(fd));
        cursor[strcspn(cursor, "\r")] = '\0';
        hear_names(fd, seen);
    } while (strcmp(cursor, "0") != 0);
    for (int i = 0; i < ALL; i++)
        CHECK_MSG(i < N ? seen[i] == 1 : seen[i] <= 1, "%d %d", i, seen[i]);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* ---- transactions ---- */

TEST(multi_is_refused_with_all_requests_that_follow)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ask(fd, "MULTI");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN there are no transactions", 34) == 0);
    ask(fd, "ADD t 1 2");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN not carried out", 24) == 0);
    ask(fd, "PING");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN not carried out", 24) == 0);
    ask(fd, "EXEC");
    CHECK(strncmp(hear_line(fd), "-EXECABORT ", 11) == 0);
    answers(fd, "EXISTS t", ":0\r\n");
    answers(fd, "EXEC", "-ERR EXEC without MULTI\r\n");
    answers(fd, "DISCARD", "-ERR DISCARD without MULTI\r\n");
    ask(fd, "MULTI");
    hear_line(fd);
    answers(fd, "DISCARD", "+OK\r\n");
    answers(fd, "PING", "+PONG\r\n");
    ask(fd, "WATCH t");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN ", 9) == 0);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The points are not read as requests. */
TEST(multi_refuses_bodies_and_continues_after_them)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    ask(fd, "MULTI");
    hear_line(fd);
    say(fd, "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n$7\r\n1 2\n3 4\r\n");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN not carried out", 24) == 0);
    say(fd, "*3\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n2\r\n1 2\n3 4\n");
    CHECK(strncmp(hear_line(fd), "-UNKNOWN not carried out", 24) == 0);
    ask(fd, "EXEC");
    CHECK(strncmp(hear_line(fd), "-EXECABORT ", 11) == 0);
    answers(fd, "DBSIZE", ":0\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(info_in_resp_has_the_keys_that_redis_cli_stat_reads)
{
    static const char *const keys[] = {"connected_clients:1\r\n",
                                       "blocked_clients:0\r\n",
                                       "used_memory:",
                                       "total_commands_processed:",
                                       "total_connections_received:",
                                       "db0:keys=1,expires=0,avg_ttl=0\r\n"};
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n;
    answers(fd, "CREATE t", "+OK\r\n");
    ask(fd, "INFO");
    ask(fd, "QUIT");
    char *got = hear_all(fd, &n);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        CHECK_MSG(strstr(got, keys[i]) != NULL, "%s", keys[i]);
    free(got);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}
