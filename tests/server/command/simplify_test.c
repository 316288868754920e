/* simplify_test.c - SIMPLIFY: what clients see, and what the log has. */
#include "tests/server/daemon.h"
#include "tests/server/directory.h"
#include "tests/server/local.h"
#include "tests/test.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char *const no_arguments[] = {NULL};

#define PEAK "ADD t FIELDS z,w 0 0 0 1 4 0 0 2 4 4 0 3 0 4 0 4 2 2 5 5 1 2 2 6\n"

#define USAGE "ERR SYNTAX usage: SIMPLIFY set field ERROR e [POINTS n] [IDS name] INTO other\n"

TEST(requests_to_simplify_that_cannot_be_carried_out)
{
    struct local l;
    static const struct {
        const char *request, *want;
    } cases[] = {
        {"SIMPLIFY u z ERROR 1 INTO v\n", "ERR NOSET there is no set u\n"},
        {"SIMPLIFY t y ERROR 1 INTO v\n", "ERR NOFIELD there is no field y\n"},
        {"SIMPLIFY t z ERROR x INTO v\n", "ERR NUMBER x is not a number\n"},
        {"SIMPLIFY t z ERROR nan INTO v\n", "ERR NUMBER nan is not a number\n"},
        {"SIMPLIFY t z ERROR 1e999 INTO v\n", "ERR RANGE an error is finite and not negative\n"},
        {"SIMPLIFY t z ERROR 1 POINTS -1 INTO v\n", "ERR NUMBER -1 is not a number of points\n"},
        {"SIMPLIFY t z ERROR 1 INTO v v\n", USAGE},
        {"SIMPLIFY t z ERROR 1 INTO\n", USAGE},
        {"SIMPLIFY t z ERROR 1 IDS INTO v\n", USAGE},
        {"SIMPLIFY t z ERROR 1 IDS i POINTS 9 INTO v\n", USAGE},
        {"SIMPLIFY t z WITHIN 1 INTO v\n", USAGE},
        {"SIMPLIFY t z ERROR 1 INTO a/b\n",
         "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\n"},
        {"SIMPLIFY t z ERROR 1 INTO t\n", "ERR EXISTS the set t already exists\n"},
        {"SIMPLIFY t z ERROR 1 IDS w INTO v\n",
         "ERR EXISTS the set has a field of that name for ids\n"},
        {"SIMPLIFY t z ERROR 1 POINTS 3 INTO v\n",
         "ERR RANGE 4 points must stay: corners of the hull, ends of constraints\n"},
        {"STAT v\n", "ERR NOSET there is no set v\n"}};
    local_start(&l, 0);
    local_ask(&l, PEAK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK_STR(local_ask(&l, cases[i].request), cases[i].want);
    local_stop(&l);
}

TEST(all_fields_are_carried_over_and_ids_are_kept_in_a_field)
{
    struct daemon d = daemon_start(no_arguments);
    converse(
        &d,
        PEAK
        "DEL t 1\nSIMPLIFY t z ERROR 1 IDS old INTO few\nPOINTS few FIELDS z,w,old\nFIELDS t\n",
        "OK 0 first=0 added=6 coincident=0\nOK 0 deleted=1\n"
        "OK 0 points=4 constraints=0 error=0.5\nOK 4\n0 0 0 0 1 0\n1 4 4 0 3 2\n2 0 4 0 4 3\n"
        "3 2 2 5 5 4\nOK 2\nw 5 1 6\nz 5 0 5\n");
    daemon_stop(&d, SIGTERM);
}

TEST(constraints_of_aliases_stand_between_representatives)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             "CREATE t TOL 0.5\nADD t FIELDS z 0 0 0 4 0 0 0 4 0 1 1 0 1.1 1 9 2 1 0\n"
             "CONSTRAIN t OF 2 4 5\nCONSTRAIN t 3 4\nCONSTRAIN t BORDER RING 0 1 2\n"
             "SIMPLIFY t z ERROR 1 IDS old INTO u\nPOINTS u FIELDS old\nCONSTRAINTS u\n",
             "OK 0\nOK 0 first=0 added=6 coincident=1\nOK 0 added=1\nOK 0 added=1\nOK 0 added=3\n"
             "OK 0 points=5 constraints=4 error=0\nOK 5\n0 0 0 0\n1 4 0 1\n2 0 4 2\n3 1 1 3\n"
             "4 2 1 5\nOK 4\n0 1 border 0\n0 2 border 0\n1 2 border 0\n3 4 line 2\n");
    daemon_stop(&d, SIGTERM);
}

TEST(sets_without_points_or_values_become_empty_sets)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             PEAK "FDROP t w\nFSET t y 0 1 0 nan\nSIMPLIFY t y ERROR 0 INTO u\nDEL t 0 1 2 3 4 5\n"
                  "SIMPLIFY t z ERROR 0 INTO v\nPOINTS u\nPOINTS v\n",
             "OK 0 first=0 added=6 coincident=0\nOK 0\nOK 0\n"
             "OK 0 points=0 constraints=0 error=0\nOK 0 deleted=6\n"
             "OK 0 points=0 constraints=0 error=0\nOK 0\nOK 0\n");
    daemon_stop(&d, SIGTERM);
}

enum { POINTS = 60000 };

/* A field of random values for a random set. */
static int load_values(const struct daemon *d, double most)
{
    static double z[POINTS];
    char text[60];
    int fd = daemon_connect(d);
    load_random(fd, "t", POINTS);
    for (uint32_t i = 0; i < POINTS; i++)
        z[i] = most * (double)(test_random() % 1000) / 1000;
    snprintf(text, sizeof text, "FSETB t z 0 %d\n", POINTS);
    say(fd, text);
    say_bytes(fd, z, sizeof z);
    expect(fd, "OK 0\n");
    return fd;
}

/* Sends the request, and returns when a worker has begun with it. */
static void begin(const struct daemon *d, int fd, const char *request)
{
    await_info(d, "jobs_running", 0);
    uint64_t jobs = daemon_info(d, "jobs");
    say(fd, request);
    while (daemon_info(d, "jobs") == jobs)
        pause_ms(1);
}

/* A line that is no progress comment, which a slow machine sends. */
static const char *hear_reply(int fd)
{
    const char *line = hear_line(fd);
    while (line[0] == '#')
        line = hear_line(fd);
    return line;
}

TEST_TIMEOUT(others_are_served_and_edit_while_a_large_set_is_simplified, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = load_values(&d, 1), other = daemon_connect(&d);
    begin(&d, fd, "SIMPLIFY t z ERROR 0.1 IDS id INTO u\n");
    say(other, "SETS\nFDROP t z\nDEL t 0 1 2\nSIMPLIFY t z ERROR 1 INTO v\n");
    expect(other, "OK 1\n");
    hear_line(other);
    expect(other, "OK 0\nOK 0 deleted=3\nERR NOFIELD there is no field z\n");
    CHECK(strncmp(hear_reply(fd), "OK 0 points=", 12) == 0);
    say(fd, "FIELDS u\n");
    expect(fd, "OK 2\n");
    daemon_stop(&d, SIGTERM);
}

TEST_TIMEOUT(a_set_of_the_name_that_comes_meanwhile_stays, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = load_values(&d, 1), other = daemon_connect(&d);
    begin(&d, fd, "SIMPLIFY t z ERROR 0.01 INTO u\n");
    say(other, "ADD u 7 7\n");
    expect(other, "OK 0 first=0 added=1 coincident=0\n");
    CHECK_STR(hear_reply(fd), "ERR EXISTS the set u already exists");
    converse(&d, "POINTS u\n", "OK 1\n0 7 7\n");
    daemon_stop(&d, SIGTERM);
}

TEST_TIMEOUT(simplify_ends_in_time_and_leaves_nothing, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = load_values(&d, 1);
    say(fd, "TIMEOUT 0.01 SIMPLIFY t z ERROR 0 INTO u\nSTAT u\n");
    CHECK(strncmp(hear_reply(fd), "ERR TIMEOUT", 11) == 0);
    expect(fd, "ERR NOSET there is no set u\n");
    daemon_stop(&d, SIGTERM);
}

TEST_TIMEOUT(simplify_without_memory_is_refused, 60)
{
    static const char *const little[] = {"--max-memory", "20m", NULL};
    struct daemon d = daemon_start(little);
    int fd = load_values(&d, 1);
    say(fd, "SIMPLIFY t z ERROR 0 INTO u\nSTAT u\n");
    const char *got = hear_reply(fd);
    CHECK_MSG(strncmp(got, "ERR NOMEM", 9) == 0 || strncmp(got, "ERR BUSY", 8) == 0, "%s", got);
    expect(fd, "ERR NOSET there is no set u\n");
    daemon_stop(&d, SIGTERM);
}

/* The log has the points: a killed daemon has the set again, small or large. */
TEST_TIMEOUT(a_simplified_set_survives_a_kill, 60)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    int fd = load_values(&d, 1);
    char digest[2][80];
    static const char *const asked[] = {"DIGEST large\n", "DIGEST small\n"};
    say(fd, PEAK "CONSTRAIN t OF 4 0 1\nSIMPLIFY t z ERROR 0.4 IDS i INTO large\n"
                 "ADD q FIELDS z 0 0 1 1 0 2 0 1 3 0.2 0.2 9\nSIMPLIFY q z ERROR 2 INTO small\n");
    for (int i = 0; i < 5; i++)
        CHECK(strncmp(hear_reply(fd), "OK 0 ", 5) == 0);
    for (int i = 0; i < 2; i++) {
        say(fd, asked[i]);
        snprintf(digest[i], sizeof digest[i], "%s", hear_reply(fd));
        CHECK(strncmp(digest[i], "OK 0 digest=", 12) == 0);
    }
    daemon_stop(&d, SIGKILL);
    d = directory_daemon(&dir, NULL);
    fd = daemon_connect(&d);
    for (int i = 0; i < 2; i++) {
        say(fd, asked[i]);
        CHECK_STR(hear_reply(fd), digest[i]);
    }
    daemon_stop(&d, SIGTERM);
    directory_remove(&dir);
}
