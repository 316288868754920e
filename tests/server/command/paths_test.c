/* paths_test.c - LOAD ... PATHS: points and constraints come together, or not at all. */
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

TEST(paths_have_numbers_and_a_path_that_ends_where_it_begins_is_a_ring)
{
    struct local l;
    local_start(&l, 0);
    expect_last(&l,
                "LOAD t PATHS BORDER OF 3 FIELDS z\n0 0 1\n4 0 2\n4 4 3\n-0 0 1\n> a hole\n>\n"
                "# none\n1 1 nan\n>\n2 1 5\n\n3 1 6\n.\n",
                "OK 0 first=0 added=6 coincident=0 constraints=4 version=");
    CHECK_STR(local_ask(&l, "CONSTRAINTS t\n"),
              "OK 4\n0 1 border 3\n0 2 border 3\n1 2 border 3\n4 5 border 5\n");
    CHECK_STR(local_ask(&l, "POINTS t FIELDS z\n"),
              "OK 6\n0 0 0 1\n1 4 0 2\n2 4 4 3\n3 1 1 nan\n4 2 1 5\n5 3 1 6\n");
    local_stop(&l);
}

TEST(short_paths_that_end_where_they_begin_have_no_side_twice)
{
    struct local l;
    local_start(&l, 0);
    expect_last(&l, "LOAD t 8 PATHS\n1 1\n1 1\n>\n2 2\n3 3\n2 2\n>\n> none\n",
                "OK 0 first=0 added=3 coincident=0 constraints=1 version=");
    CHECK_STR(local_ask(&l, "CONSTRAINTS t\n"), "OK 1\n1 2 line 1\n");
    expect_last(&l, "LOAD u PATHS\n.\n", "OK 0 first=0 added=0 coincident=0 constraints=0");
    CHECK_STR(local_ask(&l, "POINTS u\n"), "OK 0\n");
    local_stop(&l);
}

TEST(paths_that_cross_are_named_by_their_lines_and_leave_nothing)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 0 0 4 0 4 4 0 4\nTRIANGULATE t\nCONSTRAIN t 0 1\n");
    uint64_t version = local_set(&l, "t")->version;
    expect_last(&l, "LOAD t 2 PATHS\n2 -1\n2 1\n", "ERR CROSSES line 2 crosses 0 1\n");
    expect_last(&l, "LOAD t PATHS OF 7 FIELDS z\n# a\n1 1 1\n3 3 1\n>\n1 3 1\n\n3 1 1\n.\n",
                "ERR CROSSES line 7 crosses line 3\n");
    expect_last(&l, "FIELDS t\n", "OK 0\n");
    CHECK(local_set(&l, "t")->version == version);
    CHECK(dt_next_id(local_set(&l, "t")->current->dt) == 4);
    expect_last(&l, "CHECK t\n", "OK 0 delaunay=yes points=4 ");
    expect_last(&l, "LOAD t PATHS OF 7 SPLIT FIELDS z\n1 1 1\n3 3 1\n>\n1 3 3\n3 1 3\n.\n",
                "OK 0 first=4 added=5 coincident=0 constraints=4 split=2 deviation=0 version=");
    expect_last(&l, "POINTS t FIELDS z\n", "8 2 2 2\n");
    expect_last(&l, "CHECK t\n", "OK 0 delaunay=yes points=9 ");
    local_stop(&l);
}

TEST(requests_for_paths_of_another_form_are_refused)
{
    static const struct {
        const char *request, *want;
    } cases[] = {{"LOAD t 1 PATHS x\n1 2\n", "ERR SYNTAX usage"},
                 {"LOAD t 1 PATHS OF\n1 2\n", "ERR SYNTAX usage"},
                 {"LOAD t 1 PATHS BORDER BORDER\n1 2\n", "ERR SYNTAX usage"},
                 {"LOAD t 1 PATHS OF x\n1 2\n", "ERR NUMBER"},
                 {"LOAD t 3 PATHS OF 2147483647\n1 2\n>\n3 4\n", "ERR RANGE"},
                 {"LOAD t 2 PATHS\n> a\n1 x\n", "ERR NUMBER line 2: "},
                 {"LOAD t 2 PATHS\n> a\n1 2 3\n", "ERR SYNTAX line 2: not `x y`; nothing"},
                 {"LOAD t 1\n> a\n", "ERR NUMBER line 1"}};
    struct local l;
    local_start(&l, 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_last(&l, cases[i].request, cases[i].want);
    CHECK_STR(local_ask(&l, "SETS\n"), "OK 0\n");
    local_stop(&l);
}

/* A text of so many lines that workers parse it; the last path is a ring. */
TEST_TIMEOUT(long_text_of_paths_is_parsed_by_workers_and_survives_a_kill, 60)
{
    enum { PATHS = 20000, PLACES = 5 };
    static const char *const sets[] = {"t", NULL};
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = daemon_connect(&d);
    char *text = malloc(PATHS * PLACES * 40), want[100];
    size_t n = (size_t)sprintf(text, "LOAD t PATHS OF 10 FIELDS z\n");
    CHECK(text != NULL);
    for (unsigned i = 0; i < PATHS; i++) {
        n += (size_t)sprintf(text + n, "> path %u\n", i);
        for (unsigned k = 0; k < PLACES; k++)
            n += (size_t)sprintf(text + n, "%u %u.5 %u\n", i, i + 1 == PATHS && k == 4 ? 0 : k, i);
    }
    n += (size_t)sprintf(text + n, ".\nCONSTRAINTS t OF %u\n", PATHS + 9);
    say_bytes(fd, text, n);
    snprintf(want, sizeof want,
             "OK 0 first=0 added=%u coincident=0 constraints=%u version=", PATHS * PLACES - 1,
             PATHS * (PLACES - 1));
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s", got);
    CHECK_STR(hear_line(fd), "OK 4");
    char *state = directory_state(&d, sets);
    close(fd);
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    char *again = directory_state(&d, sets);
    CHECK(strcmp(again, state) == 0);
    free(again);
    free(state);
    free(text);
    daemon_end(&d);
    directory_remove(&dir);
}
