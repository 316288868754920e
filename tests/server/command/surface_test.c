/* surface_test.c - INTERPOLATE, RASTER and CONTOUR: what clients see. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

/* A set t of n random points with a field z, triangulated. */
static struct daemon start(int *fd, uint32_t n)
{
    struct daemon d = daemon_start(no_arguments);
    char text[100];
    *fd = daemon_connect(&d);
    load_random(*fd, "t", n);
    for (uint32_t i = 0; i < n; i++) {
        snprintf(text, sizeof text, "FSET t z %u %.3f\n", i, test_uniform());
        say(*fd, text);
        expect(*fd, "OK 0\n");
    }
    say(*fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(*fd), "OK 0 points=", 12) == 0);
    return d;
}

/* n bytes; the caller frees them. */
static char *hear_array(int fd, size_t n)
{
    char *bytes = malloc(n + 1);
    CHECK(bytes != NULL);
    hear_exactly(fd, bytes, n);
    return bytes;
}

/* The values of a raster of the unit square. */
static double *raster(int fd, uint32_t columns, uint32_t rows, const char *method)
{
    char text[200], want[100];
    size_t bytes = 8 * (size_t)columns * rows;
    snprintf(text, sizeof text, "RASTER t z 0 0 1 1 %u %u METHOD %s BINARY\n", columns, rows,
             method);
    say(fd, text);
    snprintf(want, sizeof want, "OK 0 rows=%u columns=%u bytes=%zu", rows, columns, bytes);
    CHECK_STR(hear_line(fd), want);
    return (double *)(void *)hear_array(fd, bytes);
}

static bool is_same(const double *a, const double *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) == 0;
}

#define INTERPOLATE_USAGE                                                                          \
    "ERR SYNTAX usage: INTERPOLATE set field x y [x y ...] "                                       \
    "[METHOD linear|natural|laplace|nearest|smooth] [MAXEDGE e] [INSIDE [k]] [MISSING nan|skip] "  \
    "[OUTSIDE "                                                                                    \
    "nan|nearest]\n"
#define RASTER_USAGE                                                                               \
    "ERR SYNTAX usage: RASTER set field x0 y0 x1 y1 columns rows "                                 \
    "[METHOD linear|natural|laplace|nearest|smooth] [MAXEDGE e] [INSIDE [k]] [MISSING nan|skip] "  \
    "[OUTSIDE "                                                                                    \
    "nan|nearest] "                                                                                \
    "[CLIP other] [AS slope|aspect] [BINARY]\n"
#define CONTOUR_USAGE                                                                              \
    "ERR SYNTAX usage: CONTOUR set field level [level ...] [BANDS] [MAXEDGE e] [INSIDE [k]] "      \
    "[MISSING nan|skip] | "                                                                        \
    "CONTOUR set field EVERY step [BASE b] [BANDS] [MAXEDGE e] [INSIDE [k]] [MISSING nan|skip]\n"

TEST(surface_requests_that_cannot_be_answered)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d, "ADD t 0 0 4 0 4 4 0 4\nFSET t z 0 1 1 3\nINTERPOLATE t z 1 1\n",
             "OK 0 first=0 added=4 coincident=0\nOK 0\n"
             "ERR UNTRIANGULATED TRIANGULATE the set first\n");
    int fd = daemon_connect(&d);
    say(fd, "TRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 points=4", 13) == 0);
    converse(&d,
             "INTERPOLATE t z 1\nINTERPOLATE t z 1 2 3\nINTERPOLATE t z METHOD linear\n"
             "INTERPOLATE t z 1 x\nINTERPOLATE t z 1 2 METHOD\nINTERPOLATE t z 1 2 METHOD cubic\n"
             "INTERPOLATE t z 1 2 BINARY\nINTERPOLATE t z 1 2 MAXEDGE -1\nINTERPOLATE u z 1 2\n"
             "INTERPOLATE t y 1 2\nRASTER t z 0 0 1 1 1\nRASTER t z 0 0 1 1 1 x\n"
             "RASTER t z 0 0 1 1 65537 1\nRASTER t z 0 0 1 1 65536 65536\n"
             "CONTOUR t z 1 BINARY\nCONTOUR t z 1 EVERY 1\nCONTOUR t z EVERY 1 BASE\n"
             "CONTOUR t z x\nCONTOUR t z 1e999\nCONTOUR t z EVERY -1\nCONTOUR t z EVERY 1e-300\n"
             "CONTOUR t z\nCONTOUR t z EVERY 1e-4\nINTERPOLATE t z 1 2 OUTSIDE\n"
             "INTERPOLATE t z 1 2 OUTSIDE far\nCONTOUR t z 1 OUTSIDE nan\n"
             "RASTER t z 0 0 1 1 1 1 OUTSIDE nan OUTSIDE nearest\n",
             INTERPOLATE_USAGE
             "ERR SYNTAX odd number of coordinates\n" INTERPOLATE_USAGE
             "ERR NUMBER x is not a number\n" INTERPOLATE_USAGE INTERPOLATE_USAGE INTERPOLATE_USAGE
             "ERR RANGE a length is not negative\n"
             "ERR NOSET there is no set u\n"
             "ERR NOFIELD there is no field y\n" RASTER_USAGE
             "ERR NUMBER x is not a number of rows\n"
             "ERR RANGE a raster has 1 to 65536 columns and rows\n"
             "ERR TOOBIG a raster has at most 134217728 cells\n" CONTOUR_USAGE CONTOUR_USAGE
                 CONTOUR_USAGE "ERR NUMBER x is not a number\n"
             "ERR RANGE a level is finite\n"
             "ERR RANGE a step is greater than 0\n"
             "ERR RANGE more than 10000 levels\n" CONTOUR_USAGE
             "ERR RANGE more than 10000 levels\n" INTERPOLATE_USAGE INTERPOLATE_USAGE CONTOUR_USAGE
                 RASTER_USAGE);
    daemon_stop(&d, SIGTERM);
}

TEST(surface_goes_on_beyond_the_hull)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 1 4 0 2 4 4 3 0 4 4 2 2 9\nTRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=5", 13) == 0);
    converse(&d,
             "INTERPOLATE t z 5 2 -1 9 2 2 OUTSIDE nearest\n"
             "INTERPOLATE t z 5 1 METHOD nearest OUTSIDE nearest\n"
             "INTERPOLATE t z 5 2 MAXEDGE 3 OUTSIDE nearest INSIDE\n"
             "INTERPOLATE t z 5 2 MAXEDGE 3 OUTSIDE nearest\nINTERPOLATE t z 5 2 OUTSIDE nan\n"
             "RASTER t z -4 0 8 4 2 2 OUTSIDE nearest\n",
             "OK 3\n2.5\n4\n9\nOK 1\n2\nERR NOREGION the set has no borders\nOK 1\nnan\nOK 1\nnan\n"
             "OK 2 columns=2\n3.25 2.75\n1.75 2.25\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(surface_requests_with_extreme_numbers)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 1 4 0 2 4 4 3 0 4 4 2 2 9\nTRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=5", 20) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=5", 13) == 0);
    converse(&d,
             "RASTER t z nan 0 1 1 2 2\nRASTER t z 0 0 inf 1 2 2\nRASTER t z 1 1 1 1 2 1\n"
             "RASTER t z 2 0 2 4 2 2\nRASTER t z 0 0 4 4 4294967296 1\nRASTER t z 0 0 4 4 -1 1\n"
             "RASTER t z 0 0 4 4 65536 2049\nRASTER t z 0 0 4 4 2 1 MAXEDGE 0\n"
             "RASTER t z 0 0 4 4 2 1 MAXEDGE nan\nRASTER t z 0 0 4 4 2 1 MAXEDGE 1e-300\n"
             "RASTER t z -3e60 -3e60 3e60 3e60 2 1\nRASTER t z 1e-50 0 1 1 2 1\n"
             "INTERPOLATE t z 2 2 1 1 MAXEDGE 0\nCONTOUR t z EVERY 1e300 BASE 1e300\n"
             "CONTOUR t z EVERY 5e-324\nCONTOUR t z nan\n",
             "ERR NUMBER nan is not a number\nERR NUMBER inf is not a number\n"
             "OK 1 columns=2\n5 5\nOK 2 columns=2\n6.25 6.25\n5.25 5.25\n"
             "ERR NUMBER 4294967296 is not a number of columns\n"
             "ERR NUMBER -1 is not a number of columns\n"
             "ERR TOOBIG a raster has at most 134217728 cells\nOK 1 columns=2\nnan nan\n"
             "ERR NUMBER nan is not a number\n"
             "ERR RANGE a length is 0 or has a magnitude from 2^-142 to 2^201\n"
             "OK 1 columns=2\nnan nan\n"
             "ERR RANGE a coordinate is 0 or has a magnitude from 2^-142 to 2^201\n"
             "OK 2\n9\nnan\nOK 0\nERR RANGE more than 10000 levels\n"
             "ERR NUMBER nan is not a number\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(raster_is_completed_for_a_client_that_sends_nothing_more)
{
    enum { SIDE = 600 };
    int fd, other;
    struct daemon d = start(&fd, 100);
    double *want = raster(fd, SIDE, SIDE, "linear");
    other = daemon_connect(&d);
    say(other, "RASTER t z 0 0 1 1 600 600 BINARY\n");
    CHECK(shutdown(other, SHUT_WR) == 0);
    CHECK(strncmp(hear_line(other), "OK 0 rows=600", 13) == 0);
    double *got = (double *)(void *)hear_array(other, 8 * SIDE * SIDE);
    CHECK(is_same(got, want, SIDE * SIDE));
    char more;
    CHECK(read(other, &more, 1) == 0);
    free(want);
    free(got);
}

/* A gigabyte each, of which the clients read a little. */
TEST(clients_that_disconnect_during_a_raster_leave_the_set_free)
{
    enum { CLIENTS = 10 };
    int fd, other[CLIENTS];
    struct daemon d = start(&fd, 100);
    for (int i = 0; i < CLIENTS; i++) {
        other[i] = daemon_connect(&d);
        say(other[i], "RASTER t z 0 0 1 1 16384 8192 BINARY\n");
        CHECK(strncmp(hear_line(other[i]), "OK 0 rows=8192", 14) == 0);
    }
    say(fd, "MOVE t 3 0.5 0.5\nFDROP t z\nDROP t\nSETS\n");
    for (int i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    expect(fd, "OK 0\n");
    for (int i = 0; i < CLIENTS; i++)
        close(other[i]);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(raster_as_text_has_the_values_of_the_binary_one)
{
    int fd;
    start(&fd, 300);
    double *value = raster(fd, 70, 30, "natural");
    say(fd, "RASTER t z 1 1 0 0 70 30 METHOD natural\n");
    CHECK_STR(hear_line(fd), "OK 30 columns=70");
    for (size_t row = 0; row < 30; row++) {
        char *at = (char *)(uintptr_t)hear_line(fd);
        for (size_t i = 0; i < 70; i++) {
            double got = strtod(at, &at), want = value[70 * row + i];
            CHECK_MSG(got == want || (isnan(got) && isnan(want)), "%.17g, not %.17g", got, want);
        }
        CHECK(*at == '\0');
    }
    free(value);
}

TEST(interpolation_of_many_places_has_the_values_of_a_raster)
{
    int fd;
    char *text = malloc(100000), *to = text;
    start(&fd, 300);
    for (int method = 0; method < 4; method++) {
        static const char *const names[] = {"linear", "natural", "laplace", "nearest"};
        double *value = raster(fd, 64, 8, names[method]);
        to = text + sprintf(text, "INTERPOLATE t z");
        for (int i = 0; i < 512; i++)
            to += sprintf(to, " %.17g %.17g", (2 * (i % 64) + 1) / 128.0,
                          1 - (2 * (i / 64) + 1) / 16.0);
        sprintf(to, " METHOD %s\n", names[method]);
        say(fd, text);
        CHECK_STR(hear_line(fd), "OK 512");
        for (int i = 0; i < 512; i++) {
            double got = strtod(hear_line(fd), NULL);
            CHECK(got == value[i] || (isnan(got) && isnan(value[i])));
        }
        free(value);
    }
    free(text);
}

/* Their values by INTERPOLATEB. */
static double *interpolate(int fd, const double *xy, size_t n, const char *method)
{
    char text[200], want[100];
    snprintf(text, sizeof text, "INTERPOLATEB t z %zu MAXEDGE 10 METHOD %s\n", n, method);
    say(fd, text);
    say_bytes(fd, xy, 16 * n);
    snprintf(want, sizeof want, "OK 0 rows=%zu bytes=%zu", n, 8 * n);
    CHECK_STR(hear_line(fd), want);
    return (double *)(void *)hear_array(fd, 8 * n);
}

TEST(places_in_binary_have_the_values_of_a_raster)
{
    enum { COLUMNS = 128, ROWS = 64, N = COLUMNS * ROWS };
    static double xy[2 * N];
    int fd;
    start(&fd, 300);
    for (int i = 0; i < N; i++) {
        xy[2 * i] = (2 * (i % COLUMNS) + 1) / (2.0 * COLUMNS);
        xy[2 * i + 1] = 1 - (2 * (i / COLUMNS) + 1) / (2.0 * ROWS);
    }
    for (int few = 0; few < 2; few++) {
        size_t n = few ? 50 : N;
        double *value = raster(fd, COLUMNS, ROWS, "laplace"),
               *got = interpolate(fd, xy, n, "laplace");
        CHECK(is_same(got, value, n));
        free(value);
        free(got);
    }
}

TEST(places_in_binary_that_cannot_be_answered)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             "ADD t 0 0 4 0 4 4 0 4\nFSET t z 0 1 1 3\nTRIANGULATE u\n"
             "INTERPOLATEB t z 1\nABCDEFG@ABCDEFG@PING\n"
             "INTERPOLATEB t z 0 METHOD linear\nPING\n"
             "INTERPOLATEB t y 1\nABCDEFG@ABCDEFG@PING\n"
             "INTERPOLATEB t z x\nPING\n",
             "OK 0 first=0 added=4 coincident=0\nOK 0\n"
             "ERR NOSET there is no set u\n"
             "ERR UNTRIANGULATED TRIANGULATE the set first\nOK 0\n"
             "ERR UNTRIANGULATED TRIANGULATE the set first\nOK 0\n"
             "ERR UNTRIANGULATED TRIANGULATE the set first\nOK 0\n"
             "ERR NUMBER x is not a number of points\n");
}

TEST(levels_at_equal_steps_include_the_one_that_equals_the_greatest_value)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z 0 0 0  1 0 1.29  0 1 1.29\nTRIANGULATE t\n");
    hear_line(fd);
    hear_line(fd);
    say(fd, "CONTOUR t z EVERY 0.01 BASE 0.1\n");
    CHECK_STR(hear_line(fd), "OK 129"); /* the level 3.5e-18 is a place, not a line */
    for (int i = 0; i < 128; i++)
        hear_line(fd);
    CHECK_STR(hear_line(fd), "1.29 open 2 0 1 1 0");
    converse(&d, "CONTOUR t z EVERY 0.75 BASE 1e17\n",
             "OK 2\n0.25 open 2 0 0.1937984496124031 0.1937984496124031 0\n"
             "1 open 2 0 0.7751937984496124 0.7751937984496124 0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(contours_as_rows_end_where_their_count_says)
{
    int fd;
    start(&fd, 2000);
    say(fd, "CONTOUR t z EVERY 0.01\nPING\nQUIT\n");
    size_t all;
    char *text = hear_all(fd, &all), *row = text;
    CHECK(strncmp(text, "OK ", 3) == 0);
    size_t lines = strtoul(text + 3, NULL, 10), closed = 0;
    CHECK(lines > 1000);
    double before = 0;
    for (size_t i = 0; i < lines; i++) {
        char *kind, *count;
        size_t words = 0;
        row = strchr(row, '\n') + 1;
        double level = strtod(row, &kind);
        bool is_closed = strncmp(kind, " closed ", 8) == 0;
        CHECK(level >= before && (is_closed || strncmp(kind, " open ", 6) == 0));
        size_t n = strtoul(strchr(kind + 1, ' '), &count, 10);
        CHECK(n >= 2 && *count == ' ');
        closed += is_closed;
        for (const char *c = row; *c != '\n'; c++)
            words += *c == ' ';
        CHECK(words == 2 + 2 * n);
        before = level;
    }
    CHECK(closed > 100);
    CHECK_STR(strchr(row, '\n') + 1, "OK 0\nOK 0\n");
    free(text);
}

/* A point moves back and forth all the time: every raster is of one of the two states. */
TEST_TIMEOUT(raster_is_of_one_state_while_points_move, 60)
{
    enum { SIDE = 220 };
    int fd, other;
    struct daemon d = start(&fd, 500);
    other = daemon_connect(&d);
    say(other, "MOVE t 7 0.5 0.5\n");
    CHECK(strncmp(hear_line(other), "OK", 2) == 0);
    double *here = raster(fd, SIDE, SIDE, "natural");
    say(other, "MOVE t 7 0.25 0.625\n");
    CHECK(strncmp(hear_line(other), "OK", 2) == 0);
    double *there = raster(fd, SIDE, SIDE, "natural");
    CHECK(!is_same(here, there, SIDE * SIDE));
    for (int round = 0; round < 6; round++) {
        char text[200];
        snprintf(text, sizeof text, "RASTER t z 0 0 1 1 %d %d METHOD natural BINARY\n", SIDE, SIDE);
        say(fd, text);
        for (int i = 0; i < 50; i++) {
            say(other, i % 2 == 0 ? "MOVE t 7 0.5 0.5\n" : "MOVE t 7 0.25 0.625\n");
            CHECK(strncmp(hear_line(other), "OK", 2) == 0);
        }
        CHECK(strncmp(hear_line(fd), "OK 0 rows=", 10) == 0);
        double *got = (double *)(void *)hear_array(fd, 8 * SIDE * SIDE);
        CHECK(is_same(got, here, SIDE * SIDE) || is_same(got, there, SIDE * SIDE));
        free(got);
    }
    free(here);
    free(there);
}

TEST(surfaces_in_resp)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 4 0 0 4\nFSET t z 0 1 1 2 2 3\nTRIANGULATE t\n");
    for (int i = 0; i < 3; i++)
        CHECK(strncmp(hear_line(fd), "OK", 2) == 0);
    say(fd, "*5\r\n$11\r\ninterpolate\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n2\r\n$1\r\n0\r\n");
    expect(fd, "*1\r\n$3\r\n1.5\r\n");
    say(fd, "*5\r\n$12\r\nINTERPOLATEB\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n1\r\n$16\r\n");
    say_bytes(fd, (const double[]){2, 0}, 16);
    say(fd, "\r\n");
    expect(fd, "$8\r\n");
    double got;
    CHECK(read(fd, &got, 8) == 8 && got == 1.5);
    expect(fd, "\r\n");
    say(fd, "*4\r\n$7\r\nCONTOUR\r\n$1\r\nt\r\n$1\r\nz\r\n$3\r\n2.5\r\n");
    expect(fd, "*1\r\n$18\r\n2.5 open 2 0 3 2 2\r\n");
}

TEST(several_fields_have_their_values_side_by_side)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z,s 0 0 0 1 4 0 0 nan 4 4 8 2 0 4 8 3 2 2 nan 5\nTRIANGULATE t\n");
    CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0 && strncmp(hear_line(fd), "OK 0", 4) == 0);
    converse(
        &d,
        "INTERPOLATE t z,s 1 0 2 2 0 2\nINTERPOLATE t s,z,s 1 0 2 2 METHOD nearest\n"
        "RASTER t s,z 0 0 4 4 2 2\nGRADIENT t s,z 1 1\nRASTER t s,z 0 0 4 4 1 2 AS slope\n"
        "INTERPOLATE t z,s 1 0 MISSING skip\nINTERPOLATE t z,q 1 0\n"
        "RASTER t z,s 0 0 4 4 65536 9000\n",
        "OK 3 fields=2\n0 nan\nnan 5\n4 2\nOK 2 fields=3\n1 0 1\n5 nan 5\n"
        "OK 2 columns=2 fields=2\n4 nan 3.5 nan\n3 nan nan nan\n"
        "OK 1 fields=2\nnan nan nan nan\nOK 2 columns=1 fields=2\n51.88707349901337 nan\nnan nan\n"
        "ERR SYNTAX MISSING skip is for one field\nERR NOFIELD there is no field q\n"
        "ERR TOOBIG a raster has at most 134217728 values\n");
    daemon_stop(&d, SIGTERM);
}
