/* places_test.c - LOCATEB and NEARESTB: many places in one request. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct places {
    size_t n;
    double *xy; /* owns */
};

static struct places random_places(size_t n)
{
    struct places p = {n, malloc(2 * n * sizeof(double))};
    CHECK(p.xy != NULL);
    for (size_t i = 0; i < 2 * n; i++)
        p.xy[i] = test_uniform() * 1.1 - 0.05;
    return p;
}

static void ask(int fd, const char *command, const struct places *p, const char *more)
{
    char head[100];
    snprintf(head, sizeof head, "%s t %zu%s\n", command, p->n, more);
    say(fd, head);
    say_bytes(fd, p->xy, p->n * 16);
}

/* The rows of the reply; the caller frees them. */
static uint32_t *hear_rows(int fd, size_t n, size_t width)
{
    char want[100];
    size_t bytes = n * width * 4, got = 0;
    char *rows = malloc(bytes + 1);
    snprintf(want, sizeof want, "OK 0 rows=%zu bytes=%zu", n, bytes);
    CHECK_STR(hear_line(fd), want);
    while (got < bytes) {
        ssize_t r = read(fd, rows + got, bytes - got);
        CHECK(r > 0);
        got += (size_t)r;
    }
    return (uint32_t *)(void *)rows;
}

static void check_equal(const uint32_t *got, const uint32_t *want, size_t n)
{
    for (size_t i = 0; i < n; i++)
        CHECK_MSG(got[i] == want[i], "word %zu is %u instead of %u", i, got[i], want[i]);
}

/* A triangulated set t of n random points of the unit square. */
static struct daemon start(int *fd, uint32_t n, const char *const *arguments)
{
    struct daemon d = daemon_start(arguments);
    *fd = daemon_connect(&d);
    load_random(*fd, "t", n);
    say(*fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(*fd), "OK 0 points=", 12) == 0);
    return d;
}

TEST(places_asked_at_once_have_the_triangles_that_they_have_one_by_one)
{
    int fd;
    start(&fd, 5000, NULL);
    struct places p = random_places(3000);
    ask(fd, "LOCATEB", &p, "");
    uint32_t *row = hear_rows(fd, p.n, 3);
    for (size_t i = 0; i < p.n; i += 10) {
        char line[128], want[64] = "";
        snprintf(line, sizeof line, "LOCATE t %.17g %.17g\n", p.xy[2 * i], p.xy[2 * i + 1]);
        say(fd, line);
        bool inside = strcmp(hear_line(fd), "OK 0 where=outside") != 0;
        CHECK(inside == (row[3 * i] != UINT32_MAX));
        snprintf(want, sizeof want, "%u %u %u", row[3 * i], row[3 * i + 1], row[3 * i + 2]);
        if (inside)
            CHECK_STR(hear_line(fd), want);
    }
    free(row);
    free(p.xy);
}

TEST(places_asked_at_once_have_the_nearest_points_that_they_have_one_by_one)
{
    int fd;
    start(&fd, 5000, NULL);
    struct places p = random_places(3000);
    ask(fd, "NEARESTB", &p, " 4");
    uint32_t *row = hear_rows(fd, p.n, 4);
    for (size_t i = 0; i < p.n; i += 10) {
        char line[128];
        snprintf(line, sizeof line, "NEAREST t %.17g %.17g 4\n", p.xy[2 * i], p.xy[2 * i + 1]);
        say(fd, line);
        CHECK_STR(hear_line(fd), "OK 4");
        for (size_t k = 0; k < 4; k++)
            CHECK(strtoul(hear_line(fd), NULL, 10) == row[4 * i + k]);
    }
    free(row);
    free(p.xy);
}

/* A client that does not read delays no edit meanwhile, and the state that it is reading is not
 * freed. */
TEST_TIMEOUT(places_are_looked_up_in_one_state_of_the_set_while_others_edit_it, 60)
{
    int fd;
    struct daemon d = start(&fd, 20000, NULL);
    /* More than the system buffers for a daemon whose client does not read. */
    struct places p = random_places(450000);
    ask(fd, "LOCATEB", &p, "");
    uint32_t *triangles = hear_rows(fd, p.n, 3);
    ask(fd, "NEARESTB", &p, " 4");
    uint32_t *nearest = hear_rows(fd, p.n, 4);
    int slow[2] = {daemon_connect(&d), daemon_connect(&d)};
    for (unsigned k = 0; k < 2; k++)
        CHECK(setsockopt(slow[k], SOL_SOCKET, SO_RCVBUF, &(int){1 << 17}, sizeof(int)) == 0);
    ask(slow[0], "LOCATEB", &p, "");
    ask(slow[1], "NEARESTB", &p, " 4");
    CHECK(strncmp(hear_line(slow[0]), "OK 0 rows=", 10) == 0);
    CHECK(strncmp(hear_line(slow[1]), "OK 0 rows=", 10) == 0);
    for (uint32_t i = 0; i < (test_is_sanitized() ? 300 : 2000); i++) {
        char line[160];
        snprintf(line, sizeof line, "MOVE t %u %.17g %.17g\nADD t %.17g %.17g\nDEL t %u\n",
                 10000 + i, test_uniform(), test_uniform(), test_uniform(), test_uniform(), i);
        say(fd, line);
        for (unsigned k = 0; k < 3; k++)
            CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    }
    for (unsigned k = 0; k < 2; k++) {
        size_t bytes = p.n * (k == 0 ? 12 : 16), got = 0;
        char *rows = malloc(bytes);
        while (got < bytes) {
            ssize_t r = read(slow[k], rows + got, bytes - got);
            CHECK(r > 0);
            got += (size_t)r;
        }
        check_equal((uint32_t *)(void *)rows, k == 0 ? triangles : nearest, bytes / 4);
        free(rows);
    }
    say(fd, "CHECK t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes", 17) == 0);
    free(triangles);
    free(nearest);
    free(p.xy);
}

TEST(places_give_their_memory_back_when_the_client_has_gone)
{
    int fd;
    struct daemon d = start(&fd, 1000, NULL);
    struct places p = random_places(2000000);
    ask(fd, "LOCATEB", &p, "");
    CHECK(strncmp(hear_line(fd), "OK 0 rows=", 10) == 0);
    CHECK(daemon_info(&d, "loading") >= 2000000 * 16);
    close(fd);
    await_info(&d, "loading", 0);
    free(p.xy);
}

TEST(places_for_which_there_is_no_memory_are_refused)
{
    int fd;
    start(&fd, 1000, (const char *const[]){"--max-memory", "16m", NULL});
    struct places p = random_places(2000000);
    ask(fd, "LOCATEB", &p, "");
    CHECK(strstr(hear_line(fd), "out of memory") != NULL);
    say(fd, "PING\n");
    CHECK_STR(hear_line(fd), "OK 0");
    free(p.xy);
}

/* Half of the places are at the hub of a wheel, whose star alone takes all steps of a piece. */
TEST_TIMEOUT(places_hub_with_more_neighbours_than_a_piece_has_steps_is_found, 60)
{
    enum { RIM = 50000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    struct places rim = {RIM, malloc(RIM * 16)}, p = random_places(100);
    for (size_t i = 0; i < RIM; i++) {
        rim.xy[2 * i] = cos((double)i * 6.283185307179586 / RIM);
        rim.xy[2 * i + 1] = sin((double)i * 6.283185307179586 / RIM);
    }
    say(fd, "ADD t 0 0\n");
    ask(fd, "LOADB", &rim, "");
    say(fd, "TRIANGULATE t\n");
    for (unsigned i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    for (size_t i = 0; i < p.n; i += 2)
        p.xy[2 * i] = p.xy[2 * i + 1] = 0;
    ask(fd, "LOCATEB", &p, "");
    uint32_t *row = hear_rows(fd, p.n, 3);
    for (size_t i = 0; i < p.n; i += 2)
        CHECK(row[3 * i] == 0 && row[3 * i + 1] == 1 && row[3 * i + 2] == 2);
    free(row);
    free(rim.xy);
    free(p.xy);
}

/* The edit leaves a triangulation to be built, which takes longer than the request may. */
TEST_TIMEOUT(places_are_given_up_when_their_time_is_over, 60)
{
    int fd;
    start(&fd, 300000, NULL);
    struct places p = random_places(100);
    load_random(fd, "u", 1);
    char head[64];
    snprintf(head, sizeof head, "LOADB t %u\n", 300000u);
    struct places more = random_places(300000);
    say(fd, head);
    say_bytes(fd, more.xy, more.n * 16);
    CHECK(strncmp(hear_line(fd), "OK 0 first=300000", 17) == 0);
    ask(fd, "TIMEOUT 0.001 LOCATEB", &p, "");
    CHECK(strncmp(hear_line(fd), "ERR TIMEOUT ", 12) == 0);
    ask(fd, "TIMEOUT 60 NEARESTB", &p, "");
    free(hear_rows(fd, p.n, 1));
    free(p.xy);
    free(more.xy);
}

static void check_conversation(const struct daemon *d, const char *request, size_t n,
                               const char *want)
{
    size_t got_n;
    int fd = daemon_connect(d);
    say_bytes(fd, request, n);
    shutdown(fd, SHUT_WR);
    char *got = hear_all(fd, &got_n);
    CHECK_STR(got, want);
    free(got);
    close(fd);
}

#define CHECK_CONVERSATION(D, REQUEST, WANT)                                                       \
    check_conversation(D, REQUEST, sizeof(REQUEST) - 1, WANT)

TEST(places_that_are_refused_are_skipped)
{
    int fd;
    struct daemon d = start(&fd, 10, NULL);
    CHECK_CONVERSATION(&d,
                       "LOCATEB no 1\n0123456\n\n0123456NEARESTB no 1 2\n0123456\n\n0123456PING\n",
                       "ERR NOSET there is no set no\nERR NOSET there is no set no\nOK 0\n");
    CHECK_CONVERSATION(&d, "LOCATEB t 1\n\0\0\0\0\0\0\xf8\x7f\0\0\0\0\0\0\0\0PING\n",
                       "ERR NUMBER place 1: not a number\nOK 0\n");
    CHECK_CONVERSATION(&d, "LOCATEB t 1\n\0\0\0\0\0\0\xf0\x7f\0\0\0\0\0\0\0\0PING\n",
                       "ERR RANGE place 1: a coordinate is 0 or has a magnitude from 2^-142 to "
                       "2^201\nOK 0\n");
    CHECK_CONVERSATION(&d,
                       "NEARESTB t 1 k\nABCDEFG@ABCDEFG@NEARESTB t 1 4097\nABCDEFG@ABCDEFG@PING\n",
                       "ERR NUMBER k is not a number of points\n"
                       "ERR RANGE at most 4096 points for each place\nOK 0\n");
    CHECK_CONVERSATION(&d, "LOCATEB t 2\nABCDEFG@ABCDEFG@A",
                       "ERR SYNTAX place 2: the input ended too early\n");
    CHECK_CONVERSATION(&d, "LOCATEB t 1 2\nDROP t\n", "ERR SYNTAX usage: LOCATEB set n\n");
    CHECK_CONVERSATION(&d, "NEARESTB t -1\nDROP t\n", "ERR NUMBER -1 is not a number of points\n");
    CHECK_CONVERSATION(&d, "CREATE u\nLOCATEB u 1\nABCDEFG@ABCDEFG@LOCATEB t 0\nNEARESTB t 0\n",
                       "OK 0\nERR UNTRIANGULATED TRIANGULATE the set first\nOK 0 rows=0 bytes=0\n"
                       "OK 0 rows=0 bytes=0\n");
    CHECK_CONVERSATION(&d, "NEARESTB t 1 0\nABCDEFG@ABCDEFG@PING\n", "OK 0 rows=1 bytes=0\nOK 0\n");
}

TEST(places_may_come_as_the_last_word_of_a_request_in_resp)
{
    int fd;
    struct daemon d = start(&fd, 10, NULL);
    say(fd, "*4\r\n$7\r\nLOCATEB\r\n$1\r\nt\r\n$1\r\n1\r\n$16\r\nABCDEFG@ABCDEFG@\r\n");
    expect(fd, "$12\r\n\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\r\n");
    say(fd, "*3\r\n$7\r\nlocateb\r\n$1\r\nt\r\n$1\r\n1\r\nABCDEFG@ABCDEFG@");
    expect(fd, "$12\r\n\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\r\n");
    say(fd,
        "DEL t 0 1 2 3 4 5 6 7 8\n*5\r\n$8\r\nNEARESTB\r\n$1\r\nt\r\n$1\r\n1\r\n$1\r\n2\r\n$16\r\n"
        "ABCDEFG@ABCDEFG@\r\n");
    expect(fd, "OK 0 deleted=9\n$8\r\n\x09");
    char rest[9];
    CHECK(recv(fd, rest, 9, MSG_WAITALL) == 9 &&
          memcmp(rest, "\0\0\0\xff\xff\xff\xff\r\n", 9) == 0);
    say(fd, "*4\r\n$7\r\nLOCATEB\r\n$2\r\nno\r\n$1\r\n1\r\n$16\r\nABCDEFG@ABCDEFG@\r\nPING\n");
    expect(fd, "-NOSET there is no set no\r\nOK 0\n");
    (void)d;
}

TEST(places_are_for_those_who_may_only_read)
{
    char path[] = "/tmp/delaunayd-places-XXXXXX";
    int file = mkstemp(path), fd;
    CHECK(file >= 0 && write(file, "rw all\nro some\n", 15) == 15);
    struct daemon d = daemon_start((const char *const[]){"--auth-file", path, NULL});
    unlink(path);
    fd = daemon_connect(&d);
    say(fd, "AUTH all\nADD t 0 0 4 0 0 4\nTRIANGULATE t\n");
    for (unsigned i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    CHECK_CONVERSATION(&d, "LOCATEB t 1\nPING\n", "ERR NOAUTH authenticate first: AUTH token\n");
    CHECK_CONVERSATION(
        &d, "AUTH some\nNEARESTB t 1 0\nABCDEFG@ABCDEFG@ADD t 1 1\n",
        "OK 0 role=ro\nOK 0 rows=1 bytes=0\nERR DENIED your token is for reading only\n");
}
