/* cells_test.c - VORONOI and AREAS: long ones, beside edits, and in binary. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* A triangulated set t of n random points of the unit square. */
static struct daemon start(int *fd, uint32_t n)
{
    struct daemon d = daemon_start(NULL);
    *fd = daemon_connect(&d);
    load_random(*fd, "t", n);
    say(*fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(*fd), "OK 0 points=", 12) == 0);
    return d;
}

/* The next `lines` lines, after which nothing is sent, as one text, which the caller frees. */
static char *hear_lines(int fd, size_t lines)
{
    size_t n = 0, cap = 1 << 20;
    char *text = malloc(cap + 1);
    CHECK(text != NULL);
    while (lines > 0) {
        ssize_t r = read(fd, text + n, cap - n);
        CHECK(r > 0);
        for (ssize_t i = 0; i < r; i++)
            lines -= text[n++] == '\n';
        if (n == cap)
            text = realloc(text, (cap *= 2) + 1);
        CHECK(text != NULL);
    }
    text[n] = '\0';
    return text;
}

static char *hear_cells(int fd, size_t n)
{
    char want[40];
    snprintf(want, sizeof want, "OK %zu box=", n);
    const char *line = hear_line(fd);
    CHECK_MSG(strncmp(line, want, strlen(want)) == 0, "%s", line);
    return hear_lines(fd, n);
}

/* The bytes of a binary reply. */
static char *hear_binary(int fd, size_t *bytes)
{
    size_t rows, got = 0;
    const char *line = hear_line(fd);
    CHECK_MSG(sscanf(line, "OK 0 rows=%zu bytes=%zu box=", &rows, bytes) == 2, "%s", line);
    char *all = malloc(*bytes + 1);
    CHECK(all != NULL);
    while (got < *bytes) {
        ssize_t r = read(fd, all + got, *bytes - got);
        CHECK(r > 0);
        got += (size_t)r;
    }
    return all;
}

/* Whether the text has exactly the cells of the binary reply. */
static void check_same_cells(const char *text, const char *binary, size_t bytes)
{
    const char *at = binary, *end = binary + bytes;
    char *next = (char *)(uintptr_t)text;
    while (at < end) {
        uint32_t head[2];
        memcpy(head, at, sizeof head);
        at += sizeof head;
        for (int i = 0; i < 2; i++)
            CHECK(strtoul(next, &next, 10) == head[i]);
        for (uint32_t i = 0; i < 2 * head[1]; i++, at += sizeof(double)) {
            double v;
            memcpy(&v, at, sizeof v);
            CHECK(strtod(next, &next) == v);
        }
        CHECK(*next++ == '\n');
    }
    CHECK(at == end && *next == '\0');
}

TEST(cells_in_binary_are_those_in_text)
{
    enum { N = 3000 };
    int fd;
    size_t bytes;
    start(&fd, N);
    say(fd, "VORONOI t\n");
    char *text = hear_cells(fd, N);
    say(fd, "VORONOI t BINARY\n");
    char *binary = hear_binary(fd, &bytes);
    check_same_cells(text, binary, bytes);
    free(text);
    free(binary);
    say(fd, "VORONOI t 17 4 2999 4\n");
    text = hear_cells(fd, 3);
    say(fd, "VORONOI t 2999 17 4 BINARY\n");
    binary = hear_binary(fd, &bytes);
    check_same_cells(text, binary, bytes);
    free(text);
    free(binary);
}

TEST(areas_in_binary_are_those_in_text)
{
    enum { N = 3000 };
    int fd;
    size_t bytes;
    start(&fd, N);
    say(fd, "AREAS t BOX 0 0 1 0.5\n");
    char *text = hear_cells(fd, N), *next = text;
    say(fd, "AREAS t BOX 0 0 1 0.5 BINARY\n");
    char *binary = hear_binary(fd, &bytes);
    CHECK(bytes == 12 * N);
    for (const char *at = binary; at < binary + bytes; at += 12) {
        uint32_t id;
        double area;
        memcpy(&id, at, sizeof id);
        memcpy(&area, at + 4, sizeof area);
        CHECK(strtoul(next, &next, 10) == id && strtod(next, &next) == area && *next++ == '\n');
    }
    free(text);
    free(binary);
}

TEST(cells_in_binary_are_the_same_without_memory_to_keep_them)
{
    enum { N = 40000, MIB = 1 << 20 };
    static const struct {
        const char *request;
        size_t more[2];
    } at[] = {
        {"VORONOI t BINARY", {64 * MIB, 2 * MIB}}, /* they take 4.2 MB */
        {"AREAS t BINARY", {64 * MIB, MIB / 2}},   /* 0.9 MB */
    };
    int fd;
    char *binary[2], line[80];
    size_t bytes[2];
    struct daemon d = start(&fd, N);
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        for (int i = 0; i < 2; i++) {
            size_t used = daemon_info(&d, "memory_used");
            snprintf(line, sizeof line, "CONFIG SET max-memory %zu\n%s\n", used + at[k].more[i],
                     at[k].request);
            say(fd, line);
            CHECK_STR(hear_line(fd), "OK 0");
            binary[i] = hear_binary(fd, &bytes[i]);
        }
        CHECK(bytes[0] == bytes[1] && memcmp(binary[0], binary[1], bytes[0]) == 0);
        free(binary[0]);
        free(binary[1]);
    }
}

TEST(areas_of_cells_add_up_to_the_box)
{
    enum { N = 3000 };
    int fd;
    double sum = 0;
    start(&fd, N);
    say(fd, "AREAS t BOX 0.25 0.25 0.75 0.5\n");
    CHECK_STR(hear_line(fd), "OK 3000 box=0.25,0.25,0.75,0.5");
    for (unsigned i = 0; i < N; i++) {
        unsigned id;
        double area;
        CHECK(sscanf(hear_line(fd), "%u %lf", &id, &area) == 2 && id == i);
        sum += area;
    }
    CHECK(sum > 0.125 - 1e-12 && sum < 0.125 + 1e-12);
}

TEST_TIMEOUT(cells_are_those_of_one_state_of_the_set_while_others_edit_it, 60)
{
    enum { N = 40000 };
    int fd;
    size_t bytes;
    struct daemon d = start(&fd, N);
    say(fd, "VORONOI t\n");
    char *before = hear_cells(fd, N);
    say(fd, "VORONOI t BINARY\n");
    char *binary = hear_binary(fd, &bytes);
    check_same_cells(before, binary, bytes);
    int slow[2] = {daemon_connect(&d), daemon_connect(&d)};
    for (unsigned k = 0; k < 2; k++)
        CHECK(setsockopt(slow[k], SOL_SOCKET, SO_RCVBUF, &(int){1 << 17}, sizeof(int)) == 0);
    say(slow[0], "VORONOI t\n");
    say(slow[1], "VORONOI t BINARY\n");
    for (unsigned k = 0; k < 2; k++)
        await_input(slow[k]);
    for (uint32_t i = 0; i < (test_is_sanitized() ? 300 : 2000); i++) {
        char line[160];
        snprintf(line, sizeof line, "MOVE t %u %.17g %.17g\nADD t %.17g %.17g\nDEL t %u\n",
                 20000 + i, test_uniform(), test_uniform(), test_uniform(), test_uniform(), i);
        say(fd, line);
        for (unsigned k = 0; k < 3; k++)
            CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    }
    char *then = hear_cells(slow[0], N), *binary_then = hear_binary(slow[1], &bytes);
    CHECK(strcmp(then, before) == 0);
    CHECK(memcmp(binary_then, binary, bytes) == 0);
    free(before);
    free(binary);
    free(then);
    free(binary_then);
}

/* The cell of a point with many neighbours, which a worker computes, and those of few points. */
TEST(the_cells_of_a_hub_and_of_a_box_far_away_are_answered)
{
    int fd;
    start(&fd, 0);
    char *request = malloc(400000), *at = request + sprintf(request, "LOAD t\n0 0\n");
    for (int i = 0; i < 5000; i++)
        at += sprintf(at, "%.17g %.17g\n", cos(i * 0.00125), sin(i * 0.00125));
    strcpy(at, ".\nTRIANGULATE t\nVORONOI t 0\n");
    say(fd, request);
    CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    char *hub = hear_cells(fd, 1);
    CHECK(strncmp(hub, "0 5000 ", 7) == 0 && strlen(hub) > 100000);
    free(hub);
    say(fd, "VORONOI t 0 BOX 100 100 101 101\n");
    CHECK_STR(hear_line(fd), "OK 1 box=100,100,101,101");
    CHECK(strncmp(hear_line(fd), "0 ", 2) == 0);
    free(request);
}

TEST(cells_of_aliases_are_those_of_their_representatives)
{
    int fd;
    start(&fd, 0);
    say(fd, "ADD t 0 0  2 0  0 0\nVORONOI t 2 0\nAREAS t\nVORONOI t 3\nDROP t\nVORONOI t\n");
    CHECK_STR(hear_line(fd), "OK 0 first=0 added=3 coincident=1");
    CHECK_STR(hear_line(fd), "OK 1 box=-1,-1,3,1");
    CHECK_STR(hear_line(fd), "0 4 -1 -1 1 -1 1 1 -1 1");
    CHECK_STR(hear_line(fd), "OK 2 box=-1,-1,3,1");
    CHECK_STR(hear_line(fd), "0 4");
    CHECK_STR(hear_line(fd), "1 4");
    CHECK_STR(hear_line(fd), "ERR NOPOINT there is no point 3");
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK_STR(hear_line(fd), "ERR NOSET there is no set t");
}

TEST(wrong_requests_for_cells_are_refused)
{
    int fd;
    start(&fd, 0);
    say(fd, "ADD t 0 0  2 0\nVORONOI t BOX 0 0 1\nVORONOI t BOX 0 0 1 nan\nAREAS t 0 0 1 1\n"
            "AREAS t BOX 1 1 1 1\nVORONOI t BINARY BOX 0 0 1 1\nCREATE u\nVORONOI u\n");
    CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    CHECK_STR(hear_line(fd), "ERR NUMBER BOX is not an id");
    CHECK_STR(hear_line(fd), "ERR NUMBER nan is not a number");
    CHECK_STR(hear_line(fd), "ERR SYNTAX usage: AREAS set [BOX x0 y0 x1 y1] [BINARY]");
    CHECK_STR(hear_line(fd), "ERR RANGE the box has no area");
    CHECK_STR(hear_line(fd), "ERR NUMBER BINARY is not an id");
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK(strncmp(hear_line(fd), "ERR UNTRIANGULATED", 18) == 0);
}

/* By a worker, and the rows in pieces. */
TEST(the_alpha_shape_of_a_large_radius_is_the_hull)
{
    int fd;
    start(&fd, 30000);
    say(fd, "HULL t\nALPHA t 1e9\n");
    size_t n = strtoul(hear_line(fd) + 3, NULL, 10);
    char want[20000], *at = want + sprintf(want, "outer %zu", n);
    for (size_t i = 0; i < n; i++)
        at += sprintf(at, " %lu", strtoul(hear_line(fd), NULL, 10));
    CHECK_STR(hear_line(fd), "OK 1");
    CHECK_STR(hear_line(fd), want);
    say(fd, "ALPHA t 0.004\n");
    unsigned long loops = strtoul(hear_line(fd) + 3, NULL, 10), holes = 0, outer = 0, corners;
    for (unsigned long i = 0; i < loops; i++) {
        char kind[8];
        CHECK(sscanf(hear_line(fd), "%7s %lu", kind, &corners) == 2 && corners >= 3);
        holes += strcmp(kind, "hole") == 0;
        outer += strcmp(kind, "outer") == 0;
    }
    CHECK_MSG(holes > 20 && outer > 20 && holes + outer == loops, "%lu holes, %lu outer", holes,
              outer);
}
