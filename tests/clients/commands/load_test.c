/* load_test.c - `delaunay load` loads the points of a file, from the right columns, or refuses it. */
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static void load_text(const char *name, const char *text, const char *options, const char *want)
{
    char command[300];
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    cli_run_well(command);
    cli_expect("points t", want);
    cli_run_well("drop t");
}

static void refuse_text(const char *name, const char *text, const char *options, const char *want)
{
    char command[300];
    int status;
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 1 && strstr(got, want) != NULL, "%s", got);
}

TEST(load_reads_csv)
{
    cli_begin();
    load_text("a.csv", "1,2\n3,4\n", "", "OK 2\n0 1 2\n1 3 4\n");
    load_text("a.csv", "x,y,z\n1,2,9\n\n# c\n3,4,9\n", "", "OK 2\n0 1 2\n1 3 4\n");
    load_text("a.csv", "name;Latitude;Longitude\r\n\"a;b\";\"2\";1\r\n", "", "OK 1\n0 1 2\n");
    load_text("a.txt", "5 1 2\n6 3 4\n", "--columns 2,3", "OK 2\n0 1 2\n1 3 4\n");
    load_text("a.csv", "id\teast\tnorth\n7\t1\t2\n", "-c east,north", "OK 1\n0 1 2\n");
    refuse_text("a.csv", "x,y\n1\n", "", "a.csv:2: the row has too few columns");
    refuse_text("a.csv", "x,y\n1,b\n", "", "a.csv:2: not a number");
    refuse_text("a.csv", "x,y\n1,2\n", "-c x,z",
                "a.csv:1: no column is named z; columns found: 1=x 2=y;");
    refuse_text("a.csv", "0,0\n4,0\n4,4,7\n", "-c 1,2,3", "there is no column 3; columns found");
    cli_finish();
}

TEST(load_reads_node_files)
{
    cli_begin();
    load_text("a.node", "# made by hand\n2 2 1 1\n1 0.5 2 7 0\n2 3 4 7 1\n# end\n", "",
              "OK 2\n0 0.5 2\n1 3 4\n");
    cli_finish();
}

TEST(load_reads_geojson)
{
    cli_begin();
    load_text("a.geojson",
              "{\"type\": \"FeatureCollection\", \"features\": [\n"
              "{\"type\":\"Feature\",\"properties\":{\"n\":\"a \\\"b\\\" }\",\"c\":[1,{}]},\n"
              "\"geometry\":{\"coordinates\":[1.5, -2e1, 7],\"type\":\"Point\"}},\n"
              "{\"type\":\"Feature\",\"geometry\":{\"type\":\"MultiPoint\",\"coordinates\":[[3,4],["
              "5,6]]}}"
              "]}\n",
              "", "OK 3\n0 1.5 -20\n1 3 4\n2 5 6\n");
    load_text("a.ndjson",
              "{\"type\":\"Point\",\"coordinates\":[1,2]}\n"
              "{\"type\":\"Point\",\"coordinates\":[3,4]}\n",
              "", "OK 2\n0 1 2\n1 3 4\n");
    load_text("a.json", "{\"type\":\"MultiPoint\",\"coordinates\":[]}", "", "OK 0\n");
    refuse_text("a.json", "\n{\"type\":\"Circle\",\"coordinates\":[[1,2],[3,4]]}", "",
                "a.json:2: an object of a type that GeoJSON does not have");
    refuse_text("a.json", "{\"type\":\"Point\",\"coordinates\":[1,2]", "", "not GeoJSON");
    refuse_text("a.json", "{\"type\":\"Point\",\"coordinates\":[1]}", "",
                "a position needs x and y");
    refuse_text("a.json", "[[[", "", "not GeoJSON");
    refuse_text("a.json", "\"no end", "", "not GeoJSON");
    refuse_text("a.json", "\"no end\\", "", "not GeoJSON");
    cli_finish();
}

/* `n` nested arrays. */
static char *nested(char *to, int n)
{
    for (int i = 0; i < 2 * n; i++)
        to[i] = i < n ? '[' : ']';
    to[2 * n] = '\0';
    return to;
}

TEST(load_of_geojson_limits_the_depth_of_values_and_not_their_number)
{
    char text[20000], arrays[200];
    size_t n = (size_t)sprintf(text, "{\"features\":[");
    cli_begin();
    for (int i = 0; i < 200; i++)
        n += (size_t)sprintf(text + n,
                             "%s{\"n\":[],\"geometry\":"
                             "{\"type\":\"Point\",\"coordinates\":[%d,1]}}",
                             i > 0 ? "," : "", i % 2);
    sprintf(text + n, "]}");
    cli_write("a.geojson", text);
    snprintf(text, sizeof text, "load t %s", cli_path("a.geojson"));
    cli_expect(text, "OK 0 first=0 added=200 coincident=198\n");
    cli_run_well("drop t");
    snprintf(text, sizeof text, "{\"a\":%s,\"type\":\"Point\",\"coordinates\":[1,2]}",
             nested(arrays, 63));
    load_text("a.json", text, "", "OK 1\n0 1 2\n");
    snprintf(text, sizeof text, "{\"a\":%s,\"type\":\"Point\",\"coordinates\":[1,2]}",
             nested(arrays, 64));
    refuse_text("a.json", text, "", "not GeoJSON");
    cli_finish();
}

TEST(load_accepts_column_names_of_up_to_63_bytes)
{
    char name[100], text[300];
    int status;
    cli_begin();
    memset(name, 'n', sizeof name);
    name[63] = '\0';
    snprintf(text, sizeof text, "y,%s\n2,1\n", name);
    char options[200];
    snprintf(options, sizeof options, "-c %s,y", name);
    load_text("a.csv", text, options, "OK 1\n0 1 2\n");
    name[63] = 'n';
    name[64] = '\0';
    snprintf(text, sizeof text, "load t %s -c %s,y", cli_path("a.csv"), name);
    cli_run(&status, text);
    CHECK(status == 2);
    snprintf(text, sizeof text, "load t %s -c y,%s", cli_path("a.csv"), name);
    cli_run(&status, text);
    CHECK(status == 2);
    static const char *const wrong[] = {"x", "x,", ",y", "0,1", "1,0"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(text, sizeof text, "load t %s -c %s", cli_path("a.csv"), wrong[i]);
        cli_run(&status, text);
        CHECK_MSG(status == 2, "%s", wrong[i]);
    }
    cli_finish();
}

/* Like load_text, but compares the messages before the reply, too. */
static void load_saying(const char *name, const char *text, const char *options, const char *want,
                        const char *points)
{
    char command[300];
    int status;
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s %s", cli_path(name), options);
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(got, want) != NULL, "%s", got);
    cli_expect("points t", points);
    cli_run_well("drop t");
}

TEST(load_finds_the_columns_of_coordinates_by_their_headings_and_says_which)
{
    cli_begin();
    load_saying("a.csv", "id,POINT_X,POINT_Y,z\n7,1,2,9\n", "",
                "using columns x=POINT_X y=POINT_Y z=z\n", "OK 1\n0 1 2\n");
    load_saying("a.csv", "Latitude (deg),Longitude (deg)\n2,1\n", "",
                "using columns x=Longitude (deg) y=Latitude (deg)\n", "OK 1\n0 1 2\n");
    load_saying("a.csv", "lon,lat,x,y\n8,9,1,2\n", "", "using columns x=x y=y\n", "OK 1\n0 1 2\n");
    load_saying("a.dat", "# id x y\n7 1 2\n", "", "using columns x=x y=y\n", "OK 1\n0 1 2\n");
    load_saying("a.csv", "1,2,9\n3,4,9\n", "", "using columns x=1 y=2 z=3, without a header\n",
                "OK 2\n0 1 2\n1 3 4\n");
    char command[200];
    cli_write("a.csv", "x,y\n1,2\n");
    snprintf(command, sizeof command, "load t %s", cli_path("a.csv"));
    cli_expect(command, "OK 0 first=0 added=1 coincident=0\n"); /* obvious: no message */
    cli_finish();
}

TEST(load_refuses_unknown_columns_and_lists_the_known_ones)
{
    cli_begin();
    refuse_text(
        "a.csv", "id,a,b\n1,2,3\n", "",
        "a.csv:1: no headings that are known for x and y; columns found: 1=id 2=a 3=b; choose "
        "with --columns X,Y");
    refuse_text("a.csv", "x1,y1,x2,y2\n1,2,3,4\n", "", "1=x1 2=y1 3=x2 4=y2");
    refuse_text("a.csv", "Paris,2.35,48.85\n", "", "columns found: 1=Paris 2=2.35 3=48.85;");
    refuse_text("a.csv", "1,20,30\n2,40,50\n3,60,70\n", "", "the first column counts rows");
    refuse_text("a.csv", "x,y\n1,5,2,5\n", "",
                "a.csv:2: the row has too many columns: 4 instead of 2 (decimal commas?)");
    cli_run_well("add t 1 1");
    cli_expect("points t", "OK 1\n0 1 1\n"); /* no points were loaded */
    cli_finish();
}

TEST(load_accepts_any_delimiter_and_line_ending)
{
    cli_begin();
    load_text("a.tsv", "name\tlat\tlon\n\t2\t1\n", "", "OK 1\n0 1 2\n");
    load_text("A.CSV", "x|y\n1|2\n", "", "OK 1\n0 1 2\n");
    load_text("a.txt", "1,2\n3,4\n", "", "OK 2\n0 1 2\n1 3 4\n");
    load_text("a.TXT", "lon lat\n1 2\n", "", "OK 1\n0 1 2\n");
    load_text("a.xyz", "1 2 3\n4 5 6 7\n", "", "OK 2\n0 1 2\n1 4 5\n");
    load_text("a.csv", "x;y\n1,5;-2,25\n3;4.5\n", "", "OK 2\n0 1.5 -2.25\n1 3 4.5\n");
    load_text("a.csv", "sep=;\nx;y\n1;2\n", "", "OK 1\n0 1 2\n");
    load_text("a", "{\"type\":\"Point\",\"coordinates\":[1,2]}", "", "OK 1\n0 1 2\n");
    load_text("a.csv", "1,2\n3,4", "--format xyz", "OK 2\n0 1 2\n1 3 4\n");
    refuse_text("a.csv", "x;y\n1,5,1;2\n", "", "not a number");
    cli_finish();
}

TEST(load_reads_quoted_values_with_line_breaks_and_quotes)
{
    cli_begin();
    load_text("a.csv", "name,x,y\n\"two\nlines, \"\"quoted\"\"\",1,2\n5\" pipe,3,4\n6\" pipe,5,6\n",
              "", "OK 3\n0 1 2\n1 3 4\n2 5 6\n");
    load_text("a.csv", "\"X\n(m)\",\"Y\n(m)\"\n1,2\n", "", "OK 1\n0 1 2\n");
    refuse_text("a.csv", "name,x,y\n\"a\nb\",1,2\nc,1,e\n", "", "a.csv:4: not a number");
    load_text("a.csv", "name,x,y\n\"open,1,2\nc,3,4\n", "", "OK 2\n0 1 2\n1 3 4\n");
    cli_finish();
}

/* Loads the output of the shell command from a file and then from a pipe. */
static void load_made_by(const char *command, const char *name)
{
    char path[200], arguments[300];
    int status;
    snprintf(path, sizeof path, "%s", cli_path(name));
    peer_shell(&status, "%s > %s", command, path);
    CHECK(status == 0);
    snprintf(arguments, sizeof arguments, "load t %s", path);
    cli_expect(arguments, "OK 0 first=0 added=2 coincident=0\n");
    cli_expect("points t", "OK 2\n0 1 2\n1 3 4\n");
    snprintf(arguments, sizeof arguments, "load t - < %s", path);
    cli_expect(arguments, "OK 0 first=2 added=2 coincident=2\n");
    const char *got = peer_shell(&status, "cat %s | %s -p %s load t - 2>&1", path,
                                 getenv("DELAUNAY"), cli_daemon.port_text);
    CHECK_STR(got, "OK 0 first=4 added=2 coincident=2\n");
    cli_run_well("drop t");
}

TEST(load_reads_compressed_files_byte_order_marks_and_utf_16)
{
    int status;
    cli_begin();
    load_made_by("printf 'x,y\\n1,2\\n3,4\\n' | gzip", "a.csv.gz");
    load_made_by("printf '1 2\\n3 4\\n' | gzip", "a.XY.GZ");
    load_made_by("printf '\\357\\273\\277x,y\\n1,2\\n3,4\\n'", "a.csv");
    load_made_by("printf '\\357\\273\\277{\"type\":\"MultiPoint\",\"coordinates\":[[1,2],[3,4]]}'",
                 "a");
    load_made_by("printf 'x\\ty\\r\\n1\\t2\\r\\n3\\t4\\r\\n' | iconv -f UTF-8 -t UTF-16", "a.txt");
    peer_shell(&status, "seq 1 2 9999 | sed 's/$/ 1/' | gzip | head -c 2000 > %s",
               cli_path("cut.xy.gz"));
    char command[300];
    snprintf(command, sizeof command, "load t %s 2>&1", cli_path("cut.xy.gz"));
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 1 &&
                  strstr(got, "gzip could not read all of it; nothing was loaded") != NULL,
              "%s", got);
    snprintf(command, sizeof command, "printf 'a\\0b' > %s", cli_path("a.csv"));
    peer_shell(&status, "%s", command);
    snprintf(command, sizeof command, "load t %s", cli_path("a.csv"));
    CHECK(strstr(cli_run(&status, command), "a.csv:1: not a text file") != NULL && status == 1);
    cli_finish();
}

TEST(load_skips_bad_lines_when_asked_and_shows_what_it_skipped)
{
    char text[400] = "x,y\n";
    cli_begin();
    load_saying("a.csv", "x,y\n1,2\nn/a,3\n4\n5,6\n", "--skip-bad",
                "a.csv:3: skipped, not a number: \"n/a\" in column x: n/a,3\n",
                "OK 2\n0 1 2\n1 5 6\n");
    load_saying("a.csv", "x,y\n1,2\nn/a,3\n4\n5,6\n", "--skip-bad",
                "delaunay: 2 skipped, 2 points read\n", "OK 2\n0 1 2\n1 5 6\n");
    for (int i = 0; i < 7; i++)
        strcat(text, "a,b\n");
    load_saying("a.csv", strcat(text, "1,2\n"), "--skip-bad",
                "a.csv:6: skipped, not a number: \"a\" in column x: a,b\ndelaunay: 7 skipped in "
                "all, 1 points read\n",
                "OK 1\n0 1 2\n");
    load_saying("a.json",
                "{\"type\":\"GeometryCollection\",\"geometries\":[\n"
                "{\"type\":\"Circle\",\"coordinates\":[[1,2],[3,4]]},\n"
                "{\"type\":\"Point\",\"coordinates\":[1,2]}]}",
                "--skip-bad", "a.json:2: skipped, a geometry of a type", "OK 1\n0 1 2\n");
    refuse_text("a.csv", "a,b\n1,2\n", "--skip-bad", "no headings that are known");
    refuse_text("a.csv", "x,y\n1,b\n", "", "nothing was loaded (--skip-bad leaves such out)");
    cli_finish();
}

TEST(load_reports_the_option_that_is_wrong)
{
    static const char *const wrong[][2] = {
        {"--colums x,y", "delaunay: unknown option --colums\nTry 'delaunay load --help'.\n"},
        {"-z", "delaunay: unknown option -z\nTry 'delaunay load --help'.\n"},
        {"-c", "delaunay: the option -c needs a value\nTry 'delaunay load --help'.\n"},
        {"--format dwg", "delaunay: unknown format dwg; there are xy, csv, geojson, node, xyz, "
                         "gpx, las, poly, obj, asc\n"},
        {"-c x", "delaunay: --columns x is not X,Y"},
    };
    cli_begin();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char command[200];
        int status;
        snprintf(command, sizeof command, "load t /dev/null %s", wrong[i][0]);
        const char *got = cli_run(&status, command);
        CHECK_MSG(status == 2 && strncmp(got, wrong[i][1], strlen(wrong[i][1])) == 0, "%s", got);
    }
    cli_finish();
}

TEST(json_of_a_file_that_is_refused_has_the_reason_as_its_message)
{
    static const char *const commands[][2] = {
        {"load t", ""}, {"draw", "out.svg"}, {"run", "out.obj"}};
    char command[300], want[300];
    int status;
    cli_begin();
    cli_write("a.csv", "x,y\n1,2\n3\n");
    for (int i = 0; i < 3; i++) {
        snprintf(command, sizeof command, "%s %s %s --json", commands[i][0], cli_path("a.csv"),
                 commands[i][1]);
        snprintf(want, sizeof want,
                 "\n{\"ok\":false,\"error\":\"REFUSED\",\"message\":\"%s:3: ", cli_path("a.csv"));
        const char *out = cli_run(&status, command);
        CHECK_MSG(status == 1 && strstr(out, want) != NULL, "%s", out);
    }
    const char *out = cli_run(&status, "load t /nowhere/a.csv --json");
    CHECK(strstr(out,
                 "{\"ok\":false,\"error\":\"REFUSED\",\"message\":\"/nowhere/a.csv: No such file "
                 "or directory\",\"input\":{") != NULL);
    out = cli_run(&status, "load t --json --nothing");
    CHECK(strstr(out, "{\"ok\":false,\"error\":\"USAGE\",\"message\":\"unknown option "
                      "--nothing\"}\n") != NULL);
    out = cli_run(&status, "export nope /nowhere/a.svg --json");
    CHECK(strstr(out, "\"error\":\"NOSET\"") != NULL && status == 1);
    cli_finish();
}
