/* draw_test.c - `delaunay draw` and `run`: from a file to a picture or a mesh without a server. */
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/folder.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

TEST(draw_makes_a_picture_of_a_file_without_a_server)
{
    folder_begin();
    folder_expect(
        "printf 'id,X_COORD,Y_COORD\\n1,0,0\\n2,4,0\\n3,4,4\\n4,0,4\\n5,2,2\\n' > a.csv && "
        "$D draw a.csv a.svg && grep -c '<title>a.csv: Delaunay triangulation of 5 points' a.svg",
        "delaunay: a.csv: using columns x=X_COORD y=Y_COORD\n"
        "delaunay: a.csv: columns not used: id (--fields keeps those of numbers)\n"
        "a.svg: 5 points, 4 triangles, hull of 4\n1\n");
    folder_expect("ls", "a.csv\na.svg\n");
    folder_finish();
}

TEST(draw_without_a_picture_draws_in_the_terminal)
{
    int status;
    folder_begin();
    const char *got = folder_run(&status, "printf '0 0\\n10 0\\n10 10\\n0 10\\n' | $D draw -");
    CHECK_MSG(status == 0 && strstr(got, "\xE2\xA1") != NULL, "%s", got);
    folder_finish();
}

TEST(run_writes_a_mesh_of_a_file_without_a_server)
{
    folder_begin();
    folder_expect(
        "printf '0 0\\nbad\\n4 0\\n0 4\\n' | $D run - - --format off --skip-bad 2>/dev/null",
        "OFF\n3 1 0\n0 0 0\n4 0 0\n0 4 0\n3 0 1 2\n");
    folder_expect(
        "printf '7,0,0\\n8,4,0\\n9,0,4\\n' > a.csv; $D run a.csv b.ele -c 2,3 && cat b.ele",
        "delaunay: a.csv: columns not used: 1 (--fields keeps those of numbers)\n"
        "b.ele: 3 points, 1 triangle, hull of 3\n1 3 0\n0 0 1 2\n");
    folder_finish();
}

TEST(draw_reports_errors_and_leaves_nothing)
{
    static const struct {
        const char *command, *want;
        int status;
    } cases[] = {
        {"$D draw none.csv a.svg", "delaunay: none.csv: No such file or directory\n", 1},
        {"$D draw empty.csv a.svg", "delaunay: empty.csv: there are no points in it\n", 1},
        {"$D draw p.xy mine.svg", "delaunay: mine.svg: there is such a file, not written", 1},
        {"$D draw p.xy a.obj", "delaunay: a picture is SVG or PNG; for other formats use", 2},
        {"$D draw p.xy a.dwg",
         "delaunay: unknown format dwg; there are svg, png, obj, ply, off, 2dm, node, ele, neigh, "
         "edge, wkt, csv, geojson, ndjson, poly, gmt\nTry 'delaunay draw --help'.\n",
         2},
        {"$D draw", "delaunay: draw takes a file of points and that of the picture\n", 2},
        {"$D run p.xy", "delaunay: run takes a file of points and that of the mesh\n", 2},
        {"$D run p.xy a.obj --quick", "delaunay: unknown option --quick\n", 2},
        {"DELAUNAYD=/none $D draw p.xy a.svg", "delaunay: /none: No such file or directory\n", 3},
        {"DELAUNAYD=/bin/true $D draw p.xy a.svg",
         "delaunay: /bin/true: it is not a daemon, or one without --private\n", 3},
    };
    int status;
    folder_begin();
    folder_run(&status, ": > empty.csv; echo '1 2' > p.xy; echo mine > mine.svg");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *got = folder_run(&status, cases[i].command);
        CHECK_MSG(status == cases[i].status &&
                      strncmp(got, cases[i].want, strlen(cases[i].want)) == 0,
                  "%s: %d: %s", cases[i].command, status, got);
    }
    folder_expect("ls; cat mine.svg", "empty.csv\nmine.svg\np.xy\nmine\n");
    folder_finish();
}

/* The process id in the file, 0 if there is none yet. */
static pid_t read_pid(const char *name)
{
    int status;
    return (pid_t)atol(peer_shell(&status, "cat %s/%s 2>/dev/null", folder, name));
}

/* The owner is killed before the daemon has begun. */
TEST(daemon_of_a_killed_draw_ends_and_leaves_no_socket)
{
    int status;
    pid_t own, daemon;
    folder_begin();
    folder_run(
        &status,
        "printf '#!/bin/sh\\necho $$ > daemon\\nkill -STOP $$\\nexec \"$REAL\" \"$@\"\\n' > d; "
        "chmod +x d; mkdir tmp; echo '1 2' > p.xy; export REAL=$DELAUNAYD DELAUNAYD=./d "
        "TMPDIR=$PWD/tmp; "
        "(sh -c 'echo $$ > own; exec $D draw p.xy a.svg' >/dev/null 2>&1 &)");
    for (int i = 0; i < 1000 && (read_pid("daemon") == 0 || read_pid("own") == 0); i++)
        usleep(10000);
    own = read_pid("own");
    daemon = read_pid("daemon");
    CHECK(own > 0 && daemon > 0 && kill(daemon, 0) == 0);
    CHECK(kill(own, SIGKILL) == 0);
    /* A signal only while it is stopped: more of them would keep the leak sanitizer from stopping its threads. */
    for (int i = 0; i < 1000 && kill(daemon, 0) == 0; i++) {
        const char *state =
            peer_shell(&status, "sed 's/.*) //; s/ .*//' /proc/%d/stat 2>/dev/null", (int)daemon);
        if (state[0] == 'Z') /* a zombie: its new parent may never wait for it */
            break;
        if (state[0] == 'T')
            kill(daemon, SIGCONT);
        usleep(10000);
        CHECK(i < 999);
    }
    folder_run(&status, "rmdir tmp");
    CHECK(status == 0);
    folder_finish();
}

TEST(draw_makes_a_map_where_the_file_says_that_coordinates_are_degrees)
{
    static const struct {
        const char *name, *text, *options;
        bool map;
    } file[] = {{"a.csv", "lon,lat\n0,50\n10,50\n0,70\n", "", true},
                {"a.csv", "lat,lon\n50,0\n50,10\n70,0\n", "", true},
                {"a.csv", "x,y\n0,50\n10,50\n0,70\n", "", false},
                {"a.csv", "x,y\n0,50\n10,50\n0,70\n", "--geographic", true},
                {"a.csv", "lon,lat\n0,50\n10,50\n0,70\n", "--planar", false},
                {"a.csv", "lon,lat\n0,5000\n10,50\n0,70\n", "", false},
                {"a.geojson", "{\"type\":\"MultiPoint\",\"coordinates\":[[0,50],[10,50],[0,70]]}",
                 "", true},
                {"a.geojson",
                 "{\"type\":\"MultiPoint\",\"coordinates\":[[0,5000],[10,5000],[0,7000]]}", "",
                 false},
                {"a.geojson",
                 "{\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:32629\"}},"
                 "\"type\":\"MultiPoint\",\"coordinates\":[[0,50],[10,50],[0,70]]}",
                 "", false},
                {"a.gpx",
                 "<gpx><wpt lat='50' lon='0'/><wpt lat='50' lon='9'/><wpt lat='70' lon='0'/></gpx>",
                 "", true}};
    char command[300];
    int status;
    cli_begin();
    for (size_t i = 0; i < sizeof file / sizeof file[0]; i++) {
        cli_write(file[i].name, file[i].text);
        snprintf(command, sizeof command, "draw %s - %s", cli_path(file[i].name), file[i].options);
        const char *out = cli_run(&status, command);
        CHECK_MSG(status == 0 && (strstr(out, " km</text>") != NULL) == file[i].map, "%zu: %s", i,
                  out);
        CHECK((strstr(out, "a map of degrees, true to scale at latitude 60") != NULL) ==
              file[i].map);
    }
    snprintf(command, sizeof command, "draw %s", cli_path("a.gpx"));
    cli_run_well(command);
    cli_finish();
}

TEST(run_keeps_all_columns_of_numbers_on_request)
{
    char command[300];
    int status;
    cli_begin();
    cli_write("a.csv", "x,y,t,name\n0,0,5,a\n1,0,6,b\n0,1,7,c\n");
    snprintf(command, sizeof command, "run %s - -f node --fields", cli_path("a.csv"));
    const char *out = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(out, "3 2 1 1\n0 0 0 5 1\n") != NULL, "%s", out);
    snprintf(command, sizeof command, "run %s - -f node", cli_path("a.csv"));
    CHECK(strstr(cli_run(&status, command), "3 2 0 1\n0 0 0 1\n") != NULL && status == 0);
    cli_finish();
}

#define PARCELS                                                                                    \
    "> border 3\n0 0\n9 0\n9 9\n0 9\n0 0\n> border 3\n3 3\n6 3\n6 6\n3 6\n3 3\n"                   \
    "> border 12\n9 0\n18 4\n9 9\n9 0\n"

TEST(run_writes_what_is_inside_borders)
{
    static const struct {
        const char *options, *want;
    } runs[] = {{"-f ele --inside any", "9 3 0\n"},
                {"-f ele --inside 12", "1 3 0\n0 1 8 2\n"},
                {"-f ele", "11 3 0\n"},
                {"-f edge --inside 12", "3 1\n"}};
    char command[300];
    int status;
    cli_begin();
    cli_write("a.gmt", PARCELS);
    for (size_t i = 0; i < sizeof runs / sizeof runs[0]; i++) {
        snprintf(command, sizeof command, "run %s - %s", cli_path("a.gmt"), runs[i].options);
        const char *got = cli_run(&status, command);
        CHECK_MSG(status == 0 && strstr(got, runs[i].want) != NULL, "%s: %s", runs[i].options, got);
    }
    snprintf(command, sizeof command, "run %s - -f ele --inside 5", cli_path("a.gmt"));
    CHECK(strstr(cli_run(&status, command), "NOREGION") != NULL && status == 1);
    snprintf(command, sizeof command, "run %s - -f ele --inside all", cli_path("a.gmt"));
    CHECK(strstr(cli_run(&status, command), "inside any border, or of one number") != NULL);
    CHECK(status == 2);
    cli_finish();
}

TEST(run_refines_the_mesh_and_says_what_is_left)
{
    int status;
    folder_begin();
    folder_expect(
        "printf '0 0\\n8 0\\n8 1\\n0 1\\n' > plate.xy && $D run plate.xy plate.obj --angle 30",
        "delaunay: there is no border, so the hull is one\n"
        "delaunay: 10 points added; the least angle is 45 degrees\n"
        "plate.obj: 14 points, 12 triangles, hull of 14\n");
    folder_expect(
        "printf '>\\n0 0\\n8 0\\n8 1\\n0 0\\n' > wedge.gmt && "
        "$D run wedge.gmt wedge.obj --border --inside any --angle 30 --force",
        "delaunay: 8 points added; the least angle is 7.1250 degrees\n"
        "delaunay: triangles that are not as wanted: 2; sharp corners stay, and at most --limit "
        "points are added\n"
        "wedge.obj: 11 points, 9 triangles, hull of 11\n");
    const char *got = folder_run(&status, "$D run plate.xy - -f obj --angle x");
    CHECK(status == 2 && strstr(got, "a limit is a number above 0, not x") != NULL);
    got = folder_run(&status, "$D run plate.xy - -f obj --angle 60");
    CHECK(status == 1 && strstr(got, "RANGE") != NULL);
    folder_expect("$D run plate.xy - -f obj --length 1 --keep 2>&1 | grep -c '^v '", "11\n");
    folder_finish();
}

TEST(pictures_are_pale_outside_borders_and_coloured_by_number_inside)
{
    char command[300];
    int status;
    cli_begin();
    cli_write("a.gmt", PARCELS);
    snprintf(command, sizeof command, "draw %s -", cli_path("a.gmt"));
    const char *svg = cli_run(&status, command);
    CHECK(status == 0 && strstr(svg, "class=\"o\" fill=\"#fbfbfb\"") != NULL);
    CHECK(strstr(svg, "class=\"r3\"") != NULL && strstr(svg, "class=\"r4\"") != NULL);
    CHECK(strstr(svg, "class=\"t\"") == NULL && strstr(svg, "class=\"r0\"") == NULL);
    snprintf(command, sizeof command, "draw %s - --colour quality", cli_path("a.gmt"));
    svg = cli_run(&status, command);
    CHECK(status == 0 && strstr(svg, "class=\"o\"") != NULL && strstr(svg, "class=\"r3\"") == NULL);
    snprintf(command, sizeof command, "draw %s - --colour angle", cli_path("a.gmt"));
    svg = cli_run(&status, command);
    CHECK(status == 0 && strstr(svg, "class=\"o\"") != NULL && strstr(svg, "class=\"t\"") == NULL);
    snprintf(command, sizeof command, "draw %s - --inside any", cli_path("a.gmt"));
    svg = cli_run(&status, command);
    CHECK(status == 0 && strstr(svg, "class=\"o\"") == NULL && strstr(svg, "class=\"t\"") != NULL);
    cli_finish();
}

TEST(holes_and_regions_are_written_to_poly_and_come_back)
{
    char command[300], first[2000];
    int status;
    cli_begin();
    cli_write("a.gmt", PARCELS);
    snprintf(command, sizeof command, "run %s - -f poly", cli_path("a.gmt"));
    snprintf(first, sizeof first, "%s", cli_run(&status, command));
    CHECK_MSG(strstr(first, "\n1\n0 4 4\n2\n0 5 1 3\n1 12 ") != NULL, "%s", first);
    cli_write("a.poly", first);
    snprintf(command, sizeof command, "run %s - -f poly", cli_path("a.poly"));
    CHECK_STR(cli_run(&status, command), first);
    snprintf(command, sizeof command, "run %s - -f ele --inside 12", cli_path("a.poly"));
    CHECK_STR(cli_run(&status, command), "1 3 0\n0 1 8 2\n");
    cli_finish();
}

TEST(shapefiles_and_geopackages_are_read_through_ogr2ogr)
{
    static const char fake[] =
        "printf '#!/bin/sh\\n[ -f \"$6\" ] || exit 9\\necho \"$@\" > asked\\n"
        "echo '\\''{\"type\":\"LineString\",\"coordinates\":[[0,0],[4,0],[0,4]]}'\\''\\n' > "
        "ogr2ogr; "
        "chmod +x ogr2ogr; echo binary > a.shp; cp a.shp B.GPKG; export PATH=$PWD:$PATH; ";
    char command[900];
    folder_begin();
    snprintf(command, sizeof command, "%s $D run a.shp - -f ele; cat asked; $D run B.GPKG - -f ele",
             fake);
    folder_expect(command,
                  "1 3 0\n0 0 1 2\n-f GeoJSON -lco SIGNIFICANT_FIGURES=17 /vsistdout/ a.shp\n"
                  "1 3 0\n0 0 1 2\n");
    folder_expect(
        "PATH=/none $D run a.shp - -f ele || echo $?",
        "delaunay: a.shp: to read this file the program ogr2ogr is needed (Debian: gdal-bin): "
        "No such file or directory\n1\n");
    folder_expect(
        "printf '#!/bin/sh\nexit 1\n' > ogr2ogr; PATH=$PWD:$PATH $D run a.shp - -f ele || echo $?",
        "delaunay: a.shp: ogr2ogr could not read all of it and write it as one layer of GeoJSON "
        "(ogr2ogr OUT FILE LAYER copies a layer); nothing was loaded\n1\n");
    folder_finish();
}
