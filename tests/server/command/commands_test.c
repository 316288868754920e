/* commands_test.c - every command and every error of a request, as clients see them. */
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* A conversation with a daemon that has no other clients. */
static void converse_alone(const char *request, const char *want)
{
    struct daemon d = daemon_start(NULL);
    converse(&d, request, want);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* The square with its centre that PROTOCOL.md shows. */
#define SQUARE "ADD t 0 0  4 0  4 4  0 4  2 2\n"
#define SQUARE_ADDED "OK 0 first=0 added=5 coincident=0\n"

/* Converses about the triangulated square. */
static void ask_square(const char *request, const char *want)
{
    const char *counts = "OK 0 points=5 coincident=0 triangles=4 edges=8 hull=4 ms=";
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, SQUARE "TRIANGULATE t\n");
    expect(fd, SQUARE_ADDED);
    CHECK(strncmp(hear_line(fd), counts, strlen(counts)) == 0);
    close(fd);
    converse(&d, request, want);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

/* ---- sets and points ---- */

TEST(commands_about_sets)
{
    converse_alone("SETS\nCREATE b\nCREATE a TOL 0.5\nCREATE b\nADD b 1 1\nADD a 1 1 1 "
                   "1.25\nSETS\nDROP b\nSETS\n",
                   "OK 0\n"
                   "OK 0\n"
                   "OK 0\n"
                   "ERR EXISTS the set b already exists\n"
                   "OK 0 first=0 added=1 coincident=0\n"
                   "OK 0 first=0 added=2 coincident=1\n"
                   "OK 2\na points=2 triangulated=no\nb points=1 triangulated=no\n"
                   "OK 0\n"
                   "OK 1\na points=2 triangulated=no\n");
}

TEST(commands_about_points)
{
    converse_alone(
        "ADD t 1 2  3 4  1 2  -0 5e-1\nGET t 3 1\nPOINTS t\nCOINCIDENT t\nMOVE t 1 7 8\nGET t 1\n"
        "DEL t 0 0\nPOINTS t\nCOINCIDENT t\nADD t 9 9\n",
        "OK 0 first=0 added=4 coincident=1\n"
        "OK 2\n3 0 0.5\n1 3 4\n"
        "OK 4\n0 1 2\n1 3 4\n2 1 2\n3 0 0.5\n"
        "OK 1\n2 0\n"
        "OK 0\n"
        "OK 1\n1 7 8\n"
        "OK 0 deleted=1\n"
        "OK 3\n1 7 8\n2 1 2\n3 0 0.5\n"
        "OK 0\n"
        "OK 0 first=4 added=1 coincident=0\n");
}

TEST(loads_in_every_form)
{
    converse_alone("LOAD a\n1 2\n\n# no point\n 3\t4 \n.\nLOAD a 3\n5 6\n# counts\n7 8\nPOINTS "
                   "a\nLOAD b 0\nPOINTS b\n",
                   "OK 0 first=0 added=2 coincident=0\n"
                   "OK 0 first=2 added=2 coincident=0\n"
                   "OK 4\n0 1 2\n1 3 4\n2 5 6\n3 7 8\n"
                   "OK 0 first=0 added=0 coincident=0\n"
                   "OK 0\n");
}

TEST(load_of_doubles_that_look_like_lines)
{
    static const char request[] =
        "LOADB t 2\n\0\0\0\0\0\0\xf0\x3f\n\n\n\n\0\0\0\x40\0\0\0\0\0\0\xe0\xbf"
        "\0\0\0\0\0\0\0\0GET t 0 1\n";
    size_t n;
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say_bytes(fd, request, sizeof request - 1);
    shutdown(fd, SHUT_WR);
    char *got = hear_all(fd, &n);
    const char *start = "OK 0 first=0 added=2 coincident=0\nOK 2\n0 1 2.0000";
    test_drop_versions(got);
    CHECK(strncmp(got, start, strlen(start)) == 0);
    CHECK(strstr(got, "\n1 -0.5 0\n") != NULL);
    free(got);
    close(fd);
}

TEST(stat_counts)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, SQUARE "ADD t 0 0\nSTAT t\nTRIANGULATE t\nSTAT t\n");
    expect(fd, SQUARE_ADDED
           "OK 0 first=5 added=1 coincident=1\n"
           "OK 0 points=6 coincident=1 triangulated=no triangles=0 edges=0 hull=0 memory=");
    hear_line(fd);
    hear_line(fd);
    expect(fd, "OK 0 points=6 coincident=1 triangulated=yes triangles=4 edges=8 hull=4 memory=");
    close(fd);
}

TEST(minus_zero_is_zero_in_every_argument)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t FIELDS z -0 0 -1 4 -0 1 0 4 -0\nTRIANGULATE t\nCREATE s TOL -0\nSTAT s\n");
    CHECK(strncmp(hear_line(fd), "OK 0 first=0 added=3", 20) == 0);
    CHECK(strncmp(hear_line(fd), "OK 0 points=3", 13) == 0);
    expect(fd, "OK 0\n");
    const char *stat = hear_line(fd);
    CHECK_MSG(strstr(stat, " tol=0") != NULL, "%s", stat);
    close(fd);
    converse(&d,
             "POINTS t FIELDS z\nCONTOUR t z -0\nCONTOUR t z EVERY 1 BASE -0\n"
             "AREAS t BOX -0 -0 4 4\n",
             "OK 3\n0 0 0 -1\n1 4 0 1\n2 0 4 0\n"
             "OK 1\n0 open 2 0 4 2 0\n"
             "OK 1\n0 open 2 0 4 2 0\n"
             "OK 3 box=0,0,4,4\n0 4\n1 6\n2 6\n");
}

/* ---- queries ---- */

TEST(queries_of_lists)
{
    ask_square("LISTS t\nLISTS t CW\nLISTS t 1 4 1\nLISTS t 2 cw\nHULL t\nHULL t CW\n",
               "OK 5 interior=1 boundary=4\n4 0 1 2 3\n0 1 4 3\n1 2 4 0\n2 3 4 1\n3 0 4 2\n"
               "OK 5 interior=1 boundary=4\n4 0 3 2 1\n0 3 4 1\n3 2 4 0\n2 1 4 3\n1 0 4 2\n"
               "OK 2 interior=1 boundary=1\n4 0 1 2 3\n1 2 4 0\n"
               "OK 1 interior=0 boundary=1\n2 1 4 3\n"
               "OK 4\n0 0 0\n1 4 0\n2 4 4\n3 0 4\n"
               "OK 4\n0 0 0\n3 0 4\n2 4 4\n1 4 0\n");
}

TEST(queries_of_triangles_and_edges)
{
    ask_square("TRIANGLES t\nTRIANGLES t 4\nTRIANGLES t 0 4\nTRIANGLES t 0 1 4\nTRIANGLES t "
               "CW\nEDGES t\nEDGES t 0\n",
               "OK 4\n0 1 4\n0 4 3\n1 2 4\n2 3 4\n"
               "OK 4\n0 1 4\n1 2 4\n2 3 4\n0 4 3\n"
               "OK 2\n0 4 3\n0 1 4\n"
               "OK 2\n1 2 4\n0 4 3\n"
               "OK 4\n0 3 4\n0 4 1\n1 4 2\n2 4 3\n"
               "OK 8\n0 1\n0 3\n0 4\n1 2\n1 4\n2 3\n2 4\n3 4\n"
               "OK 3\n0 1\n0 4\n0 3\n");
}

TEST(queries_of_places)
{
    ask_square(
        "LOCATE t 2 1\nLOCATE t 1 1\nLOCATE t 2 2\nLOCATE t 5 5\nNEAREST t 1.5 1\nNEAREST t 2 2 3\n"
        "NEAREST t 0 0 99\nWITHIN t 0 0 2 2\nWITHIN t 2 2 0 0\nWITHIN t 0 0 4\nWITHIN t 9 9 1\n",
        "OK 1 where=inside\n0 1 4\n"
        "OK 1 where=edge\n0 4\n"
        "OK 1 where=vertex\n4\n"
        "OK 0 where=outside\n"
        "OK 1\n4 2 2 1.118033988749895\n"
        "OK 3\n4 2 2 0\n0 0 0 2.8284271247461903\n1 4 0 2.8284271247461903\n"
        "OK 5\n0 0 0 0\n4 2 2 2.8284271247461903\n1 4 0 4\n3 0 4 4\n2 4 4 5.656854249492381\n"
        "OK 2\n0 0 0\n4 2 2\n"
        "OK 2\n0 0 0\n4 2 2\n"
        "OK 4\n0 0 0\n1 4 0\n3 0 4\n4 2 2\n"
        "OK 0\n");
}

TEST(check_proves_the_triangulation)
{
    ask_square("CHECK t\n", "OK 0 delaunay=yes points=5 coincident=0 triangles=4 edges=8 hull=4\n");
}

TEST(edits_of_a_live_set_are_seen_by_the_next_query)
{
    ask_square("ADD t 2 0\nLISTS t 5\nMOVE t 5 2 1\nLISTS t 5\nDEL t 4\nCHECK t\nHULL t\n",
               "OK 0 first=5 added=1 coincident=0\n"
               "OK 1 interior=0 boundary=1\n5 1 4 0\n"
               "OK 0\n"
               "OK 1 interior=1 boundary=0\n5 0 1 4\n"
               "OK 0 deleted=1\n"
               "OK 0 delaunay=yes points=5 coincident=0 triangles=4 edges=8 hull=4\n"
               "OK 4\n0 0 0\n1 4 0\n2 4 4\n3 0 4\n");
}

TEST(degenerate_sets_have_answers)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd,
        "CREATE e\nTRIANGULATE e\nADD o 5 5\nTRIANGULATE o\nADD l 2 2 0 0 1 1\nTRIANGULATE l\n");
    for (int i = 0; i < 6; i++)
        CHECK(strncmp(hear_line(fd), "OK 0", 4) == 0);
    converse(&d,
             "LISTS e\nHULL e\nNEAREST e 0 0\nLOCATE e 0 0\nLISTS o\nNEAREST o 0 0\nLISTS l\nEDGES "
             "l\nTRIANGLES l\nHULL l\n",
             "OK 0 interior=0 boundary=0\nOK 0\nOK 0\nOK 0 where=outside\n"
             "OK 1 interior=0 boundary=1\n0\nOK 1\n0 5 5 7.0710678118654755\n"
             "OK 3 interior=0 boundary=3\n0 2\n2 1 0\n1 2\nOK 2\n0 2\n1 2\nOK 0\nOK 3\n0 2 2\n2 1 "
             "1\n1 0 0\n");
}

TEST(binary_replies_are_raw_words)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "ADD t 0 0 1 0 0 1\nTRIANGULATE t\n");
    hear_line(fd);
    hear_line(fd);
    say(fd, "TRIANGLES t BINARY\nEDGES t BINARY\nLISTS t BINARY\nPOINTS t BINARY\n");
    shutdown(fd, SHUT_WR);
    static const char want[] =
        "OK 0 rows=1 bytes=12\n\0\0\0\0\1\0\0\0\2\0\0\0"
        "OK 0 rows=3 bytes=24\n\0\0\0\0\1\0\0\0\0\0\0\0\2\0\0\0\1\0\0\0\2\0\0\0"
        "OK 0 interior=0 boundary=3 bytes=48\n"
        "\0\0\0\0\2\0\0\0\1\0\0\0\2\0\0\0\1\0\0\0\2\0\0\0\2\0\0\0\0\0\0\0"
        "\2\0\0\0\2\0\0\0\0\0\0\0\1\0\0\0"
        "OK 0 rows=3 bytes=60\n"
        "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
        "\1\0\0\0\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\0"
        "\2\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xf0\x3f";
    size_t n;
    char *got = hear_all(fd, &n);
    CHECK(n == sizeof want - 1 && memcmp(got, want, n) == 0);
    free(got);
}

TEST(words_about_the_server)
{
    converse_alone("PING\nping\n  \nHELP ping\nhello\nHELLO 1\nAUTH whatever\nQUIT\nPING\n",
                   "OK 0\nOK 0\nOK 1\nPING - answers OK 0\n"
                   "OK 0 server=delaunayd version=1.0.0 protocol=1\nOK 0 server=delaunayd "
                   "version=1.0.0 protocol=1\n"
                   "OK 0 role=rw\nOK 0\n");
}

/* ---- errors ---- */

#define NOT_THERE "ERR RANGE a coordinate is 0 or has a magnitude from 2^-142 to 2^201\n"

TEST(errors_of_points_leave_the_connection_usable)
{
    ask_square(
        "FOO\nADD t 1\nADD t 1 2 3\nADD t/ 1 2\nADD t 1 x\nADD t nan 1\nADD t 0x1 1\nADD t "
        "1 1e300\nADD t 1 1e-60\n"
        "GET t 9\nGET t -1\nDEL t 1 9\nMOVE t 9 1 1\nGET t 4\n",
        "ERR UNKNOWN there is no command FOO; try HELP\n"
        "ERR SYNTAX usage: ADD set x y [x y ...] | ADD set FIELDS a,b x y a b [x y a b ...]\n"
        "ERR SYNTAX odd number of coordinates\n"
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\n"
        "ERR NUMBER x is not a number\n"
        "ERR NUMBER nan is not a number\n"
        "ERR NUMBER 0x1 is not a number\n" NOT_THERE NOT_THERE "ERR NOPOINT there is no point 9\n"
        "ERR NUMBER -1 is not an id\n"
        "ERR NOPOINT there is no point 9; nothing was deleted\n"
        "ERR NOPOINT there is no point 9\n"
        "OK 1\n4 2 2\n");
}

TEST(errors_of_queries_leave_the_connection_usable)
{
    ask_square("LISTS t 9\nTRIANGLES t 0 2\nTRIANGLES t 0 1 2\nTRIANGLES t 9\nEDGES t 9\nLISTS "
               "u\nNEAREST t 0 0 -1\n"
               "LISTS t 0 BINARY\nHULL t BINARY\nHULL t 1\nWITHIN t 0 0 -1\nTRIANGLES t 0 1 2 "
               "3\nEDGES t 0 1\nPOINTS t CW\n"
               "GET t 4\n",
               "ERR NOPOINT there is no point 9\n"
               "ERR NOEDGE these points are not joined by an edge\n"
               "ERR NOTRIANGLE these points are not a triangle of the triangulation\n"
               "ERR NOPOINT no such point\n"
               "ERR NOPOINT no such point\n"
               "ERR NOSET there is no set u\n"
               "ERR NUMBER -1 is not a number of points\n"
               "ERR SYNTAX usage: LISTS set [WITHIN x0 y0 x1 y1] [CW] [BINARY] | LISTS set id [id "
               "...] [CW]\n"
               "ERR SYNTAX usage: HULL set [CW]\n"
               "ERR SYNTAX usage: HULL set [CW]\n"
               "ERR RANGE a radius is not negative\n"
               "ERR SYNTAX usage: TRIANGLES set [WITHIN x0 y0 x1 y1] [CW] [BINARY] | TRIANGLES set "
               "INSIDE [k] [CW] [BINARY] | TRIANGLES set a [b [c]] [CW]\n"
               "ERR SYNTAX usage: EDGES set [CW] [BINARY] | EDGES set CONSTRAINED [BINARY] | EDGES "
               "set INSIDE [k] [CW] [BINARY] | EDGES set a [CW]\n"
               "ERR SYNTAX usage: POINTS set [FIELDS a,b] [BINARY]\n"
               "OK 1\n4 2 2\n");
}

TEST(trace_needs_no_triangulation_but_a_small_set)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    converse(&d, "CREATE t\nTRACE t\nADD t 5 5\nTRACE t\nTRACE t x\nTRACE u\n",
             "OK 0\nOK 0\nOK 0 first=0 added=1 coincident=0\nOK 1\nhull 0\n"
             "ERR SYNTAX usage: TRACE set\nERR NOSET there is no set u\n");
    load_random(fd, "big", 1001);
    load_random(fd, "fits", 1000);
    converse(&d, "TRACE big\n", "ERR TOOBIG TRACE is for sets of at most 1000 points\n");
    say(fd, "TRACE fits\nPING\n");
    unsigned rows;
    CHECK(sscanf(hear_line(fd), "OK %u", &rows) == 1 && rows > 4000);
    CHECK(strncmp(hear_line(fd), "grid ", 5) == 0);
    for (unsigned i = 2; i < rows; i++)
        hear_line(fd);
    CHECK(strncmp(hear_line(fd), "hull ", 5) == 0);
    CHECK_STR(hear_line(fd), "OK 0");
    close(fd);
    CHECK(daemon_stop(&d, SIGTERM) == 0);
}

TEST(errors_of_other_commands_leave_the_connection_usable)
{
    ask_square(
        "CREATE s TOL\nCREATE s TOL -1\nCREATE s TOL x\nCREATE s TOL 1e300\nTRIANGULATE t METHOD\n"
        "TRIANGULATE t METHOD magic\nTRIANGULATE u\nDROP u\nHELP foo\nHELLO 9\nHELLO x\nPING "
        "x\nSETS x\nSETS\n",
        "ERR SYNTAX usage: CREATE set [TOL t] [TEMPORARY]\n"
        "ERR RANGE a tolerance is not negative\n"
        "ERR NUMBER x is not a number\n"
        "ERR RANGE a tolerance is 0 or has a magnitude from 2^-142 to 2^201\n"
        "ERR SYNTAX usage: TRIANGULATE set [METHOD auto|shelling|divide]\n"
        "ERR SYNTAX usage: TRIANGULATE set [METHOD auto|shelling|divide]\n"
        "ERR NOSET there is no set u\n"
        "ERR NOSET there is no set u\n"
        "ERR UNKNOWN there is no command foo\n"
        "ERR RANGE this server speaks version 1\n"
        "ERR NUMBER x is not a version\n"
        "ERR SYNTAX usage: PING\n"
        "ERR SYNTAX usage: SETS\n"
        "OK 1\nt points=5 triangulated=yes\n");
}

#define UNTRIANGULATED "ERR UNTRIANGULATED TRIANGULATE the set first\n"

TEST(queries_of_the_triangulation_before_triangulate_are_refused)
{
    converse_alone(SQUARE "LISTS t\nTRIANGLES t\nEDGES t 0\nHULL t\nLOCATE t 1 1\nCHECK t\n",
                   SQUARE_ADDED UNTRIANGULATED UNTRIANGULATED UNTRIANGULATED UNTRIANGULATED
                       UNTRIANGULATED UNTRIANGULATED);
}

TEST(a_triangulated_set_that_shrinks_to_nothing_and_grows_again_stays_live)
{
    ask_square(
        "DEL t 1 2 3 4\nLISTS t\nDEL t 0\nLISTS t\nLOCATE t 1 1\nADD t 1 1\nLISTS t\nADD t 2 1\n"
        "EDGES t\n",
        "OK 0 deleted=4\nOK 1 interior=0 boundary=1\n0\nOK 0 deleted=1\nOK 0 interior=0 "
        "boundary=0\n"
        "OK 0 where=outside\nOK 0 first=5 added=1 coincident=0\n"
        "OK 1 interior=0 boundary=1\n5\nOK 0 first=6 added=1 coincident=0\nOK 1\n5 6\n");
}

TEST(load_with_a_bad_line_changes_nothing_and_is_read_to_its_end)
{
    converse_alone("ADD t 0 0\nLOAD t\n1 1\n2\n3 3\n.\nLOAD t 2\n1 x\nPING\nLOAD u\n1 1 1\n.\nLOAD "
                   "u\n1e999 0\n.\n"
                   "SETS\nGET t 0 1\n",
                   "OK 0 first=0 added=1 coincident=0\n"
                   "ERR SYNTAX line 2: not `x y`; nothing was loaded\n"
                   "ERR NUMBER line 1: not a number; nothing was loaded\n"
                   "ERR SYNTAX line 1: not `x y`; nothing was loaded\n"
                   "ERR RANGE line 1: a coordinate is 0 or has a magnitude from 2^-142 to 2^201; "
                   "nothing was loaded\n"
                   "OK 1\nt points=1 triangulated=no\n"
                   "ERR NOPOINT there is no point 1\n");
}

TEST(load_that_the_input_ends_within_is_refused)
{
    converse_alone("LOAD t\n1 1\n2 2",
                   "ERR SYNTAX line 3: the input ended too early; nothing was loaded\n");
    converse_alone("LOADB t 2\n1234567890",
                   "ERR SYNTAX point 1: the input ended too early; nothing was loaded\n");
    converse_alone("LOAD t\n1 1\n.", "OK 0 first=0 added=1 coincident=0\n");
}

TEST(load_without_a_clear_head_closes_the_connection)
{
    converse_alone("LOAD t x\nDROP t\n", "ERR NUMBER x is not a number of points\n");
    converse_alone("LOADB t\nDROP t\n",
                   "ERR SYNTAX usage: LOADB set n [CONSTRAINTS m [SPLIT]] [FIELDS a,b]\n");
    static const char usage[] = "ERR SYNTAX usage: LOAD set [n] [FIELDS a,b] | LOAD set [n] PATHS "
                                "[BORDER] [OF k] [SPLIT] [FIELDS a,b]\n";
    converse_alone("LOAD\n1 1\n.\n", usage);
    converse_alone("LOAD t 1 1\n1 1\n", usage);
    converse_alone("LOAD t 1 OF 3\n1 1\n", usage);
    converse_alone("LOAD t 1 FIELDS z PATHS\n1 1\n", usage);
}

TEST(points_of_a_load_that_is_refused_are_skipped)
{
    converse_alone(
        "LOAD a/b\nDROP t\nx\n.\nLOAD a/b 2\n1 1\nDROP t\nLOADB a/b 1\n0123456\n\n0123456PING\n"
        "LOAD a/b 0\nPING\nLOAD a/b\n1 1\n",
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\n"
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\n"
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\nOK 0\n"
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\nOK 0\n"
        "ERR SYNTAX a set's name is 1 to 64 of A-Z a-z 0-9 _ . : -\n");
}

TEST(points_of_a_load_with_a_token_for_reading_are_skipped)
{
    char path[] = "/tmp/delaunayd-test-XXXXXX";
    const char *arguments[] = {"--auth-file", path, NULL};
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, "ro look\n", 8) == 8);
    close(file);
    struct daemon d = daemon_start(arguments);
    converse(&d, "AUTH look\nLOAD t 1\n1 1\nPING\n",
             "OK 0 role=ro\nERR DENIED your token is for reading only\nOK 0\n");
    CHECK(daemon_stop(&d, SIGTERM) == 0);
    unlink(path);
}

TEST(lengths_out_of_range_are_called_what_they_are)
{
    struct daemon d = daemon_start(NULL);
    int fd = daemon_connect(&d);
    say(fd, "CREATE t TOL 1e300\nCREATE t TOL x\nADD t 1 1\nTRIANGULATE t\n");
    expect(fd, "ERR RANGE a tolerance is 0 or has a magnitude from 2^-142 to 2^201\n"
               "ERR NUMBER x is not a number\nOK 0 first=0 added=1 coincident=0\n");
    hear_line(fd);
    say(fd, "WITHIN t 0 0 1e-60\nWITHIN t 0 0 -1e300\nWITHIN t 1e300 0 1\n");
    expect(fd, "ERR RANGE a radius is 0 or has a magnitude from 2^-142 to 2^201\n"
               "ERR RANGE a radius is not negative\n" NOT_THERE);
}

TEST(limits_of_points_are_kept)
{
    const char *arguments[] = {"--max-points", "3", NULL};
    struct daemon d = daemon_start(arguments);
    converse(
        &d,
        "ADD t 0 0 1 0\nADD t 2 0 3 0\nADD t 2 0\nADD t 5 5\nLOAD u\n1 1\n2 2\n3 3\n4 4\n.\nSETS\n",
        "OK 0 first=0 added=2 coincident=0\n"
        "ERR TOOBIG a set holds at most 3 points (--max-points)\n"
        "OK 0 first=2 added=1 coincident=0\n"
        "ERR TOOBIG a set holds at most 3 points (--max-points)\n"
        "ERR TOOBIG line 4: a set holds at most 3 points (--max-points); nothing was loaded\n"
        "OK 1\nt points=3 triangulated=no\n");
}

TEST(limits_of_memory_are_kept)
{
    enum { LINES = 100000 };
    const char *arguments[] = {"--max-memory", "1m", NULL};
    struct daemon d = daemon_start(arguments);
    int fd = daemon_connect(&d);
    char *points = malloc(LINES * 16 + 100);
    CHECK(points != NULL);
    size_t n = (size_t)sprintf(points, "LOAD t\n");
    for (int i = 0; i < LINES; i++)
        n += (size_t)sprintf(points + n, "%d %d\n", i, i * 7 % 1000);
    sprintf(points + n, ".\n");
    say(fd, points);
    CHECK(strncmp(hear_line(fd), "ERR NOMEM line ", 15) == 0);
    say(fd, "ADD t 1 1\n");
    expect(fd, "OK 0 first=0 added=1 coincident=0\n");
    CHECK(daemon_info(&d, "loading") == 0);
    free(points);
}

TEST(tokens_give_roles)
{
    static const char tokens[] = "# tokens\nrw secret\n\nro public\n";
    char path[] = "/tmp/delaunayd-test-XXXXXX";
    int file = mkstemp(path);
    CHECK(file >= 0 && write(file, tokens, sizeof tokens - 1) == (ssize_t)sizeof tokens - 1);
    close(file);
    const char *arguments[] = {"--auth-file", path, NULL};
    struct daemon d = daemon_start(arguments);
    unlink(path);
    converse(
        &d,
        "PING\nSETS\nADD t 1 1\nAUTH secre\nAUTH public\nSETS\nADD t 1 1\nAUTH secret\nADD t 1 1\n",
        "OK 0\n"
        "ERR NOAUTH authenticate first: AUTH token\n"
        "ERR NOAUTH authenticate first: AUTH token\n"
        "ERR DENIED no such token\n"
        "OK 0 role=ro\n"
        "OK 0\n"
        "ERR DENIED your token is for reading only\n"
        "OK 0 role=rw\n"
        "OK 0 first=0 added=1 coincident=0\n");
    converse(&d, "LOAD t\n1 1\n.\nPING\n", "ERR NOAUTH authenticate first: AUTH token\n");
}
