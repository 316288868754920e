/* alpha_test.c - `delaunay alpha SET RADIUS FILE` writes the shape that ALPHA returns. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

/* A ring of points around an empty square. */
static void make_set(void)
{
    cli_begin();
    cli_run_well(
        "add t 0 0  1 0  2 0  3 0  0 1  1 1  2 1  3 1  0 2  1 2  2 2  3 2  0 3  1 3  2 3  3 3");
    cli_run_well("del t 5 6 9 10");
    cli_run_well("add t 0.5 0.5  2.5 0.5  0.5 2.5  2.5 2.5");
    cli_run_well("triangulate t");
}

TEST(alpha_writes_polygons_with_their_holes)
{
    int status;
    make_set();
    CHECK(strstr(cli_run(&status, "alpha t 1.3"), "\nhole ") != NULL && status == 0);
    const char *out = cli_run(&status, "alpha t 1.3 - -f wkt");
    CHECK_MSG(status == 0 && strncmp(out, "WKT,radius,holes\n\"POLYGON ((", 28) == 0, "%s", out);
    CHECK(strstr(out, "),(") != NULL && strstr(out, ")\",1.3,1\n") != NULL);
    out = cli_run(&status, "alpha t 1.3 -");
    CHECK(status == 0 && strstr(out, "{\"radius\":1.3,\"holes\":1}") != NULL);
    out = cli_run(&status, "alpha t 0 -");
    CHECK_STR(out, "{\"type\":\"FeatureCollection\",\"features\":[\n]}\n");
    cli_finish();
}

TEST(alpha_finds_the_radius_of_one_piece_with_all_points)
{
    int status;
    cli_begin();
    cli_run(&status, "add t 0 0 6 0 0 8 6 8 20 4");
    cli_run(&status, "triangulate t");
    CHECK_STR(cli_run(&status, "alpha t auto"),
              "OK 1 radius=7.571428571428572\nouter 5 0 1 4 3 2\n");
    CHECK_STR(cli_run(&status, "alpha t auto - -f wkt"),
              "WKT,radius,holes\n\"POLYGON ((0 0,6 0,20 4,6 8,0 8,0 0))\",7.571428571428572,0\n");
    cli_run(&status, "alpha t automatic -");
    CHECK(status != 0);
    cli_finish();
}

TEST(alpha_draws_the_shape_and_counts_its_polygons)
{
    char command[200];
    int status;
    make_set();
    snprintf(command, sizeof command, "alpha t 1.3 %s", cli_path("a.svg"));
    CHECK(strstr(cli_run(&status, command), "a.svg: 1 polygons, 1 holes\n") != NULL && status == 0);
    snprintf(command, sizeof command, "alpha t 1.3 %s --json", cli_path("a.svg"));
    CHECK(strstr(cli_run(&status, command), "\"polygons\":1,\"holes\":1}") != NULL && status == 0);
    const char *svg = peer_shell(&status, "cat %s", cli_path("a.svg"));
    CHECK(strstr(svg, "<title>t: alpha shape of radius 1.3</title>") && strstr(svg, "zM") != NULL);
    CHECK(strstr(cli_run(&status, "alpha t nan -"), "the radius is a number") && status == 2);
    CHECK(strstr(cli_run(&status, "alpha t x -"), "the radius is a number") && status == 2);
    CHECK(strstr(cli_run(&status, "alpha t 1 2 -"), "alpha takes a set") && status == 2);
    CHECK(strstr(cli_run(&status, "alpha nope 1 -"), "NOSET") && status == 1);
    cli_finish();
}
