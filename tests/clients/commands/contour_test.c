/* contour_test.c - `delaunay contour` with a real daemon. */
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

static unsigned count(const char *text, const char *what)
{
    unsigned n = 0;
    for (; (text = strstr(text, what)) != NULL; text++)
        n++;
    return n;
}

/* A pyramid of height 10 over a square. */
static void make_pyramid(void)
{
    cli_begin();
    cli_run_well("add t 0 0  4 0  4 4  0 4  2 2");
    cli_run_well("fset t z 0 0  1 0  2 0  3 0  4 10");
    cli_run_well("triangulate t");
}

TEST(contour_writes_lines_as_wkt_and_geojson)
{
    int status;
    make_pyramid();
    const char *out = cli_run(&status, "contour t z - -f wkt --levels 5");
    CHECK_MSG(status == 0 && count(out, "LINESTRING (") == 1 && count(out, ",") == 8, "%s", out);
    CHECK(strncmp(out, "WKT,level,closed\n\"LINE", 22) == 0 && strstr(out, ")\",5,true\n") != NULL);
    CHECK(strstr(out, "1 1") && strstr(out, "3 1") && strstr(out, "3 3") && strstr(out, "1 3"));
    out = cli_run(&status, "contour t z - --every 4");
    CHECK(status == 0 && count(out, "\"Feature\"") == count(out, "\"LineString\""));
    CHECK(count(out, "{\"level\":4,\"closed\":true}") == 1);
    CHECK(count(out, "{\"level\":8,\"closed\":true}") == 1);
    out = cli_run(&status, "contour t z - --every 4 --base 1");
    CHECK(count(out, "\"level\":5,") == 1 && count(out, "\"level\":9,") == 1);
    CHECK(count(out, "\"level\":4,") == 0);
    cli_finish();
}

TEST(contour_chooses_about_ten_round_levels)
{
    int status;
    make_pyramid();
    const char *out = cli_run(&status, "contour t z -");
    for (int level = 1; level < 10; level++) {
        char text[32];
        snprintf(text, sizeof text, "\"level\":%d,", level);
        CHECK_MSG(count(out, text) == 1, "%s", text);
    }
    cli_run_well("fset t z 0 3  1 3  2 3  3 3  4 3");
    cli_run(&status, "contour t z -");
    CHECK(status == 0);
    CHECK(strstr(cli_run(&status, "contour t y -"), "NOFIELD") != NULL && status == 1);
    cli_finish();
}

TEST(contour_accepts_levels_below_0)
{
    int status;
    make_pyramid();
    cli_run_well("fset t z 0 -10  1 -10  2 -10  3 -10  4 0");
    const char *out = cli_run(&status, "contour t z - --levels -7.5,-5,-2.5");
    CHECK(status == 0 && count(out, "\"Feature\"") == 3 && count(out, "\"level\":-7.5,") == 1);
    cli_finish();
}

TEST(contour_of_a_field_whose_name_has_a_comma_is_refused)
{
    int status;
    make_pyramid();
    CHECK(strstr(cli_run(&status, "contour t z,2 - --levels 5"), "ERR SYNTAX") != NULL);
    CHECK(status == 1);
    cli_finish();
}

TEST(contour_without_a_file_sends_the_request)
{
    int status;
    make_pyramid();
    const char *out = cli_run(&status, "contour t z 5");
    CHECK(status == 0 && strstr(out, "OK 1") == out && strstr(out, "\n5 closed 4 ") != NULL);
    cli_finish();
}

TEST(contour_skips_missing_values)
{
    int status;
    make_pyramid();
    cli_run_well("fset t z 4 nan  2 8");
    CHECK(count(cli_run(&status, "contour t z - -f wkt --levels 4"), "LINESTRING") == 0);
    const char *out = cli_run(&status, "contour t z - -f wkt --levels 4 --missing skip");
    CHECK_MSG(status == 0 && count(out, "LINESTRING") == 1, "%s", out);
    cli_finish();
}

TEST(contour_ends_at_the_border_that_an_option_names)
{
    int status;
    make_pyramid();
    cli_run_well("constrain t border of 3 ring 0 1 4");
    const char *out = cli_run(&status, "contour t z - -f wkt --levels 5 --inside any");
    CHECK_MSG(status == 0 && strstr(out, "(1 1,3 1)\",5,false") != NULL, "%s", out);
    CHECK(strstr(cli_run(&status, "contour t z - --inside 4"), "NOREGION") && status == 1);
    out = cli_run(&status, "regions t");
    CHECK_MSG(status == 0 && strstr(out, "\n3 closed 1 4\n") != NULL, "%s", out);
    cli_finish();
}

/* The line at half of the height has its number; GeoJSON has none, nor has a picture that shall not. */
TEST(contours_have_their_levels_along_them_in_pictures)
{
    int status;
    make_pyramid();
    const char *svg = cli_run(&status, "contour t z - -f svg --levels 1.25");
    CHECK(status == 0 && count(svg, ">1.25</text>") >= 2 && count(svg, "rotate(") >= 2);
    /* Of more than five levels the multiples of five steps are heavy, else each fifth. */
    svg = cli_run(&status, "contour t z - -f svg --every 0.25");
    CHECK(status == 0 && count(svg, ">1.25</text>") >= 2 && count(svg, ">1.5</text>") == 0);
    CHECK(count(svg, "class=\"l\"") == 1 && count(svg, "class=\"k\"") >= 1);
    svg = cli_run(&status, "contour t z - -f svg --levels 0.52,0.6,1.1,1.3,1.7,2.1");
    CHECK(status == 0 && count(svg, ">1.7</text>") >= 2 && count(svg, ">1.1</text>") == 0);
    svg = cli_run(&status, "contour t z - -f svg --levels 1.25 --no-labels");
    CHECK(status == 0 && count(svg, ">1.25</text>") == 0 && count(svg, "rotate(") == 0);
    cli_finish();
}

/* Three sides of the border and a line, bold; the other three triangles pale. */
TEST(constraints_are_bold_in_pictures_of_surfaces_and_the_outside_is_pale)
{
    int status;
    make_pyramid();
    cli_run_well("constrain t border ring 0 1 4");
    cli_run_well("constrain t 2 4");
    const char *svg = cli_run(&status, "contour t z - -f svg --levels 5");
    CHECK(status == 0 && count(svg, "class=\"c\"") == 1 && count(svg, "class=\"b\"") >= 1);
    CHECK(count(svg, "class=\"o\"") == 1 && count(svg, "<path fill=\"#") == 1 + 60);
    svg = cli_run(&status, "contour t z - -f svg --levels 0,5,10 --bands");
    CHECK(status == 0 && count(svg, "class=\"c\"") == 1 && count(svg, "class=\"b\"") >= 1);
    svg = cli_run(&status, "export t - --colour relief -f svg");
    CHECK(status == 0 && count(svg, "class=\"o\"") == 1 && count(svg, "class=\"b\"") >= 1);
    /* Heights outside do not matter for the colours inside. */
    char fill[30];
    snprintf(fill, sizeof fill, "%.20s", strstr(svg, "<path fill=\"#"));
    cli_run_well("add t 9 9");
    cli_run_well("fset t z 5 1000");
    svg = cli_run(&status, "export t - --colour relief -f svg");
    CHECK(status == 0 && strstr(svg, fill) != NULL);
    cli_finish();
}

TEST(bands_are_written_as_polygons)
{
    int status;
    make_pyramid();
    const char *out = cli_run(&status, "contour t z - --bands -f wkt --levels -inf,5,inf");
    CHECK(status == 0);
    CHECK_STR(out, "WKT,low,high\n"
                   "\"POLYGON ((0 0,4 0,4 4,0 4,0 0),(1 1,1 3,3 3,3 1,1 1))\",-inf,5\n"
                   "\"POLYGON ((1 1,3 1,3 3,1 3,1 1))\",5,inf\n");
    out = cli_run(&status, "contour t z - --bands");
    CHECK(status == 0 && count(out, "\"Polygon\"") == 10 && count(out, "]],[[") == 9);
    CHECK(count(out, "{\"low\":9,\"high\":10}") == 1);
    char command[300];
    snprintf(command, sizeof command, "contour t z %s --bands --every 5", cli_path("b.geojson"));
    out = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(out, "b.geojson: 2 polygons\n") != NULL, "%s", out);
    CHECK(strstr(cli_run(&status, "contour t z - --levels 5,inf"), "inf is not a number"));
    CHECK(status == 1);
    cli_finish();
}

TEST(bands_are_filled_in_pictures_with_a_legend)
{
    int status;
    make_pyramid();
    const char *out = cli_run(&status, "contour t z - --bands -f svg --levels -inf,2,4,6");
    CHECK(status == 0 && strncmp(out, "<svg", 4) == 0);
    CHECK(count(out, "<title>t: bands of z</title>") == 1);
    CHECK_MSG(count(out, ">2</text>") == 1 && count(out, ">4</text>") == 1 &&
                  count(out, ">6</text>") == 1,
              "%s", out);
    CHECK(count(out, "fill=\"#3e7b56\"") == 2 && count(out, "fill=\"#f5f4f2\"") == 2);
    CHECK(count(out, "fill=\"#") >= 6);
    out = cli_run(&status, "contour t z - --bands -f svg --levels 20,30");
    CHECK(status == 0 && count(out, "</svg>") == 1 && count(out, "fill=\"#3e7b56\"") == 0);
    cli_finish();
}

TEST(contour_refuses_invalid_options)
{
    static const char *const wrong[] = {
        "--levels 1,x",         "--levels 1,",  "--every x",
        "--levels 1 --every 2", "--format png", "--viewport 1",
        "--levels 1 --base 2",  "--inside -1",  "--levels 1,infinity"};
    char command[300];
    int status;
    make_pyramid();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(command, sizeof command, "contour t z - %s", wrong[i]);
        cli_run(&status, command);
        CHECK_MSG(status == 2, "%s", wrong[i]);
    }
    cli_write("a.wkt", "mine\n");
    snprintf(command, sizeof command, "contour t z %s", cli_path("a.wkt"));
    CHECK(strstr(cli_run(&status, command), "--force replaces it") != NULL && status == 1);
    cli_finish();
}
