/* bands_test.c - CONTOUR ... BANDS: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

/* A square with a peak in its middle. */
static struct daemon start(int *fd)
{
    struct daemon d = daemon_start(no_arguments);
    *fd = daemon_connect(&d);
    say(*fd, "ADD t FIELDS z 0 0 0  4 0 0  4 4 0  0 4 0  2 2 4\nTRIANGULATE t\n");
    CHECK(strncmp(hear_line(*fd), "OK 0 first=0 added=5", 20) == 0);
    CHECK(strncmp(hear_line(*fd), "OK 0 points=5", 13) == 0);
    return d;
}

TEST(bands_are_polygons_with_holes)
{
    int fd;
    struct daemon d = start(&fd);
    converse(&d, "CONTOUR t z 1 2 BANDS\ncontour t z 2 1 2 bands\n",
             "OK 2\n1 2 0 outer 4 0.5 0.5 3.5 0.5 3.5 3.5 0.5 3.5\n1 2 0 hole 4 1 1 1 3 3 3 3 1\n"
             "OK 2\n1 2 0 outer 4 0.5 0.5 3.5 0.5 3.5 3.5 0.5 3.5\n1 2 0 hole 4 1 1 1 3 3 3 3 1\n");
    converse(&d, "CONTOUR t z -inf 2 inf BANDS\nCONTOUR t z inf 2 BANDS\nCONTOUR t z 2 BANDS\n",
             "OK 3\n-inf 2 0 outer 4 0 0 4 0 4 4 0 4\n-inf 2 0 hole 4 1 1 1 3 3 3 3 1\n"
             "2 inf 1 outer 4 1 1 3 1 3 3 1 3\n"
             "OK 1\n2 inf 0 outer 4 1 1 3 1 3 3 1 3\nOK 0\n");
    converse(&d, "CONTOUR t z EVERY 2 BANDS\nCONTOUR t z EVERY 10 BASE -5 BANDS\n",
             "OK 3\n0 2 0 outer 4 0 0 4 0 4 4 0 4\n0 2 0 hole 4 1 1 1 3 3 3 3 1\n"
             "2 4 1 outer 4 1 1 3 1 3 3 1 3\n"
             "OK 1\n-5 5 0 outer 4 0 0 4 0 4 4 0 4\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(bands_end_at_missing_values_long_edges_and_borders)
{
    int fd;
    struct daemon d = start(&fd);
    converse(&d, "CONTOUR t z 0 9 BANDS MAXEDGE 3\nCONTOUR t z 0 9 MAXEDGE 4 BANDS\n",
             "OK 0\nOK 1\n0 9 0 outer 4 0 0 4 0 4 4 0 4\n");
    converse(&d, "CONSTRAIN t BORDER RING 2 3 4\nCONTOUR t z 0 9 BANDS INSIDE\n",
             "OK 0 added=3\nOK 1\n0 9 0 outer 3 0 4 2 2 4 4\n");
    converse(&d, "FSET t z 0 nan\nCONTOUR t z 0 9 BANDS\n",
             "OK 0\nOK 1\n0 9 0 outer 4 0 4 2 2 4 0 4 4\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

#define USAGE                                                                                      \
    "ERR SYNTAX usage: CONTOUR set field level [level ...] [BANDS] [MAXEDGE e] [INSIDE [k]] "      \
    "[MISSING nan|skip] | "                                                                        \
    "CONTOUR set field EVERY step [BASE b] [BANDS] [MAXEDGE e] [INSIDE [k]] [MISSING nan|skip]\n"

TEST(requests_for_bands_that_cannot_be_answered)
{
    int fd;
    struct daemon d = start(&fd);
    converse(&d,
             "CONTOUR t z BANDS\nCONTOUR t z 1 2 BANDS BANDS\nCONTOUR t z 1 2 BANDS BINARY\n"
             "CONTOUR t z 1 BANDS 2\nCONTOUR t z 1 inf\nCONTOUR t z 1 1e999 BANDS\n"
             "CONTOUR t z nan 1 BANDS\nCONTOUR t y 1 2 BANDS\nCONTOUR u z 1 2 BANDS\n"
             "CONTOUR t z 1 2 BANDS INSIDE 3\nCONTOUR t z EVERY 1e-9 BANDS\n",
             USAGE USAGE USAGE USAGE "ERR NUMBER inf is not a number\n"
                                     "ERR RANGE a level is finite\n"
                                     "ERR NUMBER nan is not a number\n"
                                     "ERR NOFIELD there is no field y\n"
                                     "ERR NOSET there is no set u\n"
                                     "ERR NOREGION the set has no borders\n"
                                     "ERR RANGE more than 10000 levels\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(bands_in_resp_2_and_3)
{
    int fd;
    struct daemon d = start(&fd);
    say(fd, "*6\r\n$7\r\nCONTOUR\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n2\r\n$3\r\ninf\r\n$5\r\nBANDS\r\n");
    expect(fd, "*1\r\n$31\r\n2 inf 0 outer 4 1 1 3 1 3 3 1 3\r\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The words of a row, and its area; the outer ring comes first. */
static double read_ring(char *row, char **end, uint32_t *number, bool *hole)
{
    double area = 0, x0, y0, x, y;
    strtod(row, &row);
    strtod(row, &row);
    *number = (uint32_t)strtoul(row, &row, 10);
    *hole = strncmp(row, " hole ", 6) == 0;
    CHECK(*hole || strncmp(row, " outer ", 7) == 0);
    size_t n = strtoul(row + (*hole ? 6 : 7), &row, 10);
    CHECK(n >= 3);
    double first_x = x0 = strtod(row, &row), first_y = y0 = strtod(row, &row);
    for (size_t i = 1; i <= n; i++, x0 = x, y0 = y) {
        x = i < n ? strtod(row, &row) : first_x;
        y = i < n ? strtod(row, &row) : first_y;
        area += (x0 * y - x * y0) / 2;
    }
    CHECK(*row == '\n');
    *end = row + 1;
    return area;
}

/* Edits go on while workers trace: each reply tiles the surface as it was at one moment, which is always the square. */
TEST_TIMEOUT(bands_tile_the_surface_of_one_moment_while_points_move, 60)
{
    enum { N = 30000, ROUNDS = 4 };
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    char text[200];
    snprintf(text, sizeof text, "LOAD t %d FIELDS z\n", N + 4);
    say(fd, text);
    say(fd, "0 0 0.5\n1 0 0.5\n1 1 0.5\n0 1 0.5\n");
    for (int i = 0; i < N; i++) {
        snprintf(text, sizeof text, "%.9f %.9f %.2f\n", test_uniform(), test_uniform(),
                 test_uniform());
        say(fd, text);
    }
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0", 12) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=", 12) == 0);
    for (int round = 0; round < ROUNDS; round++) {
        say(fd, "CONTOUR t z EVERY 0.125 BANDS\nQUIT\n");
        for (int i = 0; i < 200; i++) {
            snprintf(text, sizeof text, "MOVE t %d %.9f %.9f\n", 4 + (int)test_below(N),
                     test_uniform(), test_uniform());
            say(other, text);
            CHECK(strncmp(hear_line(other), "OK", 2) == 0);
        }
        size_t all;
        char *reply = hear_all(fd, &all), *row = strchr(reply, '\n') + 1;
        CHECK(strncmp(reply, "OK ", 3) == 0);
        size_t rings = strtoul(reply + 3, NULL, 10);
        uint32_t number = 0, at = 0;
        double area = 0;
        bool hole;
        CHECK(rings > 1000);
        for (size_t i = 0; i < rings; i++) {
            double part = read_ring(row, &row, &at, &hole);
            CHECK(at == (hole || i == 0 ? number : number + 1));
            CHECK(hole ? part < 1e-15 : part > -1e-15);
            number = at;
            area += part;
        }
        CHECK_MSG(fabs(area - 1) < 1e-9, "%.17g", area);
        CHECK_STR(row, "OK 0\n");
        free(reply);
        close(fd);
        fd = daemon_connect(&d);
    }
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}
