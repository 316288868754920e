/* survey_test.c - the notes about the values of a file: degrees, missing values, coincident points. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/files/tables.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

#define CSV ".csv"

TEST(degrees_with_minutes_seconds_and_hemispheres_are_read)
{
    tables_expect(CSV, "lat;lon\n53.5N;6.25W\n33.5S;151.5E\n", "-6.25 53.5; 151.5 -33.5",
                  "read: lat is read in degrees, as \"53.5N\" in line 2");
    tables_expect(CSV, "lat;lon\n53\xC2\xB0 30' 0\" N;6\xC2\xB0 15' 0\" W\n", "-6.25 53.5", NULL);
    tables_expect(CSV,
                  "lat;lon\n53\xB0"
                  "30'00''N;6\xB0"
                  "15'W\n",
                  "-6.25 53.5", NULL);
    tables_expect(CSV, "lat,lon\nN 53.5,W 6.25\n", "-6.25 53.5", NULL);
    tables_expect(CSV, "lat,lon\n-53:30:00,6:15:00\n-54:30:00,7:15:00\n", "6.25 -53.5; 7.25 -54.5",
                  NULL);
    tables_expect(CSV, "lat,lon\n53.5\xC2\xB0,-6.25\xC2\xB0\n", "-6.25 53.5", NULL);
    tables_refuse(CSV, "lat,lon\n53.5N,6.25N\n53.5N,6.25W\n",
                  "not a number: \"6.25N\" in column lon");
    tables_refuse(CSV, "lat,lon\n53:75:00,6\n53:15:00,6\n", "not a number: \"53:75:00\"");
}

TEST(latitudes_to_the_south_and_longitudes_to_the_west_that_are_positive_are_a_doubt)
{
    tables_expect(CSV, "Latitude (S),Longitude (E)\n33.1,151.2\n33.3,151.9\n",
                  "151.2 33.1; 151.9 33.3",
                  "Latitude (S) is positive, so the map is a mirror image; "
                  "--negate y turns it");
    tables_expect(CSV, "lat [\xC2\xB0N],lon [\xC2\xB0W]\n33.1,151.2\n", "151.2 33.1",
                  "lon [\xC2\xB0W] is positive");
    tables_expect(CSV, "lat_N,lon_West\n33.1,151.2\n", "151.2 33.1", "lon_West is positive");
    tables_expect(CSV, "Latitude (S),Longitude (E)\n-33.1,151.2\n", "151.2 -33.1",
                  "using x=Longitude (E) y=Latitude (S)\n");
}

TEST(latitudes_beyond_90_degrees_are_a_doubt)
{
    tables_expect(CSV, "lat,lon\n11.5,148\n151,33\n", "148 11.5; 33 151",
                  "doubt: latitudes beyond 90 degrees: 1\n");
    tables_expect(CSV, "lat,lon\n151.2,-33.1\n151.9,-33.2\n", "-33.1 151.2; -33.2 151.9",
                  "they seem to be swapped");
    tables_expect(CSV, "lat,lon\n48,400\n", "400 48", "longitudes beyond 360 degrees: 1");
    tables_expect(CSV, "x,y\n148,151\n", "148 151", "");
}

TEST(positions_of_geojson_whose_axes_seem_to_be_swapped_are_a_doubt)
{
    tables_expect(".geojson",
                  "{\"type\":\"MultiPoint\",\"coordinates\":[[-33.9,151.2],[-37.8,145.0]]}",
                  "-33.9 151.2; -37.8 145", "they seem to be swapped");
    tables_expect(".geojson",
                  "{\"type\":\"MultiPoint\",\"coordinates\":[[151.2,-33.9],[145.0,-37.8]]}",
                  "151.2 -33.9; 145 -37.8", "");
}

TEST(places_that_may_mean_missing_are_a_doubt)
{
    tables_expect(CSV, "x,y\n500,700\n501,700\n502,701\n-9999,-9999\n",
                  "500 700; 501 700; 502 701; -9999 -9999",
                  "x: -9999 in 1 of 4 points, far from the others (500 to 502), may mean missing");
    tables_expect(CSV, "lat,lon\n53,-6\n54,-7\n52,-8\n0,0\n", "-6 53; -7 54; -8 52; 0 0",
                  "1 of 4 points are at 0 0, far from the others");
    tables_expect(CSV, "lat,lon\n53,-6\n1,-7\n52,1\n0,0\n", "-6 53; -7 1; 1 52; 0 0", "");
}

TEST(longitudes_of_two_kinds_are_a_doubt)
{
    tables_expect(CSV, "lat,lon\n53,359.5\n53,-0.5\n", "359.5 53; -0.5 53",
                  "longitudes from -0.5 to 359.5: some seem to begin at -180");
    tables_expect(CSV, "lat,lon\n53,359.5\n53,0.5\n", "359.5 53; 0.5 53", "");
}

TEST(heights_that_may_mean_missing_are_a_doubt)
{
    tables_expect(
        ".xyz", "0 0 100\n1 0 110\n1 1 -9999\n0 1 -9999\n",
        "0 0 100; 1 0 110; 1 1 -9999; 0 1 -9999",
        "doubt: z: -9999 in 2 of 4 values, far from the others (100 to 110); --nodata -9999 "
        "makes them missing");
    tables_expect(CSV, "x,y,z\n0,0,100\n1,0,-99999\n", "0 0 100; 1 0 -99999", "--nodata -99999");
    tables_expect(CSV, "x,y,z\n0,0,100\n1,0,1.70141e38\n", "0 0 100; 1 0 1.70141e+38", "--nodata");
    tables_expect(CSV, "x,y,z\n0,0,-98\n1,0,-99\n", "0 0 -98; 1 0 -99", "using x=x y=y z=z\n");
    tables_expect(CSV, "x,y,z\n0,0,-9999\n1,0,-9999\n", "0 0 -9999; 1 0 -9999",
                  "all values are -9999, which may mean missing");
}

TEST(a_height_of_minus_999_below_mountains_is_a_doubt_and_the_deepest_of_many_is_not)
{
    tables_expect(CSV, "x,y,z\n0,0,0\n1,0,5000\n2,0,-999\n", "0 0 0; 1 0 5000; 2 0 -999",
                  "--nodata -999");
    tables_expect(CSV, "x,y,z\n0,0,-900\n1,0,-950\n2,0,-999\n3,0,0\n",
                  "0 0 -900; 1 0 -950; 2 0 -999; 3 0 0", "using x=x y=y z=z\n");
}

static void choose_nodata(struct source *s)
{
    s->wish = (struct survey_wish){
        .nodata = {-9999, 0}, .nodata_n = 2, .negate = {"z", "x"}, .negate_n = 2};
}

TEST(values_that_mean_missing_are_chosen_and_signs_are_changed)
{
    struct outcome o;
    static const char text[] = "x,y,depth\n0,0,100\n1,0,-9999\n2,0,0\n";
    tables_read(&o, CSV, text, strlen(text), choose_nodata);
    CHECK_STR(o.points, "0 0 -100; -1 0 nan; -2 0 nan");
    CHECK(strstr(o.notes, "z: -9999 means missing, 1 times") != NULL);
    CHECK(strstr(o.notes, "z: 2 of 3 values are missing") != NULL);
    CHECK(strstr(o.notes, "what is deeper") == NULL);
}

static void choose_unknown(struct source *s)
{
    s->wish = (struct survey_wish){.negate = {"w"}, .negate_n = 1};
}

TEST(a_sign_of_what_is_not_there_cannot_be_changed)
{
    struct outcome o;
    tables_read(&o, CSV, "x,y,z\n0,0,1\n", 12, choose_unknown);
    CHECK(!o.read);
    CHECK_STR(o.points, "0: no field w to negate; there are x, y, z");
}

TEST(depths_that_become_heights_are_a_doubt)
{
    tables_expect(CSV, "x,y,Tiefe\n0,0,5\n1,0,6\n", "0 0 5; 1 0 6",
                  "z is Tiefe as it is, so what is deeper is higher; --negate z turns it");
    tables_expect(CSV, "x,y,depth\n0,0,-5\n1,0,-6\n", "0 0 -5; 1 0 -6", "using x=x y=y z=depth\n");
}

/* ---- through the program ---- */

/* Runs `delaunay BEFORE FILE AFTER`. */
static void expect(const char *before, const char *file, const char *after, int want_status,
                   const char *want)
{
    char command[300];
    int status;
    snprintf(command, sizeof command, "%s %s %s", before, cli_path(file), after);
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == want_status && strstr(got, want) != NULL, "%s: %d: %s", command, status,
              got);
}

TEST(coincident_points_with_different_values_are_reported_by_load_run_and_draw)
{
    static const char note[] =
        "2 of 3 coincident points have other values than the first point there, as z at 0 0";
    cli_begin();
    cli_write("a.csv", "x,y,z\n0,0,1\n1,0,2\n1,1,3\n0,1,4\n0,0,9\n1,1,3\n-0.0,0,8\n");
    expect("load t", "a.csv", "", 0, note);
    expect("run", "a.csv", "- -f csv", 0, note);
    expect("draw", "a.csv", "- -f svg", 0, note);
    expect("--json run", "a.csv", "- --dry-run", 0, note);
    expect("--json run", "a.csv", "- --dry-run", 0, "\"coincident\":3");
    cli_write("b.csv", "x,y,z\n0,0,1\n1,0,2\n1,1,3\n0,0,1\n");
    expect("load u", "b.csv", "", 0, "z=z\nOK 0 first=0 added=4 coincident=1");
    cli_finish();
}

TEST(a_dry_run_shows_how_a_file_is_read_and_changes_nothing)
{
    cli_begin();
    cli_write("a.csv", "id;lat;lon;H\xF6he\n1;48,5;11;500\n2;49;12;\n3;49;12;510\n");
    expect(
        "load t", "a.csv", "--dry-run", 0,
        ": points: 3, lines skipped: 0, coincident with earlier points: 1\n"
        "  values between semicolons, with decimal commas; heading in line 1; points from line 2 "
        "on\n"
        "  column                   use                    from               to   missing\n"
        "  1 id                     not used\n"
        "  2 lat                    y                      48.5               49         0\n"
        "  3 lon                    x                        11               12         0\n");
    expect("load t", "a.csv", "--dry-run", 0,
           "z                       500              510         1\n");
    expect("load t", "a.csv", "--dry-run", 0, "columns not used: id (--fields keeps");
    expect("-p 1 load t", "a.csv", "--dry-run", 0, "points: 3"); /* needs no server */
    cli_expect("sets", "OK 0\n");
    cli_write("b.csv", "x,y\n1,b\n2,3\n");
    expect("--json load t", "b.csv", "--dry-run", 1, "\"message\":\"/tmp/");
    expect("--json load t", "b.csv", "--dry-run --skip-bad", 0,
           "\"skipped_lines\":[{\"line\":2,\"fault\":\"not a number: \\\"b\\\" in column "
           "y\",\"text\":\"1,b\"}]");
    expect("--json load t", "b.csv", "--skip-bad", 0, "\"added\":1,\"coincident\":0,");
    cli_finish();
}

TEST(options_for_reading_are_the_same_for_load_run_and_draw)
{
    cli_begin();
    cli_write("a.csv", "title\nx,y,depth\n0,0,5\n4,0,-999\n0,4,7\n");
    expect("run", "a.csv", "- -f node --nodata -999 --negate z --skip-lines 1", 0,
           "3 2 1 1\n0 0 0 -5 1\n1 4 0 nan 1\n2 0 4 -7 1\n");
    expect("load t", "a.csv", "--nodata -999 --negate z --skip-lines 1", 0, "added=3");
    cli_expect("fget t z 0 1 2", "OK 3\n0 -5\n1 nan\n2 -7\n");
    expect("load t", "a.csv", "--nodata none", 2, "--nodata none is not a number");
    expect("load t", "a.csv", "--nodata 1e400", 2, "--nodata 1e400 is not a number, or too large");
    expect("load t", "a.csv", "--skip-lines -1", 2, "--skip-lines -1 is not a number of lines");
    expect("load t", "a.csv", "--negate w", 1, "no field w to negate; there are x, y, z");
    cli_finish();
}

TEST(options_that_a_file_makes_useless_are_noted)
{
    cli_begin();
    cli_write("p.csv", "x,y\n0,0\n4,0\n0,4\n");
    cli_write("p.geojson", "{\"type\":\"MultiPoint\",\"coordinates\":[[0,0],[1,1]]}");
    expect("load t", "p.csv", "--nodata 3", 0, "--nodata is not used: the points have no values");
    cli_write("z.csv", "x,y,z\n0,0,1\n4,0,2\n0,4,3\n");
    expect("load u", "z.csv", "--nodata 7 --nodata 3", 0, "--nodata 7 is not used: no value is");
    expect("load u", "z.csv", "--nodata 7 --nodata 3", 0, "z: 3 means missing, 1 times");
    expect("load t", "p.csv", "--border", 0, "--border and --of are not used: there are no lines");
    expect("load t", "p.geojson", "--skip-lines 1", 0, "--skip-lines is not used: the file is no");
    expect("load t", "p.geojson", "--columns 1,2 --format geojson", 0, "--columns is not used");
    expect("load t", "p.csv", "--columns 1,2 --skip-lines 1", 0, "added=3");
    cli_finish();
}

TEST(files_that_are_not_text_are_refused_with_a_reason)
{
    struct outcome o;
    tables_read(&o, CSV, "x,y\n1,2\n3,\0\n", 12, NULL);
    CHECK_STR(o.points, "3: not a text file: it has NUL bytes");
    tables_read(&o, CSV, "x\0,\0y\0\n\0001\0,\0002\0\n\0", 16, NULL);
    CHECK(strstr(o.points, "UTF-16 without a byte order mark") != NULL &&
          strstr(o.points, "UTF-16LE") != NULL);
    tables_read(&o, CSV, "\0x\0,\0y\0\n\0001\0,\0002\0\n", 16, NULL);
    CHECK(strstr(o.points, "UTF-16BE") != NULL);
    tables_expect(CSV, "\xEF\xBB\xBFx,y\n1,2\n", "1 2", "");
}
