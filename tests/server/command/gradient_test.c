/* gradient_test.c - GRADIENT, GRADIENTB and RASTER AS: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

/* A square of side 4 with a peak of height 2. */
static int raise_peak(const struct daemon *d)
{
    int fd = daemon_connect(d);
    say(fd, "ADD t FIELDS z 0 0 0 4 0 0 4 4 0 0 4 0 2 2 2\nTRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
    return fd;
}

#define USAGE                                                                                      \
    "ERR SYNTAX usage: GRADIENT set field x y [x y ...] [MAXEDGE e] [INSIDE [k]] [MISSING "        \
    "nan|skip]\n"
#define LINEAR "ERR SYNTAX slope and aspect are of the method linear and inside the hull\n"

TEST(gradients_that_cannot_be_answered)
{
    struct daemon d = daemon_start(no_arguments);
    raise_peak(&d);
    converse(&d,
             "GRADIENT t y 1 1\nGRADIENT t z 1 x\nGRADIENT t z 1 2 3\nGRADIENT t z MAXEDGE 3\n"
             "GRADIENT t z 1 1 METHOD linear\nGRADIENT t z 1 1 OUTSIDE nearest\n"
             "RASTER t z 0 0 4 4 2 2 AS slope METHOD natural\n"
             "RASTER t z 0 0 4 4 2 2 OUTSIDE nearest AS aspect\n",
             "ERR NOFIELD there is no field y\nERR NUMBER x is not a number\n"
             "ERR SYNTAX odd number of coordinates\n" USAGE USAGE USAGE LINEAR LINEAR);
    daemon_stop(&d, SIGTERM);
}

TEST(gradients_are_of_the_triangle_that_comes_first)
{
    struct daemon d = daemon_start(no_arguments);
    raise_peak(&d);
    converse(&d,
             "GRADIENT t z 2 1 1 2 3 2 2 3 5 5\nGRADIENT t z 2 2 1 1 4 4\n"
             "GRADIENT t z 2 1 MAXEDGE 3\nFSET t z 1 nan\nGRADIENT t z 2 1 1 2\n",
             "OK 5\n0 1\n1 0\n-1 0\n0 -1\nnan nan\nOK 3\n0 1\n0 1\n-1 0\nOK 1\nnan nan\nOK 0\n"
             "OK 2\nnan nan\n1 0\n");
    daemon_stop(&d, SIGTERM);
}

TEST(rasters_of_slopes_and_aspects)
{
    struct daemon d = daemon_start(no_arguments);
    raise_peak(&d);
    converse(&d,
             "RASTER t z 0 1 6 3 3 1 AS slope\nRASTER t z 0 1 6 3 3 1 AS aspect\n"
             "FSET t z 4 0\nRASTER t z 0 0 4 4 1 1 AS aspect\nRASTER t z 0 0 4 4 1 1 AS slope\n"
             "CONSTRAIN t BORDER OF 2 RING 0 1 4\nGRADIENT t z 2 1 2 3 INSIDE 2\n",
             "OK 1 columns=3\n45 45 nan\nOK 1 columns=3\n270 90 nan\nOK 0\nOK 1 columns=1\nnan\n"
             "OK 1 columns=1\n0\nOK 0 added=3\nOK 2\n0 0\nnan nan\n");
    daemon_stop(&d, SIGTERM);
}

TEST(gradients_of_a_body_in_both_framings)
{
    static const double q[][2] = {{2, 1}, {3, 2}}, want[][2] = {{0, 1}, {-1, 0}};
    double got[2][2];
    char tail[2];
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    say(fd, "GRADIENTB t z 2\n");
    say_bytes(fd, q, sizeof q);
    expect(fd, "OK 0 rows=2 bytes=32\n");
    hear_exactly(fd, got, sizeof got);
    CHECK(memcmp(got, want, sizeof got) == 0);
    say(fd, "*7\r\n$9\r\nGRADIENTB\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n2\r\n$7\r\nMAXEDGE\r\n$"
            "1\r\n9\r\n$32\r\n");
    say_bytes(fd, q, sizeof q);
    say(fd, "\r\n");
    expect(fd, "$32\r\n");
    hear_exactly(fd, got, sizeof got);
    CHECK(memcmp(got, want, sizeof got) == 0);
    hear_exactly(fd, tail, 2);
    daemon_stop(&d, SIGTERM);
}

enum { PLACES = 40000 };

/* The numbers of a large body are made in pieces: those of each place are together. */
TEST(gradients_of_many_places_are_those_of_each)
{
    static double q[PLACES][2], got[PLACES][2];
    struct daemon d = daemon_start(no_arguments);
    int fd = raise_peak(&d);
    char text[100];
    for (int i = 0; i < PLACES; i++) {
        q[i][0] = i % 2 == 0 ? 2 : 1;
        q[i][1] = i % 2 == 0 ? 1 : 2;
    }
    snprintf(text, sizeof text, "GRADIENTB t z %d\n", PLACES);
    say(fd, text);
    say_bytes(fd, q, sizeof q);
    snprintf(text, sizeof text, "OK 0 rows=%d bytes=%d\n", PLACES, 16 * PLACES);
    expect(fd, text);
    hear_exactly(fd, got, sizeof got);
    for (int i = 0; i < PLACES; i++)
        CHECK(got[i][0] == i % 2 && got[i][1] == 1 - i % 2);
    daemon_stop(&d, SIGTERM);
}

/* A number beyond the largest double is written as a word, in both framings. */
TEST(slopes_and_volumes_beyond_the_largest_double_are_infinite)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 1e308 0.5 0 -1e308 0 1 0\nADD u FIELDS z 0 0 1e308 1e30 0 0 0 1 0\n"
            "TRIANGULATE t\nTRIANGULATE u\n");
    for (int i = 0; i < 4; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    say(fd, "GRADIENT t z 0.1 0.1\n");
    expect(fd, "OK 1\n-inf -1e+308\n");
    say(fd, "VOLUME u z\n");
    expect(fd, "OK 0 above=inf below=0 area=5e+29\n");
    say(fd, "*5\r\n$8\r\nGRADIENT\r\n$1\r\nt\r\n$1\r\nz\r\n$3\r\n0.1\r\n$3\r\n0.1\r\n");
    expect(fd, "*1\r\n$12\r\n-inf -1e+308\r\n");
    daemon_stop(&d, SIGTERM);
}
