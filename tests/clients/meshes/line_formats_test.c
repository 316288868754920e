/* line_formats_test.c - lines and polygons in formats of their own: .poly and OBJ are read, all are written, and come back as they were. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

static void load_lines(const char *name, const char *text, const char *constraints)
{
    char command[300];
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s", cli_path(name));
    cli_run_well(command);
    cli_expect("constraints t", constraints);
}

static void refuse(const char *name, const char *text, const char *want)
{
    char command[300];
    int status;
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s", cli_path(name));
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 1 && strstr(got, want) != NULL, "%s", got);
}

/* The options write the set t as `want`, and a set that is loaded from that as the same. */
static void export_as(const char *ending, const char *options, const char *want)
{
    char name[40], command[400];
    snprintf(name, sizeof name, "out.%s", ending);
    snprintf(command, sizeof command, "export t - %s", options);
    cli_expect(command, want);
    cli_write(name, want);
    snprintf(command, sizeof command, "load u %s", cli_path(name));
    cli_run_well(command);
    snprintf(command, sizeof command, "export u - %s", options);
    cli_expect(command, want);
    cli_run_well("drop u");
}

#define BOX                                                                                        \
    "# a box with a hole\n8 2 1 1\n1 0 0 10 1\n2 8 0 11 1\n3 8 8 12 1\n4 0 8 13 1\n"               \
    "5 2 2 14 0\n6 3 2 15 0\n7 3 3 16 0\n8 2 3 17 0\n"                                             \
    "8 1\n1 1 2 1\n2 2 3 1\n3 3 4 1\n4 4 1 1\n5 5 6 2\n6 6 7 2\n7 7 8 2\n8 8 5 2\n"

TEST(segments_of_poly_become_lines_and_what_they_enclose_is_a_border)
{
    cli_begin();
    load_lines("a.poly", "4 2\n0 0 0\n1 4 0\n2 0 4\n3 9 9\n4 0\n0 0 1\n1 1 2\n2 2 0\n3 1 3\n0\n",
               "OK 7\n0 1 line 0\n0 1 border 0\n0 2 line 0\n0 2 border 0\n1 2 line 0\n"
               "1 2 border 0\n1 3 line 0\n");
    cli_finish();
}

TEST(holes_and_regions_of_poly_become_borders)
{
    cli_begin();
    load_lines("a.poly", BOX "1\n1 2.5 2.5\n",
               "OK 16\n0 1 line 1\n0 1 border 0\n0 3 line 1\n0 3 border 0\n1 2 line 1\n"
               "1 2 border 0\n2 3 line 1\n2 3 border 0\n4 5 line 2\n4 5 border 0\n4 7 line 2\n"
               "4 7 border 0\n5 6 line 2\n5 6 border 0\n6 7 line 2\n6 7 border 0\n");
    cli_expect("points t FIELDS a1", "OK 8\n0 0 0 10\n1 8 0 11\n2 8 8 12\n3 0 8 13\n4 2 2 14\n"
                                     "5 3 2 15\n6 3 3 16\n7 2 3 17\n");
    cli_run_well("drop t");
    load_lines("a.poly", BOX "0\n2\n1 2.5 2.5 7 0.1\n2 1 1 6\n",
               "OK 20\n0 1 line 1\n0 1 border 6\n0 3 line 1\n0 3 border 6\n1 2 line 1\n"
               "1 2 border 6\n2 3 line 1\n2 3 border 6\n4 5 line 2\n4 5 border 6\n4 5 border 7\n"
               "4 7 line 2\n4 7 border 6\n4 7 border 7\n5 6 line 2\n5 6 border 6\n5 6 border 7\n"
               "6 7 line 2\n6 7 border 6\n6 7 border 7\n");
    refuse("a.poly", BOX "0\n", "a .poly file makes a new set, and there is a set t");
    cli_finish();
}

TEST(points_of_poly_may_be_in_a_node_file_beside_it)
{
    cli_begin();
    cli_write("a.node", "3 2 0 0\n1 0 0\n2 4 0\n3 0 4\n");
    load_lines("a.poly", "0 2 0 0\n1 0\n1 1 3\n0\n", "OK 1\n0 2 line 0\n");
    cli_write("a.node", "3 2 0 0\n1 0 0\n2 4\n");
    refuse("a.poly", "0 2 0 0\n1 0\n1 1 3\n0\n", "a.poly:3: in the .node file: y is missing");
    cli_finish();
}

TEST(bad_poly_files_are_named_by_line_and_fault)
{
    static const struct {
        const char *text, *want;
    } bad[] = {
        {"", "the file ends before its points"},
        {"x\n", "a.poly:1: the number of points is not a number: \"x\""},
        {"2 3\n", "a.poly:1: points have two coordinates, not 3"},
        {"2 2\n0 0 0\n", "the file ends before its last point"},
        {"2 2\n0 0 0\n2 1 1\n", "a.poly:3: points are numbered 0, 1, ... or 1, 2, ..., not 2 here"},
        {"1 2\n5 0 0\n", "not 5 here"},
        {"1 2\n0 0 1e300\n", "a.poly:2: a coordinate must be 0 or from"},
        {"1 2\n0 0\n", "a.poly:2: y is missing"},
        {"1 2 1\n0 0 0 high\n", "a.poly:2: an attribute is not a number: \"high\""},
        {"1 2 65\n", "a point has at most 64 attributes"},
        {"2 2\n0 0 0\n1 1 1\n1 0\n0 0 2\n0\n", "a.poly:5: there is no point 2"},
        {"2 2\n1 0 0\n2 1 1\n1 0\n0 0 2\n0\n", "a.poly:5: there is no point 0"},
        {"2 2\n0 0 0\n1 1 1\n1 0\n0 0\n0\n", "a.poly:5: an end of a segment is missing"},
        {"2 2\n0 0 0\n1 1 1\n1 0\n0 0 1\n", "the file ends before its holes"},
        {"2 2\n0 0 0\n1 1 1\n1 0\n0 0 1\n1\n", "the file ends before its last hole"},
        {"2 2\n0 0 0\n1 1 1\n1 0\n0 0 1\n1\n1 1e300 0\n", "a.poly:7: a coordinate is out of range"},
        {"0 2\n1 0\n0 0 1\n0\n", "there are no points"}};
    cli_begin();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        refuse("a.poly", bad[i].text, bad[i].want);
    cli_expect("sets", "OK 0\n");
    cli_finish();
}

TEST(lines_of_obj_keep_the_points_that_the_file_numbers)
{
    cli_begin();
    load_lines(
        "a.obj",
        "# o\nv 0 0 1\nv 4 0 2\nv 4 4 3\no border_7\nl 1 2 3 1\ng other\nl -1/2 -3/1\nf 1 2 3\n",
        "OK 4\n0 1 border 7\n0 2 line 0\n0 2 border 7\n1 2 border 7\n");
    cli_expect("points t FIELDS z", "OK 3\n0 0 0 1\n1 4 0 2\n2 4 4 3\n");
    refuse("a.obj", "v 0 0\nv 1 1\nl 1 3\n", "a.obj:3: there is no point 3 before");
    refuse("a.obj", "v 0 0\nl 1\n", "a.obj:2: a line needs two points");
    refuse("a.obj", "v 0 0\nv 1 1\nl 1 -3\n", "a.obj:3: there is no point -3 before");
    refuse("a.obj", "v 0 x\n", "a.obj:1: not a number: \"x\"");
    refuse("a.obj", "v 0\n", "a.obj:1: a point needs x and y");
    cli_finish();
}

TEST(lines_and_polygons_are_written_and_come_back_as_they_were)
{
    cli_begin();
    cli_run_well("add t FIELDS z 0 0 1  8 0 2  8 8 3  0 8 4  2 2 5  3 2 6  3 3 7  2 3 8  12 0 9  "
                 "12 1 10  20 20 5");
    cli_run_well("triangulate t");
    cli_run_well("constrain t BORDER OF 4 RING 0 1 2 3");
    cli_run_well("constrain t BORDER OF 4 RING 4 5 6 7");
    cli_run_well("constrain t OF 2 PATH 1 8 9");
    export_as(
        "geojson", "-f geojson --lines",
        "{\"type\":\"FeatureCollection\",\"features\":[\n"
        "{\"type\":\"Feature\",\"properties\":{\"kind\":\"border\",\"number\":4},\"geometry\":"
        "{\"type\":\"Polygon\",\"coordinates\":[[[0,0,1],[8,0,2],[8,8,3],[0,8,4],[0,0,1]],"
        "[[2,2,5],[3,2,6],[3,3,7],[2,3,8],[2,2,5]]]}},\n"
        "{\"type\":\"Feature\",\"properties\":{\"kind\":\"line\",\"number\":2},\"geometry\":"
        "{\"type\":\"LineString\",\"coordinates\":[[8,0,2],[12,0,9],[12,1,10]]}},\n"
        "{\"type\":\"Feature\",\"properties\":{},\"geometry\":"
        "{\"type\":\"Point\",\"coordinates\":[20,20,5]}}\n]}\n");
    export_as("wkt", "-f wkt --lines",
              "WKT,kind,number\n\"POLYGON Z ((0 0 1, 8 0 2, 8 8 3, 0 8 4, 0 0 1), "
              "(2 2 5, 3 2 6, 3 3 7, 2 3 8, 2 2 5))\",border,4\n"
              "\"LINESTRING Z (8 0 2, 12 0 9, 12 1 10)\",line,2\nPOINT Z (20 20 5),,\n");
    export_as("gmt", "-f gmt",
              "> border 4\n0 0 1\n8 0 2\n8 8 3\n0 8 4\n0 0 1\n> border 4\n2 2 5\n3 2 6\n3 3 7\n"
              "2 3 8\n2 2 5\n> line 2\n8 0 2\n12 0 9\n12 1 10\n> point\n20 20 5\n");
    export_as("obj", "-f obj --lines",
              "v 0 0 1\nv 8 0 2\nv 8 8 3\nv 0 8 4\nv 2 2 5\nv 3 2 6\nv 3 3 7\nv 2 3 8\nv 12 0 9\n"
              "v 12 1 10\nv 20 20 5\ng border_4\nl 1 2 3 4 1\nl 5 6 7 8 5\ng line_2\nl 2 9 10\n");
    cli_finish();
}

TEST(rings_that_touch_and_nest_are_written_as_polygons)
{
    cli_begin();
    cli_run_well("add t 0 0  9 0  9 9  0 9  1 1  8 1  8 8  1 8  3 3  5 3  5 5  5 7  3 7");
    cli_run_well("triangulate t");
    cli_run_well("constrain t BORDER RING 0 1 2 3");
    cli_run_well("constrain t BORDER RING 4 5 6 7");
    cli_run_well("constrain t BORDER RING 8 9 10");
    cli_run_well("constrain t BORDER RING 10 11 12");
    export_as("wkt", "-f wkt --lines",
              "WKT,kind,number\n\"POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 8 1, 8 8, 1 8, 1 1))\""
              ",border,0\n\"POLYGON ((3 3, 5 3, 5 5, 3 3))\",border,0\n"
              "\"POLYGON ((5 5, 5 7, 3 7, 5 5))\",border,0\n");
    cli_run_well("release t BORDER 8 9");
    cli_expect("export t - -f wkt --lines",
               "WKT,kind,number\n\"LINESTRING (3 3, 5 5, 5 3)\",border,0\n\"POLYGON ((0 0, 9 0, 9 "
               "9, 0 9, 0 0), (1 1, 8 1, 8 8, 1 8, 1 1))\""
               ",border,0\n"
               "\"POLYGON ((5 5, 5 7, 3 7, 5 5))\",border,0\n");
    cli_finish();
}

/* Ids with a gap are not places, and a number is neither. */
TEST(numbers_of_lines_are_not_taken_for_points)
{
    cli_begin();
    cli_run_well("add t 0 0 4 0 0 4 9 9");
    cli_run_well("del t 0");
    cli_run_well("triangulate t");
    cli_run_well("constrain t OF 1 1 2");
    cli_run_well("constrain t OF 70000 2 3");
    export_as("csv", "-f wkt --lines",
              "WKT,kind,number\n\"LINESTRING (4 0, 0 4)\",line,1\n"
              "\"LINESTRING (0 4, 9 9)\",line,70000\n");
    cli_finish();
}

TEST(lines_are_refused_in_formats_that_have_none)
{
    int status;
    cli_begin();
    cli_run_well("add t 0 0  1 0  0 1");
    cli_run_well("triangulate t");
    const char *got = cli_run(&status, "export t - -f ply --lines");
    CHECK_MSG(status == 2 && strstr(got, "--lines: the formats are poly, gmt") != NULL, "%s", got);
    cli_expect("export t - -f gmt", "> point\n0 0\n> point\n1 0\n> point\n0 1\n");
    cli_finish();
}
