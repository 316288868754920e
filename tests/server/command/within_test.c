/* within_test.c - LISTS and TRIANGLES WITHIN a box: large ones, which workers find. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The bytes of a binary reply, whose status line begins with `want`. */
static char *ask(int fd, const char *request, const char *want, size_t *bytes)
{
    size_t got = 0;
    say(fd, request);
    const char *line = hear_line(fd), *at = strstr(line, "bytes=");
    CHECK_MSG(at != NULL && strncmp(line, want, strlen(want)) == 0, "%s", line);
    *bytes = strtoul(at + 6, NULL, 10);
    char *all = malloc(*bytes + 1);
    CHECK(all != NULL);
    while (got < *bytes) {
        ssize_t r = read(fd, all + got, *bytes - got);
        CHECK(r > 0);
        got += (size_t)r;
    }
    return all;
}

static void check_same(int fd, const char *whole, const char *part, const char *want)
{
    size_t n, m;
    char *a = ask(fd, whole, want, &n), *b = ask(fd, part, want, &m);
    CHECK(n == m && memcmp(a, b, n) == 0);
    free(a);
    free(b);
}

TEST_TIMEOUT(what_is_within_a_box_around_everything_is_the_whole_table, 60)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    load_random(fd, "t", 60000);
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
    check_same(fd, "LISTS t BINARY\n", "LISTS t WITHIN 2 2 -1 -1 BINARY\n", "OK 0 interior=");
    check_same(fd, "LISTS t CW BINARY\n", "LISTS t WITHIN 0 0 1 1 CW BINARY\n", "OK 0 interior=");
    check_same(fd, "TRIANGLES t BINARY\n", "TRIANGLES t WITHIN 0 0 1 1 BINARY\n", "OK 0 rows=");
    check_same(fd, "TRIANGLES t CW BINARY\n", "TRIANGLES t WITHIN 0 0 1 1 CW BINARY\n",
               "OK 0 rows=");
}

/* The points of LISTS, in its order, that WITHIN finds, and the triangles that have one of them as a corner. */
TEST_TIMEOUT(what_is_within_half_of_the_set_is_a_part_of_the_table_in_order, 60)
{
    enum { N = 30000 };
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    size_t n, m;
    bool *in = calloc(N, 1);
    load_random(fd, "t", N);
    say(fd, "TRIANGULATE t\nWITHIN t 0 0 0.5 2\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
    size_t points = strtoul(hear_line(fd) + 3, NULL, 10);
    for (size_t i = 0; i < points; i++)
        in[strtoul(hear_line(fd), NULL, 10)] = true;
    uint32_t *all = (uint32_t *)(void *)ask(fd, "LISTS t BINARY\n", "OK", &n);
    uint32_t *some = (uint32_t *)(void *)ask(fd, "LISTS t WITHIN 0 0 0.5 2 BINARY\n", "OK", &m);
    size_t at = 0;
    for (size_t i = 0; i < n / 4; i += 2 + all[i + 1]) {
        if (!in[all[i]])
            continue;
        CHECK(at < m / 4 && memcmp(some + at, all + i, (2 + all[i + 1]) * 4) == 0);
        at += 2 + all[i + 1];
    }
    CHECK(at == m / 4);
    free(all);
    free(some);
    all = (uint32_t *)(void *)ask(fd, "TRIANGLES t BINARY\n", "OK", &n);
    some = (uint32_t *)(void *)ask(fd, "TRIANGLES t WITHIN 0 0 0.5 2 BINARY\n", "OK", &m);
    at = 0;
    for (size_t i = 0; i < n / 4; i += 3) {
        bool listed = at < m / 4 && memcmp(some + at, all + i, 12) == 0;
        CHECK(listed || !(in[all[i]] || in[all[i + 1]] || in[all[i + 2]]));
        at += listed ? 3 : 0;
    }
    CHECK(at == m / 4);
    free(all);
    free(some);
    free(in);
}
