/* refine_test.c - REFINE through the server: what it answers, what is logged and sent, and what stays as it was. */
#include "core/delaunay_constraints.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PLATE "ADD t FIELDS z 0 0 0  8 0 8  8 1 9  0 1 1\nTRIANGULATE t\n"

/* The reply to a request begins so. */
static void begins(struct local *l, const char *request, const char *want)
{
    const char *got = local_ask(l, request);
    CHECK_MSG(strncmp(got, want, strlen(want)) == 0, "%s gave %s", request, got);
}

TEST(refine_adds_points_and_borders_and_again_changes_nothing)
{
    for (unsigned threads = 0; threads < 3; threads++) {
        struct local l;
        local_start(&l, threads);
        local_ask(&l, PLATE);
        begins(&l, "REFINE t LIMIT 2\n",
               "OK 0 first=4 added=2 split=2 angle=14.036243467926479 "
               "unrefined=4 hull=4 version=");
        CHECK_STR(local_ask(&l, "CONSTRAINTS t\nFGET t z 4 5\n"),
                  "OK 6\n0 3 border 0\n0 5 border 0\n1 2 border 0\n1 5 border 0\n2 4 border 0\n"
                  "3 4 border 0\nOK 2\n4 5\n5 4\n");
        begins(&l, "REFINE t\n", "OK 0 first=6 added=");
        uint64_t version = local_set(&l, "t")->version;
        begins(&l, "REFINE t\n", "OK 0 first=");
        CHECK(local_set(&l, "t")->version == version);
        begins(&l, "CHECK t\n", "OK 0 delaunay=yes");
        local_stop(&l);
    }
}

TEST(refine_without_limits_is_to_25_degrees_and_options_come_in_any_order)
{
    static const char *const same[] = {"REFINE t\n",
                                       "REFINE t ANGLE 25 LIMIT 64\n",
                                       "REFINE t LIMIT 64 ANGLE 25\n",
                                       "REFINE t INSIDE ANGLE 25\n",
                                       "REFINE t INSIDE 0 LIMIT 64 ANGLE 25\n",
                                       "REFINE t angle 25 inside 0\n"};
    char *want = NULL;
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        struct local l;
        local_start(&l, 0);
        local_ask(&l, PLATE "CONSTRAIN t BORDER RING 0 1 2 3\n");
        begins(&l, same[i], "OK 0 first=4 added=");
        const char *got = local_ask(&l, "POINTS t\nCONSTRAINTS t\nTRIANGLES t\n");
        if (want == NULL)
            want = strdup(got);
        CHECK_STR(got, want);
        local_stop(&l);
    }
    free(want);
}

TEST(refine_of_a_set_without_triangles_changes_nothing)
{
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 0 0  1 1  3 3\nTRIANGULATE t\n");
    begins(&l, "REFINE t ANGLE 30 AREA 1\n",
           "OK 0 first=3 added=0 split=0 angle=nan unrefined=0 hull=0 version=");
    local_stop(&l);
}

TEST(refine_requests_with_faults_change_nothing)
{
    static const struct {
        const char *request, *want;
    } cases[] = {{"REFINE u\n", "ERR NOSET"},
                 {"REFINE t ANGLE\n", "ERR SYNTAX"},
                 {"REFINE t ANGLE 20 ANGLE 20\n", "ERR SYNTAX"},
                 {"REFINE t KEEP KEEP\n", "ERR SYNTAX"},
                 {"REFINE t INSIDE 1 2\n", "ERR SYNTAX"},
                 {"REFINE t LIMIT\n", "ERR SYNTAX"},
                 {"REFINE t ANGLE x\n", "ERR NUMBER"},
                 {"REFINE t LIMIT -1\n", "ERR NUMBER"},
                 {"REFINE t ANGLE 60\n", "ERR RANGE no triangle has all angles above 60 degrees"},
                 {"REFINE t ANGLE 0\n", "ERR RANGE a limit is more than 0"},
                 {"REFINE t AREA -1\n", "ERR RANGE a limit is not negative"},
                 {"REFINE t LENGTH 1e300\n", "ERR RANGE"},
                 {"REFINE t LENGTH nan\n", "ERR NUMBER"},
                 {"REFINE t INSIDE 9\n", "ERR NOREGION there is no border of number 9"},
                 {"REFINE t INSIDE 3\n", "ERR OPEN the border of number 3 is open"},
                 {"REFINE t\n", "ERR OPEN all borders are open"}};
    struct local l;
    local_start(&l, 0);
    local_ask(&l, "ADD t 0 0  8 0  8 1  0 1\n");
    begins(&l, "REFINE t\n", "ERR UNTRIANGULATED");
    local_ask(&l, "TRIANGULATE t\nCONSTRAIN t BORDER OF 3 0 1\n");
    uint64_t version = local_set(&l, "t")->version;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        begins(&l, cases[i].request, cases[i].want);
    CHECK(local_set(&l, "t")->version == version &&
          dt_next_id(local_set(&l, "t")->current->dt) == 4);
    local_stop(&l);
}

TEST(refine_beyond_the_points_that_a_set_may_have_changes_nothing)
{
    struct local l;
    local_start(&l, 0);
    l.config.max_points = 6;
    local_ask(&l, PLATE);
    begins(&l, "REFINE t ANGLE 30\n", "ERR TOOBIG ");
    begins(&l, "CONSTRAINTS t\n", "OK 0\n");
    begins(&l, "REFINE t ANGLE 30 LIMIT 2\n", "OK 0 first=4 added=2 ");
    local_stop(&l);
}

/* ---- with files, and large ---- */

TEST_TIMEOUT(a_large_refinement_is_carried_out_by_a_worker_and_survives, 60)
{
    static const char *const sets[] = {"t", NULL};
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 0  8 0 8  8 1 9  0 1 1\nTRIANGULATE t\n"
            "REFINE t ANGLE 28 AREA 0.001 LIMIT 100000\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=4", 13) == 0);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "OK 0 first=4 added=", 19) == 0 && strstr(got, " unrefined=0 ") != NULL,
              "%s", got);
    char *state = directory_state(&d, sets);
    for (int again = 0; again < 2; again++) { /* from the log, then from a snapshot */
        close(fd);
        daemon_stop(&d, again == 0 ? SIGKILL : SIGTERM);
        d = directory_daemon(&dir, NULL);
        char *now = directory_state(&d, sets);
        CHECK_STR(now, state);
        free(now);
        carry_out(&d, "SNAPSHOT\nCHECK t\n");
        fd = daemon_connect(&d);
    }
    free(state);
    close(fd);
    daemon_end(&d);
    directory_remove(&dir);
}

TEST_TIMEOUT(a_refinement_ends_with_its_time_or_its_memory_and_changes_nothing, 60)
{
    const char *const limit[] = {"--max-memory", "40m", NULL};
    struct daemon d = daemon_start(limit);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0  1 0  1 1  0 1\nTRIANGULATE t\nREFINE t AREA 1e-7 LIMIT 90000000\n"
            "TIMEOUT 0.05 REFINE t AREA 1e-5 LIMIT 90000000\nCONSTRAINTS t\nCHECK t\n"
            "REFINE t AREA 0.001 LIMIT 90000000\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=4", 13) == 0);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "ERR NOMEM", 9) == 0 || strncmp(got, "ERR BUSY", 8) == 0, "%s", got);
    got = hear_line(fd);
    CHECK_MSG(strncmp(got, "ERR TIMEOUT", 11) == 0 || strncmp(got, "ERR NOMEM", 9) == 0 ||
                  strncmp(got, "ERR BUSY", 8) == 0,
              "%s", got);
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK(strncmp(hear_line(fd), "OK 0 delaunay=yes points=4 ", 27) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 first=4 added=", 19) == 0);
    close(fd);
    daemon_end(&d);
}

TEST(a_watcher_of_constraints_sees_points_and_parts)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d), watcher = daemon_connect(&d);
    say(fd, PLATE);
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=4", 13) == 0);
    say(watcher, "WATCH t CONSTRAINTS\n");
    CHECK(strncmp(hear_line(watcher), "OK", 2) == 0);
    say(fd, "REFINE t LIMIT 1\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=4 added=1 split=1 ", 29) == 0);
    unsigned constraints = 0, points = 0;
    for (int i = 0; i < 40 && constraints < 5; i++) {
        const char *line = hear_line(watcher);
        constraints += strstr(line, "constraint ") != NULL;
        points += strncmp(line, "4 ", 2) == 0 || strstr(line, " 4 4 1") != NULL;
    }
    CHECK(constraints == 5 && points > 0);
    close(watcher);
    close(fd);
    daemon_end(&d);
}
