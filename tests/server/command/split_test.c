/* split_test.c - CONSTRAIN ... SPLIT through the server: its answer, its records in the log, and the parts of the set that stay. */
#include "core/delaunay_constraints.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The reply to the last request of several begins so. */
static void expect_last(struct local *l, const char *requests, const char *want)
{
    const char *got = local_ask(l, requests), *at = got;
    for (const char *next; (next = strstr(at, "\n")) != NULL && next[1] != '\0';)
        at = next + 1;
    CHECK_MSG(strncmp(at, want, strlen(want)) == 0, "%s gave %s", requests, got);
}

#define CROSS "ADD t 0 0 4 4 0 4 4 0\nFSET t z 0 0 1 8 2 8 3 0\n"

static const char *const before[] = {"", "TRIANGULATE t\n"};

TEST(split_replaces_constraints_that_cross_by_their_parts)
{
    for (int i = 0; i < 2; i++) {
        struct local l;
        local_start(&l, 0);
        local_ask(&l, CROSS);
        local_ask(&l, before[i]);
        local_ask(&l, "CONSTRAIN t OF 5 0 1\n");
        expect_last(&l, "CONSTRAIN t BORDER OF 7 SPLIT 2 3\n",
                    "OK 0 first=4 added=1 split=2 deviation=0 version=");
        CHECK_STR(local_ask(&l, "POINTS t FIELDS z\n"),
                  "OK 5\n0 0 0 0\n1 4 4 8\n2 0 4 8\n3 4 0 0\n4 2 2 4\n");
        CHECK_STR(local_ask(&l, "CONSTRAINTS t\n"),
                  "OK 4\n0 4 line 5\n1 4 line 5\n2 4 border 7\n3 4 border 7\n");
        expect_last(&l, "TRIANGULATE t\nCHECK t\n", "OK 0 delaunay=yes points=5");
        local_stop(&l);
    }
}

TEST(split_of_what_does_not_cross_declares_it_and_again_changes_nothing)
{
    for (int i = 0; i < 2; i++) {
        struct local l;
        local_start(&l, 0);
        local_ask(&l, CROSS);
        local_ask(&l, before[i]);
        expect_last(&l, "CONSTRAIN t SPLIT RING 0 3 1\n",
                    "OK 0 first=4 added=0 split=0 deviation=0 version=");
        uint64_t version = local_set(&l, "t")->version;
        expect_last(&l, "CONSTRAIN t SPLIT 0 1 1 3\n",
                    "OK 0 first=4 added=0 split=0 deviation=0 version=");
        CHECK(local_set(&l, "t")->version == version);
        CHECK_STR(local_ask(&l, "CONSTRAINTS t\n"), "OK 3\n0 1 line 0\n0 3 line 0\n1 3 line 0\n");
        local_stop(&l);
    }
}

TEST(words_before_the_ids_of_constraints_come_in_any_order)
{
    static const char *const words[] = {"BORDER OF 3 SPLIT", "BORDER SPLIT OF 3",
                                        "SPLIT OF 3 BORDER", "OF 3 BORDER SPLIT",
                                        "OF 3 SPLIT BORDER"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct local l;
        char line[100];
        local_start(&l, 0);
        local_ask(&l, CROSS);
        snprintf(line, sizeof line, "CONSTRAIN t %s 0 1 2 3\n", words[i]);
        expect_last(&l, line, "OK 0 first=4 added=1 split=2 ");
        expect_last(&l, "CONSTRAINTS t\n", "3 4 border 3\n");
        local_stop(&l);
    }
}

TEST(split_requests_with_faults_change_nothing)
{
    static const struct {
        const char *request, *want;
    } cases[] = {
        {"CONSTRAIN t SPLIT", "ERR SYNTAX"},
        {"CONSTRAIN t SPLIT 0", "ERR SYNTAX"},
        {"CONSTRAIN t SPLIT SPLIT 0 1", "ERR SYNTAX"},
        {"CONSTRAIN t SPLIT SPLIT 0 1 2", "ERR NUMBER"},
        {"CONSTRAIN t SPLIT 0 0", "ERR SYNTAX"},
        {"CONSTRAIN t SPLIT 0 1 2 9", "ERR NOPOINT there is no point 9; nothing was declared"},
        {"CONSTRAIN t SPLIT OF 2147483648 0 1", "ERR RANGE"},
        {"CONSTRAIN u SPLIT 0 1", "ERR NOSET"},
        {"RELEASE t SPLIT 0 1", "ERR SYNTAX"},
        {"RELEASE t SPLIT OF 1", "ERR SYNTAX"}};
    struct local l;
    char line[100];
    local_start(&l, 0);
    local_ask(&l, CROSS "TRIANGULATE t\nCONSTRAIN t 0 1\n");
    uint64_t version = local_set(&l, "t")->version;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(line, sizeof line, "%s\n", cases[i].request);
        expect_last(&l, line, cases[i].want);
    }
    CHECK(local_set(&l, "t")->version == version &&
          dt_next_id(local_set(&l, "t")->current->dt) == 4);
    local_stop(&l);
}

TEST(split_that_needs_more_points_than_a_set_may_have_changes_nothing)
{
    struct local l;
    local_start(&l, 0);
    l.config.max_points = 4;
    local_ask(&l, CROSS "TRIANGULATE t\nCONSTRAIN t 0 1\n");
    expect_last(&l, "CONSTRAIN t SPLIT 2 3\n", "ERR TOOBIG ");
    CHECK_STR(local_ask(&l, "CONSTRAINTS t\n"), "OK 1\n0 1 line 0\n");
    expect_last(&l, "CHECK t\n", "OK 0 delaunay=yes points=4");
    l.config.max_points = 5;
    expect_last(&l, "CONSTRAIN t SPLIT 2 3\n", "OK 0 first=4 added=1 split=2 ");
    local_stop(&l);
}

/* Every constraint is asked for in any order, and either way round. */
TEST(split_sets_are_the_same_in_any_order_of_the_request)
{
    enum { POINTS = 24, LINES = 16 };
    for (int round = 0; round < 10; round++) {
        char points[2000], *want = NULL;
        unsigned end[LINES][2];
        size_t n = (size_t)snprintf(points, sizeof points, "ADD t");
        for (int i = 0; i < POINTS; i++)
            n += (size_t)snprintf(points + n, sizeof points - n, " %u %u",
                                  (unsigned)(test_random() % 32), (unsigned)(test_random() % 32));
        snprintf(points + n, sizeof points - n, "\n%s", before[round % 2]);
        for (int i = 0; i < LINES; i++)
            do {
                end[i][0] = (unsigned)(test_random() % POINTS);
                end[i][1] = (unsigned)(test_random() % POINTS);
            } while (end[i][0] == end[i][1]);
        for (unsigned turn = 0; turn < LINES; turn++) {
            struct local l;
            char request[1000];
            local_start(&l, turn % 3);
            local_ask(&l, points);
            n = (size_t)snprintf(request, sizeof request, "CONSTRAIN t SPLIT");
            for (unsigned i = 0; i < LINES; i++) {
                const unsigned *e =
                    end[(turn * 5 + i) % LINES]; /* 5 and 16 have no common divisor */
                n += (size_t)snprintf(request + n, sizeof request - n, " %u %u", e[(turn + i) % 2],
                                      e[(turn + i + 1) % 2]);
            }
            snprintf(request + n, sizeof request - n, "\n");
            CHECK(strncmp(local_ask(&l, request), "OK", 2) == 0);
            local_ask(&l, "TRIANGULATE t METHOD divide\n");
            const char *got = local_ask(&l, "POINTS t\nCONSTRAINTS t\nCHECK t\nTRIANGLES t\n");
            CHECK(strstr(got, "ERR") == NULL);
            if (want == NULL)
                want = strdup(got);
            CHECK_STR(got, want);
            local_stop(&l);
        }
        free(want);
    }
}

/* ---- large ones ---- */

enum { GRID = 200 };

/* The set g of the ends of GRID lines each way, and a request for these lines in binary. */
static void say_grid(int fd, bool live)
{
    double xy[4 * GRID][2];
    uint32_t pair[2 * GRID][2];
    char line[100];
    for (uint32_t i = 0; i < GRID; i++) {
        xy[4 * i][0] = xy[4 * i + 1][0] = xy[4 * i + 2][1] = xy[4 * i + 3][1] = i + 1;
        xy[4 * i][1] = xy[4 * i + 2][0] = 0;
        xy[4 * i + 1][1] = xy[4 * i + 3][0] = GRID + 1;
        pair[2 * i][0] = 4 * i;
        pair[2 * i][1] = 4 * i + 1;
        pair[2 * i + 1][0] = 4 * i + 2;
        pair[2 * i + 1][1] = 4 * i + 3;
    }
    snprintf(line, sizeof line, "LOADB g %d\n", 4 * GRID);
    say(fd, line);
    say_bytes(fd, xy, sizeof xy);
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    if (live) {
        say(fd, "TRIANGULATE g\n");
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    }
    snprintf(line, sizeof line, "CONSTRAINB g SPLIT %d\n", 2 * GRID);
    say(fd, line);
    say_bytes(fd, pair, sizeof pair);
}

TEST_TIMEOUT(large_split_in_binary_is_carried_out_by_a_worker_and_survives, 60)
{
    static const char *const sets[] = {"g", NULL};
    for (int live = 0; live < 2; live++) {
        struct directory dir = directory_new();
        struct daemon d = directory_daemon(&dir, NULL);
        int fd = daemon_connect(&d);
        char want[100];
        say_grid(fd, live == 1);
        snprintf(want, sizeof want,
                 "OK 0 first=%d added=%d split=%d deviation=0 version=", 4 * GRID, GRID * GRID,
                 2 * GRID);
        const char *got = hear_line(fd);
        CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s", got);
        char *state = directory_state(&d, sets);
        close(fd);
        daemon_stop(&d, SIGKILL);
        d = directory_daemon(&dir, NULL);
        char *again = directory_state(&d, sets);
        CHECK_STR(again, state);
        free(again);
        carry_out(&d, live == 1 ? "SNAPSHOT\nCHECK g\n" : "SNAPSHOT\n");
        daemon_stop(&d, SIGTERM);
        d = directory_daemon(&dir, NULL);
        again = directory_state(&d, sets);
        CHECK_STR(again, state);
        free(again);
        free(state);
        daemon_end(&d);
        directory_remove(&dir);
    }
}

TEST_TIMEOUT(split_with_more_crossings_than_there_is_memory_for_is_refused_and_changes_nothing, 60)
{
    const char *const limit[] = {"--max-memory", "12m", NULL};
    struct daemon d = daemon_start(limit);
    int fd = daemon_connect(&d);
    say_grid(fd, true);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "ERR NOMEM", 9) == 0 || strncmp(got, "ERR BUSY", 8) == 0, "%s", got);
    say(fd, "CONSTRAINTS g BINARY\nCHECK g\n");
    CHECK_STR(hear_line(fd), "OK 0 rows=0 bytes=0");
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes points=800 ", 29) == 0);
    close(fd);
    daemon_end(&d);
}
