/* volume_test.c - VOLUME: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char *const no_arguments[] = {NULL};

/* A square of side 4 with a peak of height 3. */
static int raise_peak(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "ADD t FIELDS z 0 0 0 4 0 0 4 4 0 0 4 0 2 2 3\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    return fd;
}

static void triangulate(int fd)
{
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
}

/* A load that fails gives the ids of its points back, but their vertices stay. */
TEST(volume_after_a_load_that_failed)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    triangulate(fd);
    say(fd, "LOAD t PATHS\n");
    for (int i = 0; i < 3000; i++) {
        char path[64];
        snprintf(path, sizeof path, "%d.%03d 0.5\n%d.%03d 0.6\n\n", i / 1000, i % 1000, i / 1000,
                 i % 1000);
        say(fd, path);
    }
    say(fd, "0 1\n4 1\n\n1 0.9\n1 1.1\n.\n");
    CHECK(strncmp(hear_line(fd), "ERR CROSSES ", 12) == 0);
    converse(&d, "VOLUME t z\n", "OK 0 above=16 below=0 area=16\n");
    daemon_stop(&d, SIGTERM);
}

#define USAGE                                                                                      \
    "ERR SYNTAX usage: VOLUME set field [LEVEL z | MINUS field] [INSIDE [k]] [MISSING nan|skip] "  \
    "[BOX x0 y0 x1 y1]\n"

TEST(volumes_that_cannot_be_answered)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    converse(&d, "VOLUME t z\n", "ERR UNTRIANGULATED TRIANGULATE the set first\n");
    triangulate(fd);
    converse(
        &d,
        "VOLUME u z\nVOLUME t y\nVOLUME t z MINUS y\nVOLUME t z LEVEL x\n"
        "VOLUME t z LEVEL 1e999\nVOLUME t z LEVEL nan\nVOLUME t z LEVEL\nVOLUME t z BASE 1\n"
        "VOLUME t z LEVEL 1 MINUS z\nVOLUME t z BOX 0 0 1\nVOLUME t z BOX 0 0 1 1 BOX 0 0 1 1\n"
        "VOLUME t z INSIDE\nVOLUME t z BOX 0 0 1 x\n",
        "ERR NOSET there is no set u\nERR NOFIELD there is no field y\n"
        "ERR NOFIELD there is no field y\nERR NUMBER x is not a number\n"
        "ERR RANGE a level is finite\nERR NUMBER nan is not a number\n" USAGE USAGE USAGE USAGE
            USAGE "ERR NOREGION the set has no borders\nERR NUMBER x is not a number\n");
    daemon_stop(&d, SIGTERM);
}

TEST(volumes_are_above_and_below_a_level_or_another_field)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    triangulate(fd);
    converse(&d,
             "VOLUME t z\nVOLUME t z LEVEL 1.5\nVOLUME t z LEVEL -1\nVOLUME t z MINUS z\n"
             "FSET t z 0 nan\nVOLUME t z\n",
             "OK 0 above=16 below=0 area=16\nOK 0 above=2 below=10 area=16\n"
             "OK 0 above=32 below=0 area=16\nOK 0 above=0 below=0 area=16\nOK 0\n"
             "OK 0 above=8 below=0 area=8\n");
    daemon_stop(&d, SIGTERM);
}

TEST(volumes_in_a_box_and_inside_borders)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    triangulate(fd);
    converse(&d,
             "VOLUME t z BOX 0 0 4 2\nVOLUME t z BOX 4 4 2 2 LEVEL 0\nVOLUME t z BOX 5 5 9 9\n"
             "VOLUME t z BOX 1 1 1 3\nCONSTRAIN t BORDER OF 7 RING 0 1 4\nVOLUME t z INSIDE\n"
             "VOLUME t z BOX 2 -9 9 9 INSIDE 7\nVOLUME t z INSIDE 8\n",
             "OK 0 above=8 below=0 area=8\nOK 0 above=4 below=0 area=4\n"
             "OK 0 above=0 below=0 area=0\nOK 0 above=0 below=0 area=0\nOK 0 added=3\n"
             "OK 0 above=4 below=0 area=4\nOK 0 above=2 below=0 area=2\n"
             "ERR NOREGION there is no border of number 8\n");
    daemon_stop(&d, SIGTERM);
}

TEST(volumes_of_a_set_with_constraints_are_those_of_its_triangles)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 0 4 -1 3 8 0 0 4 1 3\n"); /* the diagonal 1 3 is Delaunay */
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=4", 20) == 0);
    triangulate(fd);
    converse(&d, "VOLUME t z\nCONSTRAIN t 0 2\nVOLUME t z\n",
             "OK 0 above=16 below=0 area=8\nOK 0 added=1\nOK 0 above=8 below=0 area=8\n");
    daemon_stop(&d, SIGTERM);
}

enum { POINTS = 60000 };

/* Sends a change of all values to 1 or 2. */
static void send_values(int fd, double value)
{
    static double z[POINTS];
    char text[60];
    for (uint32_t i = 0; i < POINTS; i++)
        z[i] = value;
    snprintf(text, sizeof text, "FSETB t z 0 %d\n", POINTS);
    say(fd, text);
    say_bytes(fd, z, sizeof z);
}

/* A worker reads a large set in pieces: the volume is that of z = 1 or of z = 2, never a mixture. */
TEST(volumes_of_large_sets_are_of_one_moment_while_others_edit)
{
    enum { ROUNDS = 20 };
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    char want[2][200];
    bool seen[2] = {false, false};
    load_random(fd, "t", POINTS);
    triangulate(fd);
    for (int k = 0; k < 2; k++) {
        send_values(fd, k + 1);
        expect(fd, "OK 0\n");
        say(fd, "VOLUME t z\n");
        snprintf(want[k], sizeof want[k], "%s", hear_line(fd));
    }
    for (int round = 0; round < ROUNDS; round++) {
        send_values(other, round % 2 + 1);
        say(fd, "VOLUME t z\n");
        const char *got = hear_line(fd);
        int k = strcmp(got, want[0]) == 0 ? 0 : 1;
        CHECK_STR(got, want[k]);
        seen[k] = true;
        expect(other, "OK 0\n");
    }
    CHECK(seen[0] && seen[1]);
    daemon_stop(&d, SIGTERM);
}
