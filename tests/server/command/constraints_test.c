/* constraints_test.c - constraints through the server: what requests answer, and what survives. */
#include "core/delaunay_constraints.h"
#include "server/ops/limits.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The reply to the last request of several. */
static void expect_last(struct local *l, const char *requests, const char *want)
{
    const char *got = local_ask(l, requests), *at = got;
    for (const char *next; (next = strstr(at, "\n")) != NULL && next[1] != '\0';)
        at = next + 1;
    CHECK_MSG(strncmp(at, want, strlen(want)) == 0, "%s gave %s", requests, got);
}

#define SQUARE "ADD t 0 0 4 0 4.5 4 0 4\nTRIANGULATE t\nFSET t z 0 1 1 2 2 3 3 4\n"

TEST(what_needs_every_edge_to_be_delaunay_is_refused_with_constraints)
{
    static const char *const refused[] = {"VORONOI t",
                                          "VORONOI t BOX 0 0 1 1",
                                          "VORONOI t 0 BOX 0 0 1 1 BINARY",
                                          "AREAS t",
                                          "AREAS t BOX 0 0 9 9",
                                          "ALPHA t 3",
                                          "WEIGHTS t 1 1 METHOD natural",
                                          "WEIGHTS t 1 1 METHOD laplace",
                                          "INTERPOLATE t z 1 1 METHOD natural",
                                          "INTERPOLATE t z 1 1 METHOD laplace",
                                          "RASTER t z 0 0 4 4 2 2 METHOD natural",
                                          "RASTER t z 0 0 4 4 300 300 METHOD laplace BINARY"};
    static const char *const works[] = {"WEIGHTS t 1 1",
                                        "INTERPOLATE t z 1 1",
                                        "INTERPOLATE t z 1 1 METHOD nearest",
                                        "RASTER t z 0 0 4 4 2 2",
                                        "CONTOUR t z 2",
                                        "LOCATE t 1 1",
                                        "NEAREST t 1 1 3",
                                        "WITHIN t 0 0 5 5",
                                        "WITHIN t 0 0 3",
                                        "LISTS t",
                                        "TRIANGLES t WITHIN 0 0 1 1"};
    struct local l;
    char line[100];
    local_start(&l, 0);
    local_ask(&l, SQUARE "CONSTRAIN t 0 1\n"); /* an edge that is Delaunay, too */
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        snprintf(line, sizeof line, "%s\n", refused[i]);
        expect_last(&l, line, "ERR NOTDELAUNAY ");
    }
    for (size_t i = 0; i < sizeof works / sizeof *works; i++) {
        snprintf(line, sizeof line, "%s\n", works[i]);
        CHECK_MSG(strncmp(local_ask(&l, line), "OK", 2) == 0, "%s", line);
    }
    local_ask(&l, "RELEASE t ALL\n");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        if (strstr(refused[i], "BINARY") != NULL)
            continue;
        snprintf(line, sizeof line, "%s\n", refused[i]);
        CHECK_MSG(strncmp(local_ask(&l, line), "OK", 2) == 0, "%s", line);
    }
    local_stop(&l);
}

TEST(constraint_that_is_there_already_changes_nothing)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, SQUARE "CONSTRAIN t 0 2\n");
    uint64_t version = local_set(&l, "t")->version;
    expect_last(&l, "CONSTRAIN t 2 0\n", "OK 0 added=0");
    CHECK(local_set(&l, "t")->version == version);
    expect_last(&l, "RELEASE t 0 2\n", "OK 0 released=1");
    CHECK(local_set(&l, "t")->version > version);
    version = local_set(&l, "t")->version;
    expect_last(&l, "RELEASE t ALL\n", "OK 0 released=0");
    CHECK(local_set(&l, "t")->version == version);
    local_stop(&l);
}

TEST(constraint_requests_of_another_form_are_refused)
{
    static const struct {
        const char *request, *want;
    } cases[] = {{"CONSTRAIN t 0", "ERR SYNTAX"},
                 {"CONSTRAIN t 0 1 2", "ERR SYNTAX"},
                 {"CONSTRAIN t PATH 0", "ERR SYNTAX"},
                 {"CONSTRAIN t RING 0 1", "ERR SYNTAX"},
                 {"CONSTRAIN t RING 0 1 0", "ERR SYNTAX"},
                 {"CONSTRAIN t OF 1", "ERR SYNTAX"},
                 {"CONSTRAIN t OF x 0 1", "ERR NUMBER"},
                 {"CONSTRAIN t 0 y", "ERR NUMBER"},
                 {"CONSTRAIN t OF -1 0 1", "ERR NUMBER"},
                 {"CONSTRAIN t BORDER OF 2 PATH", "ERR SYNTAX"},
                 {"CONSTRAIN t OF 2147483648 0 1", "ERR RANGE"},
                 {"CONSTRAIN u 0 1", "ERR NOSET"},
                 {"RELEASE t", "ERR SYNTAX"},
                 {"RELEASE t BORDER", "ERR SYNTAX"},
                 {"RELEASE t ALL 0", "ERR NUMBER"},
                 {"RELEASE t 0 0", "ERR SYNTAX"},
                 {"RELEASE t 0 7", "ERR NOCONSTRAINT"},
                 {"RELEASE t OF 4", "ERR NOCONSTRAINT"},
                 {"CONSTRAINTS t OF", "ERR NUMBER"},
                 {"CONSTRAINTS t 0 x", "ERR NUMBER"},
                 {"EDGES t CONSTRAINED CW", "ERR"},
                 {"MOVE t 0 1 1 1 2", "ERR SYNTAX"},
                 {"MOVE t 0 1 1 0 2 2", "ERR NOPOINT"},
                 {"MOVE t 0 1 1 9 2 2", "ERR NOPOINT"},
                 {"DEL t CASCADE", "ERR NUMBER"},
                 {"DEL t 0 CASCADE CASCADE", "ERR NUMBER"}};
    struct local l;
    char line[100];
    local_start(&l, 0);
    local_ask(&l, SQUARE "CONSTRAIN t 0 2\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(line, sizeof line, "%s\n", cases[i].request);
        expect_last(&l, line, cases[i].want);
    }
    expect_last(&l, "CONSTRAINTS t\n", "0 2 line 0\n");
    CHECK_STR(local_ask(&l, "POINTS t\n"), "OK 4\n0 0 0\n1 4 0\n2 4.5 4\n3 0 4\n");
    local_stop(&l);
}

/* Every way to one state gives the same bytes. */
TEST(constrained_sets_answer_the_same_in_any_order)
{
    static const char *const histories[] = {
        "TRIANGULATE t\nCONSTRAIN t 0 2\nCONSTRAIN t BORDER RING 4 5 6\nADD t 2 2\n",
        "CONSTRAIN t BORDER 6 4 5 4 6 5\nADD t 2 2\nTRIANGULATE t\nCONSTRAIN t 2 0\n",
        "ADD t 2 2\nCONSTRAIN t 0 2 1 2\nTRIANGULATE t METHOD shelling\nRELEASE t 1 2\n"
        "CONSTRAIN t BORDER RING 5 6 4\n",
        "TRIANGULATE t\nCONSTRAIN t 1 3\nMOVE t 0 9 9 2 8 8\nRELEASE t ALL\nMOVE t 2 4 4 0 0 0\n"
        "CONSTRAIN t BORDER PATH 4 5 6 4\nCONSTRAIN t 0 2\nADD t 2 2\n"};
    char *want = NULL;
    for (size_t i = 0; i < sizeof histories / sizeof *histories; i++) {
        struct local l;
        char text[400];
        local_start(&l, 0);
        local_ask(&l, "ADD t 0 0 4 0 4 4 0 4 1 3 1.5 3.5 0.5 3.5 3 1 2 0.5\n");
        local_ask(&l, histories[i]);
        snprintf(text, sizeof text,
                 "LISTS t\nTRIANGLES t\nCONSTRAINTS t\nEDGES t CONSTRAINED\n"
                 "LOCATE t 2 1.9\nNEAREST t 2 2 4\nCHECK t\n");
        const char *got = local_ask(&l, text);
        CHECK(strstr(got, "ERR") == NULL);
        if (want == NULL)
            want = strdup(got);
        CHECK_STR(got, want);
        local_stop(&l);
    }
    free(want);
}

TEST(constraints_that_do_not_fit_into_memory_are_refused_and_change_nothing)
{
    enum { N = 200000 };
    const char *const limit[] = {"--max-memory", "48m", NULL};
    struct daemon d = daemon_start(limit);
    int fd = daemon_connect(&d);
    double *xy = malloc(2 * N * sizeof *xy);
    uint32_t *pair = malloc(2 * N * sizeof *pair);
    char line[100];
    CHECK(xy != NULL && pair != NULL);
    for (uint32_t i = 0; i < N; i++) {
        xy[2 * i] = i % 500;
        xy[2 * i + 1] = i / 500;
        pair[2 * i] = i;
        pair[2 * i + 1] = i ^ 1;
    }
    snprintf(line, sizeof line, "LOADB t %d\n", N);
    say(fd, line);
    say_bytes(fd, xy, 2 * N * sizeof *xy);
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    bool refused = false;
    for (unsigned k = 0; k < 20 && !refused; k++) {
        snprintf(line, sizeof line, "CONSTRAINB t OF %u %d\n", k, N);
        say(fd, line);
        say_bytes(fd, pair, 2 * N * sizeof *pair);
        const char *got = hear_line(fd);
        refused = strncmp(got, "ERR NOMEM", 9) == 0;
        CHECK_MSG(refused || strncmp(got, "OK 0 added=100000 ", 18) == 0, "%s", got);
        snprintf(line, sizeof line, "CONSTRAINTS t OF %u BINARY\n", k);
        if (refused) {
            say(fd, line);
            CHECK_STR(hear_line(fd), "OK 0 rows=0 bytes=0");
        }
    }
    CHECK(refused);
    close(fd);
    free(xy);
    free(pair);
    daemon_end(&d);
}

/* A set of N points with lines of three numbers between neighbours, in descending order, and borders from the first point. */
static void constrain_many(int fd, unsigned n)
{
    static char text[200000];
    size_t at = (size_t)snprintf(text, sizeof text, "ADD t");
    for (unsigned i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, " %u %u", i, i * i % 101);
    at += (size_t)snprintf(text + at, sizeof text - at, "\n");
    for (unsigned k = 0; k < 3; k++) {
        at += (size_t)snprintf(text + at, sizeof text - at, "CONSTRAIN t OF %u PATH", k);
        for (unsigned i = n; i-- > 0;)
            at += (size_t)snprintf(text + at, sizeof text - at, " %u", i);
        at += (size_t)snprintf(text + at, sizeof text - at, "\n");
    }
    at += (size_t)snprintf(text + at, sizeof text - at, "CONSTRAIN t BORDER");
    for (unsigned i = n; i-- > 2;)
        at += (size_t)snprintf(text + at, sizeof text - at, " %u 0", i);
    snprintf(text + at, sizeof text - at, "\n");
    say(fd, text);
    for (int i = 0; i < 5; i++)
        CHECK(strncmp(hear_line(fd), "OK ", 3) == 0);
}

/* Hears the n rows of an id. */
static void hear_rows(int fd, unsigned id, unsigned n, unsigned first, unsigned end)
{
    char want[80];
    for (unsigned k = first; id + 1 < n && k < end; k++) {
        snprintf(want, sizeof want, "%u %u line %u", id, id + 1, k);
        CHECK_STR(hear_line(fd), want);
    }
    for (unsigned other = 2; id == 0 && first == 0 && other < n; other++) {
        snprintf(want, sizeof want, "0 %u border 0", other);
        CHECK_STR(hear_line(fd), want);
    }
}

TEST(constraints_of_a_large_set_are_sorted_whether_all_or_some_are_asked_for)
{
    enum { N = 4000 }; /* more than a reactor reads at once */
    char want[80];
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    constrain_many(fd, N);
    say(fd, "CONSTRAINTS t\n");
    snprintf(want, sizeof want, "OK %u", 3 * (N - 1) + N - 2);
    CHECK_STR(hear_line(fd), want);
    for (unsigned i = 0; i < N; i++)
        hear_rows(fd, i, N, 0, 3);
    say(fd, "CONSTRAINTS t OF 2\n");
    snprintf(want, sizeof want, "OK %u", N - 1);
    CHECK_STR(hear_line(fd), want);
    for (unsigned i = 0; i < N; i++)
        hear_rows(fd, i, N, 2, 3);
    say(fd, "CONSTRAINTS t 0\n");
    snprintf(want, sizeof want, "OK %u", 3 + N - 2);
    CHECK_STR(hear_line(fd), want);
    hear_rows(fd, 0, N, 0, 3);
    say(fd, "CONSTRAINTS t 3999 3998 3999\n"); /* each row once */
    expect(fd, "OK 8\n0 3998 border 0\n0 3999 border 0\n");
    hear_rows(fd, 3997, N, 0, 3);
    hear_rows(fd, 3998, N, 0, 3);
    close(fd);
    daemon_end(&d);
}
