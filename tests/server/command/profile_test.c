/* profile_test.c - PROFILE: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

/* A square of side 4 with a peak of height 2. */
static int raise_peak(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "ADD t FIELDS z 0 0 0 4 0 0 4 4 0 0 4 0 2 2 2\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    return fd;
}

static void triangulate(int fd)
{
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
}

#define USAGE                                                                                      \
    "ERR SYNTAX usage: PROFILE set field x0 y0 x1 y1 [x y ...] [MAXEDGE e] [INSIDE [k]] [MISSING " \
    "nan|skip] "                                                                                   \
    "[BINARY]\n"

TEST(profiles_that_cannot_be_answered)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    converse(&d, "PROFILE t z 0 0 1 1\n", "ERR UNTRIANGULATED TRIANGULATE the set first\n");
    triangulate(fd);
    converse(
        &d,
        "PROFILE u z 0 0 1 1\nPROFILE t y 0 0 1 1\nPROFILE t z 0 0 1 x\nPROFILE t z 0 0 1 1e99\n"
        "PROFILE t z 0 0 1 1 2\nPROFILE t z 0 0\nPROFILE t z 0 0 BINARY BINARY\n"
        "PROFILE t z 0 0 1 1 METHOD linear\nPROFILE t z 0 0 1 1 INSIDE\n",
        "ERR NOSET there is no set u\nERR NOFIELD there is no field y\n"
        "ERR NUMBER x is not a number\n"
        "ERR RANGE a coordinate is 0 or has a magnitude from 2^-142 to 2^201\n"
        "ERR SYNTAX odd number of coordinates\n" USAGE USAGE USAGE
        "ERR NOREGION the set has no borders\n");
    daemon_stop(&d, SIGTERM);
}

TEST(profiles_have_their_places_and_the_edges_between)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    triangulate(fd);
    converse(&d, "PROFILE t z -1 1 5 1\nPROFILE t z 1 1 3 3 3 5\nPROFILE t z 1 0 3 0 MAXEDGE 3\n",
             "OK 6\n0 -1 1 nan\n1 0 1 0\n2 1 1 1\n4 3 1 1\n5 4 1 0\n6 5 1 nan\n"
             "OK 5\n0 1 1 1\n1.4142135623730951 2 2 2\n2.8284271247461903 3 3 1\n"
             "3.8284271247461903 3 4 0\n4.82842712474619 3 5 nan\n"
             "OK 2\n0 1 0 nan\n2 3 0 nan\n");
    daemon_stop(&d, SIGTERM);
}

TEST(profiles_follow_constraints_and_end_at_borders)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 0 4 -1 3 8 0 0 4 1 3\n"); /* the diagonal 1 3 is Delaunay */
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=4", 20) == 0);
    triangulate(fd);
    converse(&d,
             "PROFILE t z 4 -2 4 2\nCONSTRAIN t BORDER OF 7 RING 0 1 2\nPROFILE t z 4 -2 4 2\n"
             "PROFILE t z 3 -2 3 2 INSIDE 7\nPROFILE t z 4 0 4 2 INSIDE 8\n",
             "OK 4\n0 4 -2 nan\n1 4 -1 3\n3 4 1 3\n4 4 2 nan\nOK 0 added=3\n"
             "OK 5\n0 4 -2 nan\n1 4 -1 3\n2 4 0 0\n3 4 1 3\n4 4 2 nan\n"
             "OK 5\n0 3 -2 nan\n1.25 3 -0.75 2.25\n2 3 0 0\n2.75 3 0.75 nan\n4 3 2 nan\n"
             "ERR NOREGION there is no border of number 8\n");
    daemon_stop(&d, SIGTERM);
}

TEST(profiles_in_both_framings_and_in_binary)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    double row[3][4];
    static const double want[3][4] = {{0, 0, 1, 0}, {1, 1, 1, 1}, {2, 2, 1, 1}};
    triangulate(fd);
    say(fd, "PROFILE t z 0 1 2 1 BINARY\n");
    expect(fd, "OK 0 rows=3 bytes=96\n");
    hear_exactly(fd, row, sizeof row);
    CHECK(memcmp(row, want, sizeof row) == 0);
    say(fd, "*7\r\n$7\r\nPROFILE\r\n$1\r\nt\r\n$1\r\nz\r\n$2\r\n-1\r\n$1\r\n1\r\n$1\r\n1\r\n$"
            "1\r\n1\r\n");
    expect(fd, "*3\r\n$10\r\n0 -1 1 nan\r\n");
    daemon_stop(&d, SIGTERM);
}

enum { POINTS = 60000 };

/* Reads a reply of rows and returns the sum of their values; *n counts them. */
static double sum_of_values(int fd, size_t *n)
{
    double sum = 0;
    *n = strtoul(hear_line(fd) + 3, NULL, 10);
    for (size_t i = 0; i < *n; i++) {
        double distance, x, y, value;
        CHECK(sscanf(hear_line(fd), "%lf %lf %lf %lf", &distance, &x, &y, &value) == 4);
        sum += value;
    }
    return sum;
}

/* All values are 1 or 2 at a time. */
TEST(long_profiles_are_of_one_moment_while_others_edit)
{
    enum { ROUNDS = 20 };
    static double z[POINTS];
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    bool seen[2] = {false, false};
    size_t n, first = 0;
    load_random(fd, "t", POINTS);
    triangulate(fd);
    for (int round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < POINTS; i++)
            z[i] = round % 2 + 1;
        char text[60];
        snprintf(text, sizeof text, "FSETB t z 0 %d\n", POINTS);
        say(round == 0 ? fd : other, text);
        say_bytes(round == 0 ? fd : other, z, sizeof z);
        if (round == 0)
            expect(fd, "OK 0\n");
        say(fd, "PROFILE t z 0.1 0.1 0.9 0.9 0.9 0.1 0.1 0.9\n");
        double mean = sum_of_values(fd, &n) / (double)n;
        first = round == 0 ? n : first;
        CHECK_MSG(n > 500 && n == first && (mean == 1 || mean == 2), "%zu rows, mean %g", n, mean);
        seen[mean == 1 ? 0 : 1] = true;
        if (round > 0)
            expect(other, "OK 0\n");
    }
    CHECK(seen[0] && seen[1]);
    daemon_stop(&d, SIGTERM);
}
