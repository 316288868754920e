/* heights_test.c - fields from a file into the daemon and out of it again, in every format. */
#include <stdlib.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

/* A square with heights 1, 2.5, none and -4, and the field t. */
static void make_set(void)
{
    char command[200];
    cli_begin();
    cli_write("t.csv", "x,y,z,t\n0,0,1,10\n4,0,2.5,20\n4,3,,30\n0,4,-4,40\n");
    snprintf(command, sizeof command, "load t %s --fields", cli_path("t.csv"));
    cli_run_well(command);
    cli_run_well("triangulate t");
}

static void expect_export(const char *options, const char *want)
{
    char command[200];
    int status;
    snprintf(command, sizeof command, "export t - %s", options);
    const char *out = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(out, want) != NULL, "%s: %s", options, out);
}

TEST(load_keeps_heights_and_on_request_all_columns_of_numbers)
{
    char command[200];
    int status;
    make_set();
    cli_expect("fields t", "OK 2\nt 4 10 40\nz 3 -4 2.5\n");
    cli_expect("fget t z 0 1 2 3", "OK 4\n0 1\n1 2.5\n2 nan\n3 -4\n");
    snprintf(command, sizeof command, "load u %s", cli_path("t.csv"));
    const char *out = cli_run(&status, command);
    CHECK(strstr(out, ": using columns x=x y=y z=z\n") != NULL);
    CHECK(strstr(out, ": z: 1 of 4 values are missing\n") != NULL);
    cli_expect("fields u", "OK 1\nz 3 -4 2.5\n");
    snprintf(command, sizeof command, "load v %s -c x,y", cli_path("t.csv"));
    cli_run_well(command);
    cli_expect("fields v", "OK 0\n");
    cli_finish();
}

TEST(load_reads_third_coordinates_of_geojson_as_heights)
{
    char command[200];
    int status;
    cli_begin();
    cli_write("t.geojson",
              "{\"type\":\"MultiPoint\",\"coordinates\":[[0,0,1.5],[1,0],[0,1,null]]}");
    snprintf(command, sizeof command, "load t %s", cli_path("t.geojson"));
    const char *out = cli_run(&status, command);
    CHECK(status == 0 && strstr(out, "using x y z of the coordinates\n") != NULL);
    CHECK(strstr(out, "z: 2 of 3 values are missing\n") != NULL);
    cli_expect("fget t z 0 1 2", "OK 3\n0 1.5\n1 nan\n2 nan\n");
    cli_finish();
}

/* Loads the file, and compares what the report says about its heights. */
static void expect_missing(const char *name, const char *text, const char *want)
{
    char command[200];
    int status;
    cli_write(name, text);
    snprintf(command, sizeof command, "load t %s --fields", cli_path(name));
    const char *got = cli_run(&status, command);
    CHECK_MSG(status == 0 && strstr(got, want) != NULL, "%s: %s", name, got);
}

TEST(heights_that_are_too_large_are_named)
{
    cli_begin();
    expect_missing("a.geojson",
                   "{\"type\":\"MultiPoint\",\"coordinates\":[[0,0,1],[1,0,null],\n[0,1,1e400]]}",
                   "z: 2 of 3 values are missing; the first that is not a number is \"1e400\" in "
                   "line 2");
    expect_missing("b.geojson", "{\"type\":\"Point\",\"coordinates\":[0,0,-1e999]}",
                   "z: 1 of 1 values are missing; the first that is not a number is \"-1e999\"");
    expect_missing(
        "c.geojson",
        "[{\"type\":\"Feature\",\"properties\":{\"q\":1},\"geometry\":{\"type\":\"Point\","
        "\"coordinates\":[0,0]}},{\"type\":\"Feature\",\"properties\":{\"q\":2},"
        "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,0]}},{\"type\":\"Feature\","
        "\"properties\":{\"q\":\"2 m\"},\"geometry\":{\"type\":\"Point\",\"coordinates\":"
        "[0,1]}}]",
        "q: 1 of 3 values are missing; the first that is not a number is \"2 m\"");
    expect_missing("d.obj", "v 0 0 1\nv 1 0 1e400\n",
                   "z: 1 of 2 values are missing; the first that is not a number is \"1e400\" in "
                   "line 2");
    expect_missing("e.gpx",
                   "<gpx><wpt lat='1' lon='1'><ele>1</ele></wpt><wpt lat='2' lon='1'>"
                   "<ele>1e400</ele></wpt></gpx>",
                   "\"1e400\" in line 1");
    expect_missing("f.csv", "x,y,z\n0,0,1\n1,0,1e400\n", "\"1e400\" in line 3");
    cli_finish();
}

TEST(meshes_have_heights)
{
    make_set();
    expect_export("-f obj --field t", "\nv 0 0 10\nv 4 0 20\nv 4 3 30\nv 0 4 40\nf ");
    expect_export("-f ply --field t", "end_header\n0 0 10\n4 0 20\n4 3 30\n0 4 40\n3 ");
    int status;
    CHECK(strstr(cli_run(&status, "export t - -f obj --field u"), "u: the set has no such field") &&
          status == 1);
    cli_finish();
}

/* The square of make_set has the triangles 0 1 2 and 0 2 3, so none is left without point 2. */
TEST(points_without_a_height_are_left_out_of_meshes_with_their_triangles)
{
    char command[200];
    int status;
    make_set();
    cli_run_well("add t -4 0");
    cli_run_well("add t 2 -3");
    cli_run_well("fset t z 4 7");
    cli_run_well("triangulate t");
    expect_export("-f obj", "triangulation\nv 0 0 1\nv 4 0 2.5\nv 0 4 -4\nv -4 0 7\nf 1 3 4\n");
    expect_export("-f ply", "element vertex 4\n");
    expect_export("-f ply", "element face 1\n");
    expect_export("-f ply", "end_header\n0 0 1\n4 0 2.5\n0 4 -4\n-4 0 7\n3 0 2 3\n");
    expect_export("-f off", "OFF\n4 1 0\n0 0 1\n4 0 2.5\n0 4 -4\n-4 0 7\n3 0 2 3\n");
    expect_export("-f 2dm", "E3T 1 1 3 4 1\nND 1 0 0 1\nND 2 4 0 2.5\nND 3 0 4 -4\nND 4 -4 0 7\n");
    expect_export("-f obj", "delaunay: 2 of 6 heights are missing: these points and their 4 "
                            "triangles are left out\n");
    snprintf(command, sizeof command, "export t %s --json 2>/dev/null", cli_path("t.off"));
    CHECK(strstr(cli_run(&status, command), "\"points\":4,\"shown\":4,\"triangles\":1") != NULL);
    snprintf(command, sizeof command, "export t %s --json --force 2>/dev/null", cli_path("t.off"));
    CHECK(strstr(cli_run(&status, command), "\"left_out\":2") != NULL);
    cli_finish();
}

TEST(a_mesh_of_points_without_any_height_is_refused)
{
    int status;
    make_set();
    cli_run_well("fset t empty 0 nan");
    const char *out = cli_run(&status, "export t - -f obj --field empty");
    CHECK_MSG(status == 1 && strstr(out, "empty: no point has a value of this field") != NULL, "%s",
              out);
    cli_run_well("fset t z 0 nan"); /* two points of each triangle are left */
    out = cli_run(&status, "export t - -f ply");
    CHECK_MSG(status == 1 && strstr(out, "z: no triangle has a height at each of its points"), "%s",
              out);
    cli_finish();
}

TEST(nodes_csv_and_geojson_have_all_fields)
{
    make_set();
    expect_export("-f node",
                  "4 2 2 1\n0 0 0 10 1 1\n1 4 0 20 2.5 1\n2 4 3 30 nan 1\n3 0 4 40 -4 1\n");
    expect_export("-f csv", "a,b,c,ax,ay,bx,by,cx,cy,at,bt,ct,az,bz,cz\n");
    expect_export("-f csv", "0,2,3,0,0,4,3,0,4,10,30,40,1,,-4\n");
    expect_export(
        "-f geojson",
        "{\"a\":0,\"b\":2,\"c\":3,\"at\":10,\"bt\":30,\"ct\":40,\"az\":1,\"bz\":null,\"cz\":-4},");
    cli_finish();
}

TEST(features_of_many_fields_are_written_whole)
{
    enum { FIELDS = 64, NAME = 64 };
    static const char value[] = "-1.2345678901234567e-100";
    static char text[FIELDS * (NAME + 3 * sizeof value + 8) + 1000];
    int status;
    size_t n = (size_t)sprintf(text, "x,y");
    cli_begin();
    for (int i = 0; i < FIELDS; i++)
        n += (size_t)sprintf(text + n, ",f%02d%0*d", i, NAME - 3, 0);
    for (int row = 0; row < 3; row++) {
        n += (size_t)sprintf(text + n, "\n%d,%d", row == 1, row == 2);
        for (int i = 0; i < FIELDS; i++)
            n += (size_t)sprintf(text + n, ",%s", value);
    }
    cli_write("t.csv", text);
    snprintf(text, sizeof text, "load t %s --fields", cli_path("t.csv"));
    cli_run_well(text);
    cli_run_well("triangulate t");
    const char *out = cli_run(&status, "export t - -f ndjson"), *last = strstr(out, "\"cf63");
    last = last != NULL ? strchr(last, ':') : NULL;
    n = (size_t)sprintf(text, ":%s},\"geometry\"", value);
    CHECK(status == 0 && last != NULL && strncmp(last, text, n) == 0);
    cli_finish();
}

TEST(export_draws_relief_of_a_set_with_heights)
{
    int status;
    make_set();
    expect_export("-f svg --colour relief --field t", "<path fill=\"#");
    cli_run_well("fdrop t z");
    CHECK(strstr(cli_run(&status, "export t - -f svg --colour relief"),
                 "z: the set has no such field") &&
          status == 1);
    cli_finish();
}

TEST(many_heights_come_back_in_order)
{
    char command[200];
    cli_begin();
    FILE *f = fopen(cli_path("m.xyz"), "w");
    CHECK(f != NULL);
    for (int i = 0; i < 5000; i++)
        fprintf(f, "%d.5 %d %d\n", i % 71, i, 7 * i);
    fclose(f);
    snprintf(command, sizeof command, "load m %s", cli_path("m.xyz"));
    cli_run_well(command);
    cli_run_well("triangulate m");
    snprintf(command, sizeof command, "export m %s", cli_path("m.node"));
    cli_run_well(command);
    f = fopen(cli_path("m.node"), "r");
    CHECK(f != NULL && fscanf(f, "5000 2 1 1") == 0);
    for (int i = 0; i < 5000; i++) {
        int id, y, z, boundary;
        double x;
        CHECK(fscanf(f, "%d %lf %d %d %d", &id, &x, &y, &z, &boundary) == 5);
        CHECK(id == i && y == i && z == 7 * i);
    }
    fclose(f);
    cli_finish();
}
