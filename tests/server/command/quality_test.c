/* quality_test.c - QUALITY: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char *const no_arguments[] = {NULL};

#define USAGE "ERR SYNTAX usage: QUALITY set [INSIDE [k]]\n"
#define UP_TO(a, b, c, d)                                                                          \
    "0 5 " #a "\n5 10 0\n10 15 0\n15 20 " #b "\n20 25 0\n25 30 0\n30 35 0\n35 40 0\n40 45 " #c     \
    "\n45 50 " #d "\n50 55 0\n55 60 0\n"

static int load_corners(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "ADD t 0 0 4 0 4 4 0 4 3 1\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    return fd;
}

static void triangulate(int fd)
{
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
}

TEST(angles_that_cannot_be_measured)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = load_corners(&d);
    converse(&d, "QUALITY t\n", "ERR UNTRIANGULATED TRIANGULATE the set first\n");
    triangulate(fd);
    converse(
        &d,
        "QUALITY u\nQUALITY t 3\nQUALITY t INSIDE x\nQUALITY t INSIDE 1 2\nQUALITY t INSIDE\n"
        "CONSTRAIN t BORDER OF 5 0 4\nQUALITY t INSIDE 4\nQUALITY t INSIDE 5\n",
        "ERR NOSET there is no set u\n" USAGE USAGE USAGE
        "ERR NOREGION the set has no borders\nOK 0 added=1\n"
        "ERR NOREGION there is no border of number 4\nERR OPEN the border of number 5 is open\n");
    daemon_stop(&d, SIGTERM);
}

TEST(angles_of_all_triangles_and_of_those_inside_a_border)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = load_corners(&d);
    triangulate(fd);
    converse(&d, "QUALITY t\nCONSTRAIN t BORDER OF 2 RING 0 4 3\nQUALITY t INSIDE 2\n",
             "OK 12 triangles=4 area=16 angle=18.43494882292201 largest=116.56505117707799 "
             "shortest=1.4142135623730951 longest=4.242640687119285\n" UP_TO(
                 0, 2, 0, 2) "OK 0 added=3\n"
                             "OK 12 triangles=1 area=6 angle=45 largest=71.56505117707799 "
                             "shortest=3.1622776601683795 longest=4.242640687119285\n" UP_TO(0, 0,
                                                                                             0, 1));
    converse(&d, "CREATE u\nADD u 7 7\nDEL u 0\n",
             "OK 0\nOK 0 first=0 added=1 coincident=0\nOK 0 deleted=1\n");
    say(fd, "TRIANGULATE u\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=0 ", 14) == 0);
    converse(&d, "QUALITY u\n",
             "OK 12 triangles=0 area=0 angle=nan largest=nan shortest=nan longest=nan\n" UP_TO(
                 0, 0, 0, 0));
    daemon_stop(&d, SIGTERM);
}

enum { POINTS = 60000 }; /* a worker reads their triangles in several pieces */

/* Asks, and returns the status line. */
static const char *measure(int fd)
{
    static char line[300];
    say(fd, "QUALITY t\n");
    snprintf(line, sizeof line, "%s", hear_line(fd));
    for (int row = 0; row < 12; row++)
        hear_line(fd);
    return line;
}

/* Adds a point outside, or deletes it again. */
static void begin_edit(int fd, bool add, unsigned id)
{
    char text[100];
    snprintf(text, sizeof text, "DEL t %u\n", id);
    say(fd, add ? "ADD t 1000 0.5\n" : text);
}

TEST(angles_of_large_sets_are_of_one_moment_while_others_edit)
{
    enum { ROUNDS = 20 };
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    char want[2][300];
    bool seen[2] = {false, false};
    load_random(fd, "t", POINTS);
    triangulate(fd);
    for (int k = 0; k < 2; k++) { /* without and with the point, whose id grows by one each time */
        if (k == 1) {
            begin_edit(fd, true, 0);
            CHECK(strncmp(hear_line(fd), "OK 0 first=60000 ", 17) == 0);
        }
        snprintf(want[k], sizeof want[k], "%s", measure(fd));
    }
    CHECK(strcmp(want[0], want[1]) != 0);
    for (unsigned round = 0; round < ROUNDS; round++) {
        begin_edit(other, round % 2 == 1, POINTS + round / 2);
        const char *got = measure(fd);
        int k = strcmp(got, want[0]) == 0 ? 0 : 1;
        CHECK_STR(got, want[k]);
        seen[k] = true;
        CHECK(strncmp(hear_line(other), "OK ", 3) == 0);
    }
    CHECK(seen[0] && seen[1]);
    daemon_stop(&d, SIGTERM);
}
