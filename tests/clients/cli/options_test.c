/* options_test.c - options that are wrong, lack what they need, or exclude each other are refused with a reason. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

TEST(every_command_reports_the_option_that_is_wrong)
{
    static const char *const wrong[][2] = {
        {"--nonsense sets", "delaunay: unknown option --nonsense\nTry 'delaunay --help'.\n"},
        {"-p", "delaunay: the option -p needs a value\nTry 'delaunay --help'.\n"},
        {"-u here sets",
         "delaunay: here is not delaunay://[:token@]host[:port] or unix://[:token@]/path\n"},
        {"export t - --box 1", "delaunay: unknown option --box\nTry 'delaunay export --help'.\n"},
        {"export t - --colour red",
         "delaunay: unknown colour red; there are angle, quality, degree and relief\n"},
        {"export t - --viewport 1,1,0,0", "delaunay: the viewport 1,1,0,0 is not X0,Y0,X1,Y1"},
        {"export t - -f dwg",
         "delaunay: unknown format dwg; there are svg, png, obj, ply, off, 2dm, node, ele, neigh, "
         "edge, wkt, csv, geojson, ndjson, poly, gmt\n"},
        {"show t --wide", "delaunay: unknown option --wide\nTry 'delaunay show --help'.\n"},
        {"show t --width 0", "delaunay: a width or height is from 1 to 2000, not 0\n"},
        {"trace t a --slow", "delaunay: unknown option --slow\n"},
        {"trace t a --seconds 0", "delaunay: --seconds is from 1 to 36000, not 0\n"},
        {"top --always", "delaunay: top takes no argument --always\n"},
    };
    cli_begin();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        int status;
        const char *got = cli_run(&status, wrong[i][0]);
        CHECK_MSG(status == 2 && strncmp(got, wrong[i][1], strlen(wrong[i][1])) == 0, "%s: %s",
                  wrong[i][0], got);
    }
    cli_finish();
}

/* Options that would have no effect are refused, and the message names what is missing. */
TEST(every_option_without_what_it_needs_is_wrong)
{
    static const char *const wrong[][2] = {
        {"draw p.csv p.svg --limit 5", "--limit needs --angle, --area or --length"},
        {"run p.csv p.obj --keep", "--keep needs --angle, --area or --length"},
        {"draw p.csv --colour angle", "--colour needs a picture"},
        {"draw p.csv --numbers", "--numbers needs a picture with points"},
        {"draw p.csv -f svg", "--format needs a file to write"},
        {"draw p.csv --lines", "--lines needs a file to write"},
        {"draw p.csv --crs EPSG:4326", "--crs needs GeoJSON"},
        {"draw p.csv --inside any", "--inside needs a mesh or a picture, --angle, --area or"},
        {"draw p.csv p.svg --field z", "--field needs heights (--colour relief, or a format that"},
        {"draw p.csv p.svg --colour relief --numbers", "--numbers needs a picture with points"},
        {"run p.csv p.wkt --field z", "--field needs heights"},
        {"run p.csv p.obj --viewport 0,0,1,1", "--viewport needs a picture"},
        {"run p.csv p.gmt --inside any", "--inside needs a mesh or a picture"},
        {"export t t.obj --crs EPSG:4326", "--crs needs GeoJSON"},
        {"export t - --geographic --planar", "--geographic, or --planar"},
        {"raster t z t.asc --colour light", "--colour needs a picture"},
        {"raster t z - --crs EPSG:4326", "--crs needs a file to write"},
        {"raster t z - --width 3 --cell 1", "--cell, or --width"},
        {"contour t z - --no-labels", "--no-labels needs a picture"},
        {"contour t z t.wkt --viewport 0,0,1,1", "--viewport needs a picture"},
        {"contour t z t.svg --crs EPSG:4326", "--crs needs GeoJSON"},
        {"contour t z - --levels 1 --base 2", "--levels, or --every and --base"},
        {"contour t z - --levels 1 --every 2", "--levels, or --every and --base"},
        {"voronoi t - --field nosuch", "--field needs a picture"},
        {"voronoi t - -f wkt --crs EPSG:4326", "--crs needs GeoJSON"},
        {"alpha t 3 - --viewport 0,0,1,1", "--viewport needs a picture"},
        {"show t --field z --mesh", "--field, or --mesh"},
        {"draw p.csv p.svg --error -1", "--error is a height from 0 on, not -1"},
        {"draw p.csv p.svg --most 2.5", "--most is a number of points, not 2.5"},
        {"draw p.csv p.svg --angle nan", "a limit is a number above 0, not nan"},
        {"draw p.csv p.svg --angle 20 --limit 1e9", "--limit is a number of points, not 1e9"},
        {"copy t", "copy takes a set and two URLs"},
        {"copy t delaunay://h:x delaunay://h", "delaunay://h:x is not delaunay://[:token@]host"},
        {"copy t delaunay://h nowhere", "nowhere is not delaunay://[:token@]host"},
        {"copy t/u delaunay://h delaunay://h", "t/u: a set's name is 1 to 64 of the characters"},
    };
    cli_begin();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        int status;
        const char *got = cli_run(&status, wrong[i][0]);
        CHECK_MSG(status == 2 && strstr(got, wrong[i][1]) == got + strlen("delaunay: "), "%s: %s",
                  wrong[i][0], got);
    }
    cli_finish();
}

/* The pairs that are allowed have an effect, or say what the data is. */
TEST(options_with_what_they_need_are_taken)
{
    static const char *const good[] = {"export t - --colour relief --field z",
                                       "export t - -f obj --field z",
                                       "export t - -f geojson --crs EPSG:32629",
                                       "export t - -f geojson --lines --crs EPSG:32629",
                                       "export t - -f gmt --field z",
                                       "export t - -f csv --field z",
                                       "export t - -f geojson --field z",
                                       "export t - -f node --field z",
                                       "raster t z - --cell 1 --as slope",
                                       "contour t z - --crs EPSG:32629",
                                       "contour t z - -f svg --no-labels",
                                       "contour t z - -f svg --bands --no-labels",
                                       "contour t z - --levels 1,2 --bands",
                                       "voronoi t - -f svg --field z",
                                       "voronoi t - --crs EPSG:32629 --geographic",
                                       "alpha t 9 - -f json --crs EPSG:32629",
                                       "show t --field z --width 20",
                                       "voronoi t - --viewport 0,0,5,5"};
    cli_begin();
    cli_run_well("ADD t 0 0  9 0  0 9");
    cli_run_well("FSET t z  0 1  1 2  2 3");
    cli_run_well("triangulate t");
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        cli_run_well(good[i]);
    cli_finish();
}

TEST(an_option_may_be_repeated_any_number_of_times)
{
    char many[3000] = "export t - --force";
    int status;
    cli_begin();
    for (size_t n = strlen(many); n + 20 < sizeof many; n += strlen(many + n))
        snprintf(many + n, sizeof many - n, " --geographic");
    CHECK(strstr(cli_run(&status, many), "ERR NOSET") != NULL && status == 1);
    strcat(many, " --planar");
    CHECK(strstr(cli_run(&status, many), "--geographic, or --planar") != NULL && status == 2);
    cli_finish();
}
