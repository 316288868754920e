/* fields_test.c - FSET, FGET, FIELDS and FDROP: replies, and the state after a restart. */
#include "tests/server/directory.h"
#include "tests/test.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const char *const no_arguments[] = {NULL};

TEST(values_are_set_and_read_and_nan_takes_one_away)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             "ADD t 0 0 1 0 0 1 1 0\n"
             "FSET t z 0 1.5 3 -2e10 1 0\n"
             "FGET t z 3 1 2 1\n"
             "FIELDS t\n"
             "FSET t z 3 NaN 1 2 1 -0\n"
             "FSET t _.:-9 2 nan\n"
             "FGET t z 1 3\n"
             "FIELDS t\n"
             "FDROP t z\n"
             "FIELDS t\n"
             "FGET t z 1\n",
             "OK 0 first=0 added=4 coincident=1\n"
             "OK 0\n"
             "OK 4\n3 -20000000000\n1 0\n2 nan\n1 0\n"
             "OK 1\nz 3 -20000000000 1.5\n"
             "OK 0\n"
             "OK 0\n"
             "OK 2\n1 0\n3 nan\n"
             "OK 2\n_.:-9 0 nan nan\nz 2 0 1.5\n"
             "OK 0\n"
             "OK 1\n_.:-9 0 nan nan\n"
             "ERR NOFIELD there is no field z\n");
    daemon_stop(&d, SIGTERM);
}

TEST(value_that_cannot_be_set_sets_none)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             "ADD t 0 0 1 0 0 1\nDEL t 1\n"
             "FSET t z 0 1 1 2\nFSET t z 0 1 7 2\nFSET t z 0 1 2 1e999\nFSET t z 0 1 2 x\n"
             "FSET t z 0 1 2\nFSET t 9 0 1\nFSET t z/y 0 1\nFSET u z 0 1\nFSET t z -1 1\n"
             "FIELDS t\nFIELDS u\nFDROP t 9\nFDROP t z\nFGET t z 0\n",
             "OK 0 first=0 added=3 coincident=0\nOK 0 deleted=1\n"
             "ERR NOPOINT there is no point 1; no value was set\n"
             "ERR NOPOINT there is no point 7; no value was set\n"
             "ERR RANGE a value is a finite number, or nan\n"
             "ERR NUMBER x is not a number\n"
             "ERR SYNTAX an id without a value\n"
             "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a "
             "letter or _\n"
             "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a "
             "letter or _\n"
             "ERR NOSET there is no set u\n"
             "ERR NUMBER -1 is not an id\n"
             "OK 0\nERR NOSET there is no set u\n"
             "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a "
             "letter or _\n"
             "ERR NOFIELD there is no field z\n"
             "ERR NOFIELD there is no field z\n");
    daemon_stop(&d, SIGTERM);
}

TEST(values_move_with_their_points_and_go_with_them)
{
    struct daemon d = daemon_start(no_arguments);
    carry_out(&d,
              "ADD t 0 0 1 0 0 1 1 1\nTRIANGULATE t\nFSET t z 0 10 1 11 2 12 3 13\n"
              "MOVE t 1 0 0\nMOVE t 0 5 5\nTRIANGULATE t METHOD shelling\nDEL t 2\nADD t 0 1\n");
    converse(&d, "FGET t z 0 1 3 4\nFIELDS t\n",
             "OK 4\n0 10\n1 11\n3 13\n4 nan\nOK 1\nz 3 10 13\n");
    daemon_stop(&d, SIGTERM);
}

TEST(set_has_no_65th_field)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    char line[100];
    say(fd, "ADD t 0 0\n");
    expect(fd, "OK 0 first=0 added=1 coincident=0\n");
    for (int i = 0; i < 64; i++) {
        snprintf(line, sizeof line, "FSET t f%d 0 %d\n", i, i);
        say(fd, line);
        expect(fd, "OK 0\n");
    }
    say(fd, "FSET t f64 0 1\nFSET t f63 0 1\nFDROP t f1\nFSET t f64 0 1\n");
    expect(fd, "ERR TOOBIG a set has at most 64 fields\nOK 0\nOK 0\nOK 0\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(values_in_resp)
{
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd,
        "ADD t 0 0 1 0\n"
        "*7\r\n$4\r\nFSET\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n0\r\n$3\r\n1.5\r\n$1\r\n1\r\n$3\r\nnan\r\n"
        "*5\r\n$4\r\nFGET\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n1\r\n$1\r\n0\r\n"
        "*2\r\n$6\r\nFIELDS\r\n$1\r\nt\r\n"
        "*3\r\n$5\r\nFDROP\r\n$1\r\nt\r\n$1\r\ny\r\n"
        "*3\r\n$5\r\nFDROP\r\n$1\r\nt\r\n$1\r\nz\r\n");
    expect(fd, "OK 0 first=0 added=2 coincident=0\n+OK\r\n*2\r\n$5\r\n1 nan\r\n$5\r\n0 1.5\r\n"
               "*1\r\n$11\r\nz 1 1.5 1.5\r\n-NOFIELD there is no field y\r\n+OK\r\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

/* ---- many values at once ---- */

/* Sends the head and n doubles. */
static void say_values(int fd, const char *head, const double *v, size_t n)
{
    say(fd, head);
    say_bytes(fd, v, n * sizeof *v);
}

TEST(column_of_values_is_set_at_once)
{
    static const double good[] = {1.5, (double)NAN, -3}, bad[] = {1, (double)INFINITY, 3};
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 1 0 0 1 1 1\nDEL t 2\n");
    expect(fd, "OK 0 first=0 added=4 coincident=0\nOK 0 deleted=1\n");
    say_values(fd, "FSETB t z 1 3\n", good, 3);
    say(fd, "FGET t z 0 1 3\n");
    expect(fd, "OK 0\nOK 3\n0 nan\n1 1.5\n3 -3\n");
    say_values(fd, "FSETB t z 1 3\n", bad, 3);
    expect(fd, "ERR RANGE value 2: a value is a finite number, or nan; no value was set\n");
    say_values(fd, "FSETB t z 2 3\n", good, 3);
    expect(fd, "ERR NOPOINT there is no point 2; no value was set\n");
    say_values(fd, "FSETB t 9 1 3\n", good, 3);
    expect(fd, "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a "
               "letter or _\n");
    say_values(fd, "FSETB t z x 3\n", good, 3);
    expect(fd, "ERR NUMBER x is not an id\n");
    say_values(fd, "FSETB u z 1 3\n", good, 3);
    expect(fd, "ERR NOSET there is no set u\n");
    say(fd, "FSETB t w 0 0\nFIELDS t\n");
    expect(fd, "OK 0\nOK 2\nw 0 nan nan\nz 2 -3 1.5\n");
    say(fd, "FSETB t z 1 x\n");
    shutdown(fd, SHUT_WR);
    expect(fd, "ERR NUMBER x is not a number of points\n");
    expect_end(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(column_of_values_in_resp_has_its_body_as_last_word)
{
    static const double v[] = {1.5, 2};
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 1 0\n");
    say_values(fd, "*6\r\n$5\r\nFSETB\r\n$1\r\nt\r\n$1\r\nz\r\n$1\r\n0\r\n$1\r\n2\r\n$16\r\n", v,
               2);
    say_values(fd, "\r\n*5\r\n$5\r\nFSETB\r\n$1\r\nt\r\n$1\r\ny\r\n$1\r\n0\r\n$1\r\n2\r\n", v, 2);
    say(fd, "*6\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$1\r\n1\r\n$6\r\nFIELDS\r\n$1\r\nz\r\n$5\r\n7 8 9\r\n"
            "*4\r\n$4\r\nLOAD\r\n$1\r\nt\r\n$6\r\nFIELDS\r\n$1\r\nz\r\n1 2 nan\n.\n"
            "FGET t z 0 1 2 3\nFIELDS t\n");
    expect(fd, "OK 0 first=0 added=2 coincident=0\n+OK\r\n+OK\r\n"
               "+OK first=2 added=1 coincident=0\r\n+OK first=3 added=1 coincident=0\r\n"
               "OK 4\n0 1.5\n1 2\n2 9\n3 nan\nOK 2\ny 2 1.5 2\nz 3 1.5 9\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(points_come_with_their_values)
{
    static const double rows[] = {5, 5, 1, 2, 6, 6, (double)NAN, 4};
    struct daemon d = daemon_start(no_arguments);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z,a 0 0 1.5 7 1 0 nan 8\nLOAD t 2 FIELDS z\n2 2 -1\n3 3 NaN\n"
            "LOAD t FIELDS b\n# none\n4 4 0.25\n.\n");
    say_values(fd, "LOADB t 2 FIELDS a,z\n", rows, 8);
    say(fd, "FGET t z 0 1 2 3 4 5 6\nFGET t a 0 1 5 6\nFIELDS t\n");
    expect(fd, "OK 0 first=0 added=2 coincident=0\nOK 0 first=2 added=2 coincident=0\n"
               "OK 0 first=4 added=1 coincident=0\nOK 0 first=5 added=2 coincident=0\n"
               "OK 7\n0 1.5\n1 nan\n2 -1\n3 nan\n4 nan\n5 2\n6 4\nOK 4\n0 7\n1 8\n5 1\n6 nan\n"
               "OK 3\na 3 1 8\nb 1 0.25 0.25\nz 4 -1 4\n");
    close(fd);
    daemon_stop(&d, SIGTERM);
}

TEST(points_come_with_all_of_their_values_or_not_at_all)
{
    struct daemon d = daemon_start(no_arguments);
    converse(
        &d,
        "ADD t FIELDS z 0 0\nADD t FIELDS z 0 0 1 1\nADD t FIELDS z\nADD t FIELDS z,z 0 0 1 1\n"
        "ADD t FIELDS z, 0 0 1 1\nADD t FIELDS z 0 0 x\nADD t FIELDS z 0 1e300 1\n"
        "LOAD t 1 FIELDS z\n0 0\nLOAD t 1 FIELDS z\n0 0 1 2\nLOAD t 1 FIELDS z\n0 0 1e999\n"
        "LOAD t 1 FIELDS 9\n0 0 1\nSETS\nLOAD t 1 FIELDS\n",
        "ERR SYNTAX a point without all of its values\n"
        "ERR SYNTAX a point without all of its values\n"
        "ERR SYNTAX a point without all of its values\n"
        "ERR SYNTAX the field z is named twice\n"
        "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a letter or "
        "_\n"
        "ERR NUMBER x is not a number\n"
        "ERR RANGE a coordinate is 0 or has a magnitude from 2^-142 to 2^201\n"
        "ERR SYNTAX line 1: not `x y` and its values; nothing was loaded\n"
        "ERR SYNTAX line 1: not `x y` and its values; nothing was loaded\n"
        "ERR RANGE line 1: a value is a finite number, or nan; nothing was loaded\n"
        "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a letter or "
        "_\n"
        "OK 0\n"
        "ERR SYNTAX usage: LOAD set [n] [FIELDS a,b] | LOAD set [n] PATHS [BORDER] [OF k] [SPLIT] "
        "[FIELDS a,b]\n");
    daemon_stop(&d, SIGTERM);
}

TEST(rows_of_points_have_the_values_of_the_fields_named)
{
    struct daemon d = daemon_start(no_arguments);
    converse(&d,
             "ADD t FIELDS z,a 0 0 1.5 7 1 0 nan 8\nPOINTS t FIELDS z\nPOINTS t FIELDS a,z,a\n"
             "POINTS t FIELDS y\nPOINTS t FIELDS z,\nPOINTS t FIELDS\nPOINTS t FIELDS z BINARI\n"
             "POINTS t z\n",
             "OK 0 first=0 added=2 coincident=0\nOK 2\n0 0 0 1.5\n1 1 0 nan\n"
             "OK 2\n0 0 0 7 1.5 7\n1 1 0 8 nan 8\n"
             "ERR NOFIELD there is no field y\n"
             "ERR SYNTAX a field's name is 1 to 64 of A-Z a-z 0-9 _ . : -, and begins with a "
             "letter or _\n"
             "ERR SYNTAX usage: POINTS set [FIELDS a,b] [BINARY]\n"
             "ERR SYNTAX usage: POINTS set [FIELDS a,b] [BINARY]\n"
             "ERR SYNTAX usage: POINTS set [FIELDS a,b] [BINARY]\n");
    daemon_stop(&d, SIGTERM);
}

/* The client reads only after the values have changed and the field has been dropped. */
TEST(rows_of_points_have_the_values_of_the_moment_when_they_were_asked_for)
{
    enum { N = 300000, ROW = 28 };
    struct daemon d = daemon_start(no_arguments);
    double *rows = malloc(3 * N * sizeof *rows);
    char *got = malloc((size_t)N * ROW), head[100];
    CHECK(rows != NULL && got != NULL);
    for (size_t i = 0; i < N; i++) {
        rows[3 * i] = (double)(i % 1000);
        rows[3 * i + 1] = rows[3 * i + 2] = (double)i;
    }
    int fd = daemon_connect(&d), other = daemon_connect(&d);
    snprintf(head, sizeof head, "LOADB t %d FIELDS z\n", N);
    say_values(fd, head, rows, 3 * (size_t)N);
    CHECK_STR(hear_line(fd), "OK 0 first=0 added=300000 coincident=0");
    say(fd, "POINTS t FIELDS z BINARY\n");
    CHECK_STR(hear_line(fd), "OK 0 rows=300000 bytes=8400000");
    memset(rows, 0, N * sizeof *rows);
    snprintf(head, sizeof head, "FSETB t z 0 %d\n", N);
    say_values(other, head, rows, N);
    say(other, "DEL t 299999\nFDROP t z\n");
    expect(other, "OK 0\nOK 0 deleted=1\nOK 0\n");
    for (size_t n = 0; n < (size_t)N * ROW;) {
        ssize_t r = read(fd, got + n, (size_t)N * ROW - n);
        CHECK(r > 0);
        n += (size_t)r;
    }
    for (size_t i = 0; i < N; i++) {
        double z;
        memcpy(&z, got + i * ROW + 20, sizeof z);
        CHECK_MSG(z == (double)i, "z of %zu is %g", i, z);
    }
    close(fd);
    close(other);
    free(rows);
    free(got);
    daemon_stop(&d, SIGTERM);
}

/* ---- what survives ---- */

/* Returns all that clients see of the fields of t. */
static char *state(const struct daemon *d, const char *requests)
{
    size_t n;
    int fd = daemon_connect(d);
    say(fd, requests);
    shutdown(fd, SHUT_WR);
    char *text = hear_all(fd, &n);
    close(fd);
    return text;
}

static const char *const questions =
    "POINTS t\nFIELDS t\nFGET t z 0 2 3 4\nFGET t w 0\nFGET t y 0\nFIELDS u\nFIELDS v\n";

/* The state is the same as before the daemon was killed. */
static void check_again(const struct directory *dir, struct daemon *d)
{
    char text[4000];
    char *want = state(d, questions);
    daemon_stop(d, SIGKILL);
    CHECK_MSG(directory_run(dir, "--check", text, sizeof text) == 0, "%s", text);
    *d = directory_daemon(dir, NULL);
    char *got = state(d, questions);
    CHECK_STR(got, want);
    free(got);
    free(want);
}

TEST(fields_are_there_after_a_kill_and_after_a_snapshot)
{
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    carry_out(&d,
              "ADD t 0 0 1 0 0 1 1 1 2 2\nFSET t z 0 1.25 1 7 2 -3\nFSET t y 0 1\nFSET t w 0 4\n"
              "DEL t 1\nFDROP t y\nFSET t z 4 8 0 -1\nADD u 1 1\nFSET u z 0 5\nFDROP u z\n"
              "ADD v 1 1\nFSET v none 0 nan\n");
    check_again(&dir, &d);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    check_again(&dir, &d);
    carry_out(&d, "FSET t z 3 3\nFDROP t w\nFSET t y 0 2\nDEL t 4\nFDROP v none\n");
    check_again(&dir, &d);
    converse(&d, "FIELDS t\nFGET t z 0 2 3\nFIELDS v\n",
             "OK 2\ny 1 2 2\nz 3 -3 3\nOK 3\n0 -1\n2 -3\n3 3\nOK 0\n");
    daemon_stop(&d, SIGKILL);
    directory_remove(&dir);
}

TEST(many_values_are_there_after_a_kill)
{
    enum { N = 70000 }; /* more than a record has */
    struct directory dir = directory_new();
    struct daemon d = directory_daemon(&dir, NULL);
    double *rows = malloc(4 * N * sizeof *rows);
    CHECK(rows != NULL);
    for (size_t i = 0; i < N; i++) {
        rows[4 * i] = (double)(i % 300);
        rows[4 * i + 1] = (double)i;
        rows[4 * i + 2] = i % 7 == 0 ? (double)NAN : (double)i / 3;
        rows[4 * i + 3] = -(double)i;
    }
    char head[100];
    int fd = daemon_connect(&d);
    snprintf(head, sizeof head, "LOADB t %d FIELDS z,w\n", N);
    say_values(fd, head, rows, 4 * (size_t)N);
    CHECK_STR(hear_line(fd), "OK 0 first=0 added=70000 coincident=0");
    for (size_t i = 0; i < N; i++)
        rows[i] = (double)i / 9;
    snprintf(head, sizeof head, "FSETB t y 0 %d\n", N);
    say_values(fd, head, rows, N);
    snprintf(head, sizeof head, "FSETB t x 5 %d\n", 100);
    say_values(fd, head, rows, 100);
    say(fd, "ADD t FIELDS z,new -7 7 8 9\n");
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK_STR(hear_line(fd), "OK 0");
    CHECK_STR(hear_line(fd), "OK 0 first=70000 added=1 coincident=0");
    close(fd);
    check_again(&dir, &d);
    carry_out(&d, "SNAPSHOT\n");
    await_info(&d, "snapshots", 1);
    check_again(&dir, &d);
    converse(&d, "FIELDS t\nFGET t z 7 69998 70000\nFGET t y 69999\nFGET t x 4 5 104\n",
             "OK 5\nnew 1 9 9\nw 70000 -69999 0\nx 100 0 11\ny 70000 0 7777.666666666667\n"
             "z 60001 0.3333333333333333 23333\nOK 3\n7 nan\n69998 23332.666666666668\n70000 8\nOK "
             "1\n69999 7777.666666666667\n"
             "OK 3\n4 nan\n5 0\n104 11\n");
    daemon_stop(&d, SIGKILL);
    free(rows);
    directory_remove(&dir);
}
