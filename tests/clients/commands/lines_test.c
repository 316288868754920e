/* lines_test.c - `delaunay load` of files with lines and polygons, which become constraints: all of them, or nothing. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

/* Loads a file into the set t, and compares what CONSTRAINTS and POINTS answer. */
static void load_lines(const char *name, const char *text, const char *options,
                       const char *constraints, const char *points)
{
    char command[300];
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    cli_run_well(command);
    cli_expect("constraints t", constraints);
    cli_expect("points t", points);
    cli_run_well("drop t");
}

static void load_says(const char *name, const char *text, const char *options, int want_status,
                      const char *want)
{
    char command[300];
    int status;
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == want_status && strstr(got, want) != NULL, "%s", got);
}

#define FEATURE(properties, type, coordinates)                                                     \
    "{\"type\":\"Feature\",\"properties\":" properties ",\"geometry\":{\"type\":\"" type           \
    "\",\"coordinates\":" coordinates "}}\n"
#define LINE(coordinates) FEATURE("{}", "LineString", coordinates)
#define POLYGON(coordinates) FEATURE("{}", "Polygon", coordinates)

TEST(lines_and_polygons_of_geojson_become_constraints_with_a_number_each)
{
    cli_begin();
    load_lines("a.geojson",
               LINE("[[0,9],[1,9],[2,9]]")
                   POLYGON("[[[0,0],[8,0],[8,8],[0,0]],[[5,2],[6,2],[6,3],[5,2]]]")
                       FEATURE("{}", "MultiLineString", "[[[0,20],[1,20]],[[0,21],[1,21]]]"),
               "",
               "OK 10\n0 1 line 0\n1 2 line 0\n3 4 border 1\n3 5 border 1\n4 5 border 1\n"
               "6 7 border 1\n6 8 border 1\n7 8 border 1\n9 10 line 2\n11 12 line 3\n",
               "OK 13\n0 0 9\n1 1 9\n2 2 9\n3 0 0\n4 8 0\n5 8 8\n6 5 2\n7 6 2\n8 6 3\n9 0 20\n"
               "10 1 20\n11 0 21\n12 1 21\n");
    load_lines("a.geojson",
               FEATURE("null", "MultiPolygon",
                       "[[[[0,0],[1,0],[0,1],[0,0]]],"
                       "[[[5,0],[6,0],[5,1],[5,0]]]]"),
               "--of 7",
               "OK 6\n0 1 border 7\n0 2 border 7\n1 2 border 7\n3 4 border 8\n3 5 border 8\n"
               "4 5 border 8\n",
               "OK 6\n0 0 0\n1 1 0\n2 0 1\n3 5 0\n4 6 0\n5 5 1\n");
    load_lines("a.geojson",
               FEATURE("{\"kind\":\"border\",\"number\":5}", "LineString", "[[0,0],[1,0]]"), "",
               "OK 1\n0 1 border 5\n", "OK 2\n0 0 0\n1 1 0\n");
    load_lines("a.geojson", LINE("[[0,0],[1,0]]"), "--border", "OK 1\n0 1 border 0\n",
               "OK 2\n0 0 0\n1 1 0\n");
    load_lines("a.geojson", LINE("[[0,0],[1,0]]"), "--points", "OK 0\n", "OK 2\n0 0 0\n1 1 0\n");
    cli_finish();
}

TEST(lines_that_meet_have_a_common_point_unless_its_values_differ)
{
    cli_begin();
    load_lines("a.geojson", LINE("[[0,0],[1,0]]") LINE("[[1,0],[1,1]]"), "",
               "OK 2\n0 1 line 0\n1 2 line 1\n", "OK 3\n0 0 0\n1 1 0\n2 1 1\n");
    load_lines("a.geojson", LINE("[[0,0,1],[1,0,2]]") LINE("[[1,0,3],[1,1,4]]"), "",
               "OK 2\n0 1 line 0\n2 3 line 1\n", "OK 4\n0 0 0\n1 1 0\n2 1 0\n3 1 1\n");
    load_lines("a.geojson", FEATURE("{}", "Point", "[1,0]") LINE("[[0,0],[1,0]]"), "",
               "OK 1\n1 2 line 0\n", "OK 3\n0 1 0\n1 0 0\n2 1 0\n");
    cli_finish();
}

TEST(empty_features_and_rings_that_say_nothing_are_named_and_left_out)
{
    cli_begin();
    load_says("a.geojson",
              LINE("[]") FEATURE("{}", "Polygon", "[]")
                  POLYGON("[[]]") "{\"type\":\"GeometryCollection\",\"geometries\":[]}\n",
              "", 0, "3 without a place (a geometry that is null or empty)");
    cli_run_well("drop t");
    load_says("a.geojson", LINE("[[1,1],[1,1],[2,1]]"), "", 0,
              "1 step of a line has no length and is left out");
    cli_expect("constraints t", "OK 1\n0 1 line 0\n");
    cli_run_well("drop t");
    load_says("a.geojson", POLYGON("[[[0,0],[1,0],[1,1]]]"), "", 0,
              "1 ring does not end where it begins; it is closed");
    cli_run_well("drop t");
    load_says("a.geojson", POLYGON("[[[0,0],[1,0],[0,0]]]"), "", 0,
              "1 ring has fewer than three corners and is left out");
    cli_expect("constraints t", "OK 0\n");
    cli_run_well("drop t");
    load_says("a.geojson", POLYGON("[[[0,0],[1,0],[1,1],[0,0]],[[1,1],[0,0],[1,0],[1,1]]]"), "", 0,
              "1 ring is there twice in its polygon; it counts once");
    cli_expect("constraints t", "OK 3\n0 1 border 0\n0 2 border 0\n1 2 border 0\n");
    cli_finish();
}

TEST(a_side_that_two_rings_of_a_polygon_have_is_no_border)
{
    cli_begin();
    load_lines("a.geojson", POLYGON("[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[4,0],[4,4],[2,2],[4,0]]]"),
               "", "OK 5\n0 1 border 0\n0 3 border 0\n1 4 border 0\n2 3 border 0\n2 4 border 0\n",
               "OK 5\n0 0 0\n1 4 0\n2 4 4\n3 0 4\n4 2 2\n");
    cli_finish();
}

TEST(lines_of_gmt_begin_with_a_mark)
{
    cli_begin();
    load_lines("a.gmt", "> one\n0 0\n1 0\n> border 7\n5 5\n6 5\n6 6\n5 5\n", "",
               "OK 4\n0 1 line 0\n2 3 border 7\n2 4 border 7\n3 4 border 7\n",
               "OK 5\n0 0 0\n1 1 0\n2 5 5\n3 6 5\n4 6 6\n");
    load_lines("a.txt", "0 0\n1 0\n>\n0 1\n1 1\n", "", "OK 2\n0 1 line 0\n2 3 line 1\n",
               "OK 4\n0 0 0\n1 1 0\n2 0 1\n3 1 1\n");
    load_lines("a.gmt",
               "# @VGMT1.0 @GPOLYGON\n>\n# @P\n0 0\n9 0\n0 9\n0 0\n>\n# @H\n1 1\n2 1\n1 2\n1 1\n",
               "",
               "OK 6\n0 1 border 0\n0 2 border 0\n1 2 border 0\n3 4 border 0\n3 5 border 0\n"
               "4 5 border 0\n",
               "OK 6\n0 0 0\n1 9 0\n2 0 9\n3 1 1\n4 2 1\n5 1 2\n");
    cli_finish();
}

TEST(geometries_of_a_column_of_wkt_become_constraints)
{
    cli_begin();
    load_lines("a.csv",
               "id,geom\n1,\"POLYGON ((0 0, 4 0, 4 4, 0 0), (3 1, 3.5 1, 3.5 1.5, 3 1))\"\n"
               "2,\"SRID=4326;MULTILINESTRING((0 5,1 5),(2 5,3 5))\"\n3,POINT (9 9)\n"
               "4,LINESTRING EMPTY\n5,\"GEOMETRYCOLLECTION(POINT (8 8),LINESTRING(7 7, 7 8))\"\n"
               "6,\"MULTIPOINT((20 0),(21 0))\"\n",
               "",
               "OK 9\n0 1 border 0\n0 2 border 0\n1 2 border 0\n3 4 border 0\n3 5 border 0\n"
               "4 5 border 0\n6 7 line 1\n8 9 line 2\n12 13 line 3\n",
               "OK 16\n0 0 0\n1 4 0\n2 4 4\n3 3 1\n4 3.5 1\n5 3.5 1.5\n6 0 5\n7 1 5\n8 2 5\n"
               "9 3 5\n10 9 9\n11 8 8\n12 7 7\n13 7 8\n14 20 0\n15 21 0\n");
    load_lines("a.csv", "WKT,kind,number\n\"LINESTRING Z (0 0 1,1 0 2)\",border,6\n", "",
               "OK 1\n0 1 border 6\n", "OK 2\n0 0 0\n1 1 0\n");
    load_says(
        "a.csv", "g\n\"LINESTRING (0 0, 1)\"\n\"LINESTRING (0 0, 1 1)\"\n", "", 1,
        "a.csv:2: no points, lines or polygons in well-known text, at \")\"; nothing was loaded");
    load_says("a.csv", "g\n\"POLYGON ((0 0, 1 1, 1 0, 0 0)\"\n\"LINESTRING (0 0, 1 1)\"\n",
              "--skip-bad", 0, "a.csv:2: skipped, no points, lines or polygons in well-known text");
    cli_expect("constraints t", "OK 1\n0 1 line 0\n");
    load_says("a.csv", "g\n\"TIN (((0 0, 4 0, 0 4, 0 0)))\"\n", "", 1,
              "a.csv:2: no points, lines or polygons in well-known text, at \"TIN");
    cli_finish();
}

TEST(measures_of_wkt_are_no_heights_and_lose_no_row)
{
    cli_begin();
    load_lines("a.csv", "POLYGON M ((0 0 7,4 0 7,4 4 7,0 0 7))\nlinestring m (10 0 7,14 0 7)\n", "",
               "OK 4\n0 1 border 0\n0 2 border 0\n1 2 border 0\n3 4 line 1\n",
               "OK 5\n0 0 0\n1 4 0\n2 4 4\n3 10 0\n4 14 0\n");
    cli_write("a.csv", "WKT\n\"LINESTRING ZM (0 0 5 1,4 0 6 1)\"\n\"LINESTRINGM (1 1 7,2 1 7)\"\n");
    char command[300];
    snprintf(command, sizeof command, "load t %s", cli_path("a.csv"));
    cli_run_well(command);
    cli_expect("fget t z 0 1", "OK 2\n0 5\n1 6\n");
    cli_finish();
}

TEST(curves_of_wkt_are_named_with_what_makes_lines_of_them)
{
    cli_begin();
    load_says("a.csv", "WKT,name\n\"CURVEPOLYGON (CIRCULARSTRING (0 0,4 0,4 4,0 4,0 0))\",a\n", "",
              1,
              "a.csv:2: CURVEPOLYGON has curves, and only straight lines are read; ogr2ogr -nlt "
              "CONVERT_TO_LINEAR");
    load_says("a.csv", "CIRCULARSTRING Z (0 0 1,4 0 1,4 4 1)\n", "", 1,
              "a.csv:1: CIRCULARSTRING has curves");
    load_says("a.csv", "g\nSRID=4326;MULTISURFACE(CURVEPOLYGON((0 0,1 0,0 1,0 0)))\n", "", 1,
              "a.csv:2: MULTISURFACE has curves");
    load_says("a.csv",
              "g\n\"GEOMETRYCOLLECTION(POINT (8 8),COMPOUNDCURVE((0 0,1 0)))\"\n"
              "\"LINESTRING (0 0, 1 1)\"\n",
              "--skip-bad", 0, "a.csv:2: skipped, COMPOUNDCURVE has curves");
    cli_expect("constraints t", "OK 1\n0 1 line 0\n");
    cli_expect("points t", "OK 2\n0 0 0\n1 1 1\n");
    cli_finish();
}

TEST(run_inside_of_lines_without_borders_says_how_to_make_borders)
{
    char command[300];
    int status;
    cli_begin();
    cli_write("a.csv", "WKT\n\"LINESTRING (0 0,4 0,4 4,0 0)\"\n");
    snprintf(command, sizeof command, "run %s - -f obj --inside any", cli_path("a.csv"));
    CHECK(strstr(cli_run(&status, command), "load lines with --border") != NULL && status == 1);
    strcat(command, " --border");
    const char *got = cli_run(&status, command);
    CHECK_MSG(strstr(got, "f 1 2 3") != NULL && status == 0, "%s", got);
    cli_finish();
}

TEST(a_polygon_in_a_table_may_have_a_hundred_thousand_corners)
{
    enum { CORNERS = 100000 };
    char *text = malloc(40 * CORNERS + 100), command[300];
    size_t n = (size_t)sprintf(text, "id,geom\n1,\"POLYGON ((");
    cli_begin();
    for (int i = 0; i < CORNERS; i++) /* along a parabola */
        n += (size_t)sprintf(text + n, "%d.5 %.0f.25, ", i, (double)i * i);
    sprintf(text + n, "0.5 0.25))\"\n2,POINT (1 7)\n");
    cli_write("a.csv", text);
    snprintf(command, sizeof command, "load t %s", cli_path("a.csv"));
    CHECK(strstr(cli_run(&(int){0}, command), "added=100001 coincident=0") != NULL);
    CHECK(strstr(cli_run(&(int){0}, "constraints t 0"), "OK 2\n") != NULL);
    cli_finish();
    free(text);
}

TEST(lines_that_cross_are_named_by_line_and_feature_and_load_nothing)
{
    cli_begin();
    load_says("a.geojson", LINE("[[0,0],[4,4]]") POLYGON("[[[0,4],[4,0],[9,9],[0,4]]]"), "", 1,
              "a.geojson: border 1 of feature 2 in line 2 crosses line 0 of feature 1 in line 1");
    cli_expect("sets", "OK 0\n");
    load_says("a.gmt", ">\n0 0\n4 4\n0 4\n4 0\n", "", 1,
              "line 0 of line 1 crosses itself at about 2 2; "
              "nothing was loaded (--split adds points where lines cross)");
    cli_expect("sets", "OK 0\n");
    cli_run_well("add t 0 0  4 4");
    cli_run_well("triangulate t");
    cli_run_well("constrain t 0 1");
    load_says("a.gmt", ">\n0 4\n4 0\n", "", 1,
              "crosses the constraint 0 1 of the set; nothing was loaded (--split ");
    cli_expect("points t", "OK 2\n0 0 0\n1 4 4\n");
    cli_expect("constraints t", "OK 1\n0 1 line 0\n");
    cli_finish();
}

TEST(load_of_lines_reports_them_in_json_and_before_it_loads)
{
    cli_begin();
    load_says(
        "a.geojson", LINE("[[0,0],[4,4],[5,5]]"), "--dry-run", 0,
        "points: 3, lines skipped: 0, coincident with earlier points: 0, paths: 1 of 2 segments\n");
    load_says("a.geojson", LINE("[[0,0],[4,4],[5,5]]"), "", 0, "OK 0 first=0 added=3 coincident=0");
    cli_expect("ttl t", "OK 0\n");
    CHECK(strstr(cli_run(&(int){0}, "stat t"), "triangulated=yes") != NULL);
    cli_finish();
}

TEST(run_and_draw_keep_the_lines_of_a_file)
{
    char command[300];
    int status;
    cli_begin();
    cli_write("a.gmt", ">\n0 0\n4 0\n>\n2 -1\n2 1\n>\n");
    snprintf(command, sizeof command, "run %s - -f ele", cli_path("a.gmt"));
    CHECK(strstr(cli_run(&status, command), "line 1 of line 3 crosses") == NULL && status == 1);
    cli_write("a.gmt", ">\n0 0\n4 0\n>\n2 1\n2 9\n2 -1\n");
    cli_write("a.gmt", ">\n0 0\n8 0\n>\n4 1\n5 1\n>\n4 -1\n5 -1\n");
    snprintf(command, sizeof command, "run %s - -f edge", cli_path("a.gmt"));
    CHECK(strstr(cli_run(&status, command), " 0 1 0\n") != NULL && status == 0);
    snprintf(command, sizeof command, "draw %s -", cli_path("a.gmt"));
    CHECK(strstr(cli_run(&status, command), "class=\"c\"") != NULL && status == 0);
    cli_finish();
}

TEST(lines_that_cross_get_points_with_split)
{
    cli_begin();
    load_says("a.geojson", LINE("[[0,0,0],[4,4,8]]") POLYGON("[[[0,4],[4,0],[9,9],[0,4]]]"),
              "--split", 0, "constraints=6 split=2 deviation=0");
    cli_expect("constraints t OF 0", "OK 2\n0 5 line 0\n1 5 line 0\n");
    cli_expect("fget t z 5", "OK 1\n5 4\n");
    load_says("a.gmt", ">\n0 1\n3 1\n", "--split", 0, "added=3 ");
    CHECK(strstr(cli_run(&(int){0}, "check t"), "delaunay=yes points=9 ") != NULL);
    cli_finish();
}
