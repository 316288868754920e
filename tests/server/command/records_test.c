/* records_test.c - LOADB ... CONSTRAINTS: points and the records of constraints come together, or not at all. */
#include "tests/server/daemon.h"
#include "tests/server/directory.h"
#include "tests/test.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

struct bytes {
    unsigned char v[1024];
    size_t n;
};

static void put(struct bytes *b, const void *from, size_t n)
{
    CHECK(b->n + n <= sizeof b->v);
    memcpy(b->v + b->n, from, n);
    b->n += n;
}

static void put_line(struct bytes *b, const char *line)
{
    put(b, line, strlen(line));
}

static void put_record(struct bytes *b, uint32_t from, uint32_t to, uint32_t border,
                       uint32_t number)
{
    put(b, (const uint32_t[]){from, to, border, number}, 16);
}

/* The corners of a square. */
static const double square[] = {0, 0, 4, 0, 4, 4, 0, 4};

static void expect_after(int fd, struct bytes *b, const char *requests, const char *want)
{
    put_line(b, requests);
    say_bytes(fd, (const char *)b->v, b->n);
    expect(fd, want);
    b->n = 0;
}

TEST(records_of_kinds_and_numbers_come_with_points_and_values)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    struct bytes b = {.n = 0};
    const double rows[] = {0, 0, 1, 4, 0, 2, 0, 4, (double)NAN}, none = (double)NAN;
    put_line(&b, "ADD t 9 9\nLOADB t 3 CONSTRAINTS 2 FIELDS z\n");
    put(&b, rows, sizeof rows);
    put_record(&b, 2, 0, 1, 7);
    put(&b, &none, 8);
    put_record(&b, 0, 1, 0, 2147483647);
    put(&b, &none, 8);
    expect_after(fd, &b, "CONSTRAINTS t\nPOINTS t FIELDS z\n",
                 "OK 0 first=0 added=1 coincident=0\n"
                 "OK 0 first=1 added=3 coincident=0 constraints=2\n"
                 "OK 2\n1 2 line 2147483647\n1 3 border 7\n"
                 "OK 4\n0 9 9 nan\n1 0 0 1\n2 4 0 2\n3 0 4 nan\n");
    put_line(&b, "LOADB u 0 CONSTRAINTS 0\n");
    expect_after(fd, &b, "POINTS u\n", "OK 0 first=0 added=0 coincident=0 constraints=0\nOK 0\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(records_that_cross_are_named_by_their_numbers_or_get_points)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    struct bytes b = {.n = 0};
    say(fd, "ADD t 1 -9 1 9\nTRIANGULATE t\nCONSTRAIN t 0 1\n");
    for (int i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK 0 ", 5) == 0);
    put_line(&b, "LOADB t 4 CONSTRAINTS 2\n");
    put(&b, square, sizeof square);
    put_record(&b, 1, 2, 0, 0);
    put_record(&b, 3, 2, 0, 0);
    put_line(&b, "LOADB t 4 CONSTRAINTS 3\n");
    put(&b, square, sizeof square);
    put_record(&b, 0, 3, 0, 0);
    put_record(&b, 0, 3, 0, 0);
    put_record(&b, 1, 2, 0, 0);
    put_line(&b, "DEL t 2 3 4 5 CASCADE\nLOADB t 4 CONSTRAINTS 2\n");
    put(&b, square, sizeof square);
    put_record(&b, 0, 2, 1, 0);
    put_record(&b, 1, 3, 0, 0);
    put_line(&b, "LOADB t 4 CONSTRAINTS 2 SPLIT\n");
    put(&b, square, sizeof square);
    put_record(&b, 0, 2, 1, 0);
    put_record(&b, 1, 3, 0, 0);
    expect_after(fd, &b, "EDGES t CONSTRAINED\n",
                 "ERR CROSSES constraint 2 crosses 0 1\n"
                 "OK 0 first=2 added=4 coincident=0 constraints=2\n"
                 "OK 0 deleted=4\n"
                 "ERR CROSSES constraint 1 crosses 0 1\n"
                 "OK 0 first=6 added=7 coincident=0 constraints=9 split=3 deviation=0\n"
                 "OK 9\n0 10\n1 11\n6 10\n7 12\n8 12\n9 11\n10 11\n10 12\n11 12\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(records_of_another_form_change_nothing)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    static const struct {
        uint32_t v[4];
        const char *want;
    } cases[] = {
        {{0, 4, 0, 0}, "ERR NOPOINT constraint 1: 0 4 are not two of the 4 points\nOK 0\n"},
        {{UINT32_MAX, 0, 0, 0},
         "ERR NOPOINT constraint 1: 4294967295 0 are not two of the 4 points\nOK 0\n"},
        {{3, 3, 0, 0}, "ERR SYNTAX constraint 1 has one end only\nOK 0\n"},
        {{0, 1, 2, 0},
         "ERR RANGE constraint 1: 1 is a border, 0 a line; its number is at most 2147483647\n"
         "OK 0\n"},
        {{0, 1, 1, 0x80000000},
         "ERR RANGE constraint 1: 1 is a border, 0 a line; its number is at most 2147483647\n"
         "OK 0\n"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bytes b = {.n = 0};
        put_line(&b, "LOADB t 4 CONSTRAINTS 1\n");
        put(&b, square, sizeof square);
        put(&b, cases[i].v, 16);
        expect_after(fd, &b, "SETS\n", cases[i].want);
    }
    close(fd);
    converse(&d, "LOADB t 1 CONSTRAINTS\n",
             "ERR SYNTAX usage: LOADB set n [CONSTRAINTS m [SPLIT]] [FIELDS a,b]\n");
    converse(&d, "LOADB t 1 CONSTRAINTS x\n", "ERR NUMBER x is not a number of constraints\n");
    converse(&d, "LOADB t 1 CONSTRAINTS 268435457\n",
             "ERR NUMBER 268435457 is not a number of constraints\n");
    daemon_stop(&d, SIGTERM);
}

TEST(points_whose_records_do_not_all_come_are_not_there)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    struct bytes b = {.n = 0};
    put_line(&b, "LOADB t 4 CONSTRAINTS 2\n");
    put(&b, square, sizeof square);
    put_record(&b, 0, 1, 0, 0);
    put(&b, square, 15);
    say_bytes(fd, (const char *)b.v, b.n);
    shutdown(fd, SHUT_WR);
    expect(fd, "ERR SYNTAX point 6: the input ended too early; nothing was loaded\n");
    expect_end(fd);
    close(fd);
    converse(&d, "SETS\n", "OK 0\n");
    daemon_stop(&d, SIGTERM);
}

TEST(records_in_resp_are_in_the_last_word)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    struct bytes b = {.n = 0};
    put_line(&b, "*7\r\n$5\r\nLOADB\r\n$1\r\nt\r\n$1\r\n4\r\n$11\r\nCONSTRAINTS\r\n$1\r\n2\r\n"
                 "$5\r\nSPLIT\r\n$96\r\n");
    put(&b, square, sizeof square);
    put_record(&b, 0, 2, 1, 5);
    put_record(&b, 1, 3, 1, 5);
    expect_after(fd, &b, "\r\nCONSTRAINTS t OF 5\n",
                 "+OK first=0 added=5 coincident=0 constraints=4 split=2 deviation=0\r\n"
                 "OK 4\n0 4 border 5\n1 4 border 5\n2 4 border 5\n3 4 border 5\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

/* Bytes that arrive in pieces, beyond what is fed through the buffer of the connection. */
TEST_TIMEOUT(many_records_survive_a_kill, 60)
{
    enum { N = 50000 };
    static const char *const sets[] = {"t", NULL};
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = daemon_connect(&d);
    char head[80], want[120];
    double *xy = malloc(2 * N * sizeof *xy);
    uint32_t *record = malloc(4 * N * sizeof *record);
    CHECK(xy != NULL && record != NULL);
    for (uint32_t i = 0; i < N; i++) {
        xy[2 * i] = i;
        xy[2 * i + 1] = i % 7;
        memcpy(record + 4 * i, (const uint32_t[]){i, i + 1, i % 2, i / 10}, 16);
    }
    say_bytes(fd, head, (size_t)sprintf(head, "LOADB t %d CONSTRAINTS %d\n", N, N - 1));
    say_bytes(fd, (const char *)xy, 2 * N * sizeof *xy);
    say_bytes(fd, (const char *)record, 4 * (N - 1) * sizeof *record);
    snprintf(want, sizeof want, "OK 0 first=0 added=%d coincident=0 constraints=%d version=", N,
             N - 1);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s", got);
    char *state = directory_state(&d, sets);
    close(fd);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    char *again = directory_state(&d, sets);
    CHECK(strcmp(again, state) == 0);
    free(again);
    free(state);
    free(xy);
    free(record);
    daemon_end(&d);
    directory_remove(&dir);
}
