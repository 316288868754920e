/* voronoi_test.c - `delaunay voronoi` with a real daemon. */
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

static void make_set(void)
{
    cli_begin();
    cli_run_well("add t 0 0  4 0  4 4  0 4  2 2");
    cli_run_well("triangulate t");
}

TEST(voronoi_writes_cells_as_wkt_and_geojson)
{
    int status;
    make_set();
    cli_expect("voronoi t - -f wkt --viewport 0,0,4,4",
               "WKT,id\n\"POLYGON ((0 0,2 0,0 2,0 0))\",0\n\"POLYGON ((2 0,4 0,4 2,2 0))\",1\n"
               "\"POLYGON ((2 4,4 2,4 4,2 4))\",2\n\"POLYGON ((0 2,2 4,0 4,0 2))\",3\n"
               "\"POLYGON ((0 2,2 0,4 2,2 4,0 2))\",4\n");
    const char *out = cli_run(&status, "voronoi t -");
    CHECK(status == 0 && count(out, "\"Feature\"") == 5 && count(out, "\"Polygon\"") == 5);
    CHECK(strstr(out, "{\"id\":4},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                      "[[[0,2],[2,0],[4,2],[2,4],[0,2]]]}") != NULL);
    cli_finish();
}

TEST(voronoi_draws_cells_and_their_points)
{
    char command[200];
    int status;
    make_set();
    const char *out = cli_run(&status, "voronoi t - --format svg");
    CHECK(status == 0 && count(out, "zM") == 4 && count(out, "h0") == 5);
    CHECK(strstr(out, "<title>t: Voronoi cells of 5 points</title>") != NULL);
    out = cli_run(&status, "voronoi t - --format svg --viewport 1,1,3,3");
    CHECK(status == 0 && count(out, "h0") == 1 && count(out, "zM") == 0);
    snprintf(command, sizeof command, "voronoi t %s", cli_path("t.svg"));
    out = cli_run(&status, command);
    CHECK(status == 0 && strstr(out, "t.svg: 5 cells\n") != NULL);
    snprintf(command, sizeof command, "--json voronoi t %s", cli_path("t.svg"));
    out = cli_run(&status, command);
    CHECK(status == 0 && strstr(out, "t.svg\",\"cells\":5}\n") != NULL);
    cli_finish();
}

TEST(voronoi_without_a_file_sends_the_request)
{
    make_set();
    cli_expect("voronoi t 4", "OK 1 box=-2,-2,6,6\n4 4 0 2 2 0 4 2 2 4\n");
    cli_expect("voronoi t 4 BOX -0.5 -1 1 1", "OK 1 box=-0.5,-1,1,1\n4 0\n");
    cli_finish();
}

TEST(voronoi_that_is_refused_writes_no_file)
{
    char command[200];
    int status;
    make_set();
    cli_write("mine.wkt", "mine\n");
    snprintf(command, sizeof command, "voronoi t %s", cli_path("mine.wkt"));
    CHECK(strstr(cli_run(&status, command), "--force replaces it") != NULL && status == 1);
    snprintf(command, sizeof command, "voronoi none %s", cli_path("a.wkt"));
    CHECK(strstr(cli_run(&status, command), "NOSET") != NULL && status == 1);
    CHECK(access(cli_path("a.wkt"), F_OK) != 0);
    CHECK(strstr(cli_run(&status, "voronoi t a.png"), "unknown format png") != NULL && status == 2);
    CHECK(strstr(cli_run(&status, "voronoi t --force"), "takes a set and a file") != NULL);
    CHECK(strstr(cli_run(&status, "voronoi t - --viewport 1,1,1,2"), "is not X0,Y0") != NULL);
    CHECK(strstr(cli_run(&status, "voronoi t - -f svg --field q"), "no such field") != NULL &&
          status == 1);
    cli_finish();
}

TEST(voronoi_draws_little_more_than_the_box_of_the_points)
{
    char command[200];
    int status, wide, high;
    make_set(); /* in a box of 4 x 4 */
    const char *out = cli_run(&status, "voronoi t - --format svg");
    const char *frame = strstr(out, "viewBox=\"0 0 ");
    CHECK(frame != NULL && sscanf(frame, "viewBox=\"0 0 %d %d", &wide, &high) == 2);
    /* 16,000 units for 4.4: the points are 14,545 apart, which the lower left one and its right neighbour show */
    CHECK_MSG(strstr(out, "M1127 15673h0") != NULL && strstr(out, "M15673 15673h0") != NULL, "%s",
              out);
    snprintf(command, sizeof command, "voronoi t - --format svg --viewport=-2,-2,6,6");
    CHECK(strstr(cli_run(&status, command), "M4400 12400h0") != NULL && status == 0);
    cli_run_well("add u 3 3");
    cli_run_well("triangulate u");
    cli_run_well("voronoi u - --format svg");
    cli_finish();
}
