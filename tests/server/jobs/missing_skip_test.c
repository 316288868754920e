/* missing_skip_test.c - MISSING skip: what clients see, builds that are shared, and what becomes of them. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

static void expect_ok(int fd)
{
    const char *line = hear_line(fd);
    CHECK_MSG(strncmp(line, "OK 0", 4) == 0, "%s", line);
}

/* A square of side 4 that rises to the north, and a point without a value in the middle. */
static int make_square(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "ADD t FIELDS z 0 0 0 4 0 0 4 4 8 0 4 8 2 2 nan\nTRIANGULATE t\n");
    expect_ok(fd);
    expect_ok(fd);
    return fd;
}

TEST(missing_values_are_skipped_by_every_command_about_a_surface)
{
    struct daemon d = daemon_start(no_arguments);
    make_square(&d);
    converse(
        &d,
        "INTERPOLATE t z 2 2 1 3 MISSING skip\nINTERPOLATE t z 2 2 METHOD nearest MISSING skip\n"
        "INTERPOLATE t z 2 2 METHOD natural MISSING skip MAXEDGE 9\nINTERPOLATE t z 2 2 MISSING "
        "nan\n"
        "GRADIENT t z 1 1 MISSING skip\nRASTER t z 0 0 4 4 2 2 MISSING skip\n"
        "RASTER t z 0 0 4 4 1 1 AS slope MISSING skip\nCONTOUR t z EVERY 4 BASE 2 MISSING skip\n"
        "CONTOUR t z 2 6 BANDS MISSING skip\nPROFILE t z 0 2 4 2 MISSING skip\n"
        "VOLUME t z LEVEL 1 MISSING skip\nINTERPOLATE t z 2 2\n",
        "OK 2\n4\n6\nOK 1\n0\nOK 1\n4\nOK 1\nnan\nOK 1\n0 2\nOK 2 columns=2\n6 6\n2 2\n"
        "OK 1 columns=1\n63.43494882292201\nOK 2\n2 open 3 0 1 3 1 4 1\n6 open 3 0 3 1 3 4 3\n"
        "OK 1\n2 6 0 outer 6 0 1 3 1 4 1 4 3 1 3 0 3\n"
        "OK 3\n0 0 2 4\n2 2 2 4\n4 4 2 4\nOK 0 above=49 below=1 area=16\nOK 1\nnan\n");
    daemon_stop(&d, SIGTERM);
}

#define USAGE                                                                                      \
    "ERR SYNTAX usage: VOLUME set field [LEVEL z | MINUS field] [INSIDE [k]] [MISSING nan|skip] "  \
    "[BOX x0 y0 x1 y1]\n"

TEST(missing_is_nan_or_skip_once_and_of_one_field)
{
    struct daemon d = daemon_start(no_arguments);
    make_square(&d);
    converse(&d,
             "VOLUME t z MISSING\nVOLUME t z MISSING zero\nVOLUME t z MISSING skip MISSING skip\n"
             "VOLUME t z MINUS z MISSING skip\nVOLUME t z MISSING nan\nVOLUME t y MISSING skip\n"
             "VOLUME u z MISSING skip\n",
             USAGE USAGE USAGE "ERR SYNTAX MISSING skip is for one field\n"
                               "OK 0 above=0 below=0 area=0\nERR NOFIELD there is no field y\n"
                               "ERR NOSET there is no set u\n");
    daemon_stop(&d, SIGTERM);
}

/* The first alias that has a value is the representative. A set without values is an empty set. */
TEST(skipping_is_as_deleting_for_coincident_points_and_for_all_points)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 nan 4 0 0 0 4 0 0 0 nan 0 0 5 0 0 7\nTRIANGULATE t\n");
    expect_ok(fd);
    expect_ok(fd);
    converse(&d,
             "INTERPOLATE t z 0 0 MISSING skip\nFSET t z 4 nan\nINTERPOLATE t z 0 0 MISSING skip\n"
             "FSET t z 1 nan 2 nan\nINTERPOLATE t z 0 0 1 1 MISSING skip\n"
             "INTERPOLATE t z 1 1 OUTSIDE nearest MISSING skip\nFSET t z 5 nan\n"
             "INTERPOLATE t z 0 0 OUTSIDE nearest METHOD nearest MISSING skip\n"
             "CONTOUR t z EVERY 1 MISSING skip\nVOLUME t z MISSING skip\nPROFILE t z 0 0 1 0 "
             "MISSING skip\n",
             "OK 1\n5\nOK 0\nOK 1\n7\nOK 0\nOK 2\n7\nnan\nOK 1\n7\nOK 0\nOK 1\nnan\nOK 0\n"
             "OK 0 above=0 below=0 area=0\nOK 2\n0 0 0 nan\n1 1 0 nan\n");
    daemon_stop(&d, SIGTERM);
}

TEST(constraints_that_end_at_a_missing_value_do_not_count)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_square(&d);
    say(fd, "ADD t FIELDS z 9 9 nan 9 8 1\nCONSTRAIN t BORDER OF 7 RING 0 1 2\n"
            "CONSTRAIN t BORDER OF 8 RING 2 3 4\nCONSTRAIN t 5 6\n");
    for (int i = 0; i < 4; i++)
        expect_ok(fd);
    converse(&d,
             "INTERPOLATE t z 3 1 1 3 INSIDE MISSING skip\nINTERPOLATE t z 3 1 1 3 INSIDE 8 "
             "MISSING skip\n"
             "INTERPOLATE t z 3 1 INSIDE 9 MISSING skip\nINTERPOLATE t z 3 1 METHOD natural "
             "MISSING skip\n"
             "RELEASE t BORDER OF 7\nINTERPOLATE t z 3 1 INSIDE 7 MISSING skip\n",
             "OK 2\n2\nnan\nERR OPEN the border of number 8 is open\n"
             "ERR NOREGION there is no border of number 9\n"
             "ERR NOTDELAUNAY the set has constraints; what needs every edge to be Delaunay is not "
             "defined: METHOD linear and nearest, CONTOUR, LOCATE, NEAREST and WITHIN are\n"
             "OK 0 released=3\nERR NOREGION there is no border of number 7\n");
    daemon_stop(&d, SIGTERM);
}

TEST(constraints_that_meet_at_a_missing_value_cross_without_it)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_square(&d);
    say(fd, "CONSTRAIN t 0 2 1 3\n");
    expect_ok(fd);
    converse(
        &d,
        "INTERPOLATE t z 1 1 MISSING skip\nINTERPOLATE t z 1 1 MISSING skip\nRELEASE t 0 2\n"
        "INTERPOLATE t z 1 1 MISSING skip\n",
        "ERR CROSSES 1 3 crosses 0 2\nERR CROSSES 1 3 crosses 0 2\nOK 0 released=1\nOK 1\n2\n");
    daemon_stop(&d, SIGTERM);
}

/* ---- what is kept ---- */

static bool has_copies(int fd)
{
    say(fd, "STAT t\n");
    return strstr(hear_line(fd), " copies=") != NULL;
}

/* Asks for the height at 1 1. */
static void expect_height(int fd, const char *want)
{
    say(fd, "INTERPOLATE t z 1 1 MISSING skip\n");
    expect(fd, want);
}

TEST(a_copy_is_kept_until_the_points_or_the_field_change)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_square(&d);
    CHECK(!has_copies(fd));
    expect_height(fd, "OK 1\n2\n");
    CHECK(has_copies(fd));
    CHECK(daemon_info(&d, "memory_copies") > 0);
    say(fd, "FSET t y 0 5\nTRIANGULATE t METHOD divide\n"); /* other values, the same triangles */
    expect_ok(fd);
    expect_ok(fd);
    pause_ms(2200);
    CHECK(has_copies(fd));
    static const char *const edits[] = {"FSET t z 0 1\n",    "MOVE t 0 -1 -1\n", "ADD t 9 9\n",
                                        "CONSTRAIN t 0 1\n", "RELEASE t 0 1\n",  "DEL t 5\n",
                                        "FDROP t z\n"};
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        say(fd, "INTERPOLATE t z 1 1 MISSING skip\n");
        expect(fd, "OK 1\n");
        hear_line(fd);
        CHECK(has_copies(fd));
        say(fd, edits[i]);
        expect_ok(fd);
        await_info(&d, "memory_copies", 0); /* within two ticks */
        CHECK(!has_copies(fd));
    }
    daemon_stop(&d, SIGTERM);
}

TEST(nothing_is_copied_if_no_value_is_missing)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_square(&d);
    say(fd, "FSET t z 4 4\n");
    expect_ok(fd);
    expect_height(fd, "OK 1\n2\n");
    CHECK(!has_copies(fd));
    expect_height(fd, "OK 1\n2\n");
    daemon_stop(&d, SIGTERM);
}

TEST(copies_go_with_their_set)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_square(&d);
    expect_height(fd, "OK 1\n2\n");
    say(fd, "DROP t\n");
    expect_ok(fd);
    CHECK(daemon_info(&d, "memory_copies") == 0);
    make_square(&d);
    converse(&d, "FSET t z 3 0 2 0\nINTERPOLATE t z 1 1 MISSING skip\n", "OK 0\nOK 1\n0\n");
    daemon_stop(&d, SIGTERM);
}

/* ---- large sets ---- */

enum { POINTS = 200000 };

/* All values are `value`, but for those of every k-th id, which are missing. */
static void send_values(int fd, double value, uint32_t k)
{
    static double z[POINTS];
    double nan = strtod("nan", NULL);
    char text[60];
    for (uint32_t i = 0; i < POINTS; i++)
        z[i] = i % k == 0 ? nan : value;
    snprintf(text, sizeof text, "FSETB t z 0 %d\n", POINTS);
    say(fd, text);
    say_bytes(fd, z, sizeof z);
}

static int make_large(const struct daemon *d)
{
    int fd = daemon_connect(d);
    load_random(fd, "t", POINTS);
    say(fd, "TRIANGULATE t\n");
    expect_ok(fd);
    send_values(fd, 1, 3);
    expect_ok(fd);
    return fd;
}

#define ASK "INTERPOLATE t z 0.5 0.5 MISSING skip\n"

static void expect_value(int fd, const char *want)
{
    CHECK_STR(hear_line(fd), "OK 1");
    CHECK_STR(hear_line(fd), want);
}

TEST_TIMEOUT(requests_that_come_together_share_one_build, 60)
{
    enum { CLIENTS = 6 };
    struct daemon d = daemon_start(no_arguments);
    int fd[CLIENTS], first = make_large(&d);
    for (int i = 0; i < CLIENTS; i++)
        fd[i] = daemon_connect(&d);
    uint64_t shared = daemon_info(&d, "jobs_shared");
    for (int i = 0; i < CLIENTS; i++)
        say(fd[i], ASK);
    for (int i = 0; i < CLIENTS; i++)
        expect_value(fd[i], "1");
    CHECK(daemon_info(&d, "jobs_shared") == shared + CLIENTS - 1);
    say(first, ASK);
    expect_value(first, "1");
    daemon_stop(&d, SIGTERM);
}

/* Asks, and returns when a worker has begun the build. */
static void begin_build(const struct daemon *d, int fd)
{
    await_info(d, "jobs_running", 0);
    say(fd, ASK);
    while (daemon_info(d, "memory_builds") == 0)
        pause_ms(1);
}

/* Others edit all the time: every request is answered, with a state that there was after it came. */
TEST_TIMEOUT(edits_do_not_wait_for_a_build_and_do_not_starve_it, 120)
{
    enum { ROUNDS = 6 };
    struct daemon d = daemon_start(no_arguments);
    int fd = make_large(&d), other = daemon_connect(&d);
    for (int round = 0; round < ROUNDS; round++) {
        char before[8], now[8];
        snprintf(before, sizeof before, "%d", 2 * round + 1);
        snprintf(now, sizeof now, "%d", 2 * round + 2);
        send_values(other, 2 * round + 1, 3);
        expect(other, "OK 0\n");
        begin_build(&d, fd);
        send_values(other, 2 * round + 2, 3);
        expect(other, "OK 0\n");
        say(fd, ASK); /* in the pipeline: it must see that edit */
        expect_value(fd, before);
        expect_value(fd, now);
    }
    daemon_stop(&d, SIGTERM);
}

TEST_TIMEOUT(a_build_ends_when_nobody_waits_for_it, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_large(&d);
    say(fd, "TIMEOUT 0.001 " ASK "PING\n");
    CHECK(strncmp(hear_line(fd), "ERR TIMEOUT", 11) == 0);
    expect(fd, "OK 0\n");
    await_info(&d, "jobs_running", 0);
    int gone = daemon_connect(&d);
    send_values(fd, 2, 4);
    expect_ok(fd);
    say(gone, ASK);
    pause_ms(5);
    close(gone);
    await_info(&d, "jobs_running", 0);
    say(fd, ASK);
    expect_value(fd, "2");
    daemon_stop(&d, SIGTERM);
}

TEST_TIMEOUT(a_set_is_dropped_during_a_build, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_large(&d), other = daemon_connect(&d);
    begin_build(&d, other);
    say(fd, "DROP t\n");
    expect_ok(fd);
    const char *got = hear_line(other);
    CHECK_MSG(strncmp(got, "ERR NOSET", 9) == 0 || strcmp(got, "OK 1") == 0, "%s", got);
    await_info(&d, "jobs_running", 0);
    CHECK(daemon_info(&d, "memory_copies") == 0);
    daemon_stop(&d, SIGTERM);
}

/* A copy does not take the memory that others need, and a build without memory is refused. */
TEST_TIMEOUT(copies_are_freed_when_memory_is_needed, 60)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = make_large(&d);
    char text[80];
    say(fd, ASK);
    expect_value(fd, "1");
    uint64_t copies = daemon_info(&d, "memory_copies");
    CHECK(copies > 1000000);
    await_info(&d, "jobs_running", 0);
    bool good = false;
    for (uint64_t more = 0; !good; more += copies / 8) { /* until the copy's memory is enough */
        snprintf(text, sizeof text, "CONFIG SET max-memory %llu\n",
                 (unsigned long long)(daemon_info(&d, "memory_used") + more));
        say(fd, text);
        expect_ok(fd);
        say(fd, "TRIANGULATE t METHOD divide\n");
        good = strncmp(hear_line(fd), "OK", 2) == 0;
    }
    CHECK(daemon_info(&d, "memory_copies") == 0);
    snprintf(text, sizeof text, "CONFIG SET max-memory %llu\n",
             (unsigned long long)daemon_info(&d, "memory") + (1 << 20));
    say(fd, text);
    expect_ok(fd);
    say(fd, ASK);
    const char *got = hear_line(fd);
    CHECK_MSG(strncmp(got, "ERR NOMEM", 9) == 0 || strncmp(got, "ERR BUSY", 8) == 0, "%s", got);
    daemon_stop(&d, SIGTERM);
}

/* A raster that is being sent goes on from its copy when that is out of date. */
TEST_TIMEOUT(a_raster_that_skips_is_of_one_moment_while_others_edit, 60)
{
    enum { SIDE = 1500 };
    struct daemon d = daemon_start(no_arguments);
    int fd = make_large(&d), other = daemon_connect(&d);
    char want[80];
    snprintf(want, sizeof want, "RASTER t z 0.1 0.1 0.9 0.9 %d %d MISSING skip BINARY\n", SIDE,
             SIDE);
    say(fd, want);
    snprintf(want, sizeof want, "OK 0 rows=%d columns=%d bytes=%zu", SIDE, SIDE,
             8 * (size_t)SIDE * SIDE);
    CHECK_STR(hear_line(fd), want);
    send_values(other, 2, 3);
    expect_ok(other);
    say(other, ASK);
    expect_value(other, "2");
    double *cell = malloc(sizeof *cell * SIDE * SIDE);
    CHECK(cell != NULL);
    hear_exactly(fd, cell, sizeof *cell * SIDE * SIDE);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        CHECK_MSG(cell[i] == 1, "%zu: %g", i, cell[i]);
    free(cell);
    daemon_stop(&d, SIGTERM);
}
