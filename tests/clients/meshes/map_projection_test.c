/* map_projection_test.c - maps of longitudes and latitudes, and the pictures that show them. */
#include "clients/meshes/map_projection.h"

#include <math.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

TEST(a_degree_of_longitude_at_60_north_is_half_as_long_as_one_of_latitude)
{
    double xy[] = {10, 59, 11, 61}, beyond[] = {0, 0, 0, 90.5};
    struct map_projection d;
    CHECK(map_projection_choose(&d, xy, 2) && d.middle == 60);
    map_projection_project(&d, xy, 2);
    CHECK(fabs((xy[2] - xy[0]) / (xy[3] - xy[1]) - 0.25) < 1e-12);
    CHECK(fabs((xy[3] - xy[1]) - 2 * 111.195) < 1e-2);
    CHECK(!map_projection_choose(&d, beyond, 2) && !map_projection_choose(&d, xy, 0));
}

/* The frame of an SVG. */
static void read_frame(const char *svg, double *wide, double *high)
{
    const char *frame = strstr(svg, "viewBox=\"0 0 ");
    CHECK(frame != NULL && sscanf(frame, "viewBox=\"0 0 %lf %lf", wide, high) == 2);
}

TEST(geographic_pictures_are_narrower_and_have_a_scale_in_kilometres)
{
    double wide, high;
    int status;
    cli_begin();
    cli_run_well("add t 0 50  20 50  20 70  0 70  5 60");
    cli_run_well("triangulate t");
    read_frame(cli_run(&status, "export t -"), &wide, &high);
    double plain = (wide - 800) / (high - 1500);
    const char *out = cli_run(&status, "export t - --geographic");
    read_frame(out, &wide, &high);
    CHECK(status == 0 && fabs((wide - 800) / (high - 1500) / plain - 0.5) < 0.01);
    CHECK(strstr(out, " km</text>") != NULL && strstr(out, "a map of degrees") != NULL);
    CHECK(strstr(cli_run(&status, "voronoi t - -f svg --geographic"), " km</text>") && status == 0);
    CHECK(strstr(cli_run(&status, "alpha t 20 - -f svg --geographic"), " km</text>") &&
          status == 0);
    CHECK(strstr(cli_run(&status, "voronoi t - -f wkt --geographic"), "WKT,id\n") && status == 0);
    cli_run_well("fset t z 0 1  1 2  2 3  3 4  4 9");
    CHECK(strstr(cli_run(&status, "contour t z - -f svg --geographic"), " km</text>") &&
          status == 0);
    cli_run_well("show t --geographic --plain");
    cli_run_well("show t --geographic --mesh");
    cli_run_well("add t 3 91");
    CHECK(strstr(cli_run(&status, "export t - --geographic"), "latitudes beyond 90") &&
          status == 1);
    CHECK(strstr(cli_run(&status, "show t --geographic --mesh"), "latitudes beyond 90") &&
          status == 1);
    CHECK(strstr(cli_run(&status, "export t - --geographic --planar"), "or --planar") &&
          status == 2);
    cli_finish();
}

TEST(a_png_picture_has_a_world_file_in_the_units_of_the_set)
{
    char command[200];
    double v[6];
    int status;
    cli_begin();
    cli_run_well("add t 100 50  110 50  110 60  100 60");
    cli_run_well("triangulate t");
    peer_shell(&status, "command -v rsvg-convert");
    if (status != 0) {
        puts("skipped: PNG needs rsvg-convert");
        cli_finish();
        return;
    }
    for (int i = 0; i < 2; i++) {
        snprintf(command, sizeof command, "export t %s %s --force", cli_path("t.png"),
                 i == 1 ? "--geographic" : "");
        cli_run_well(command);
        const char *world = peer_shell(&status, "cat %s", cli_path("t.pgw"));
        CHECK(sscanf(world, "%lf %lf %lf %lf %lf %lf", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5]) ==
              6);
        /* 16,000 units are 10 of the set, and the margin is 400 */
        CHECK(v[1] == 0 && v[2] == 0 && fabs(v[3] + 10 * 10 / 16000.0) < 1e-9);
        CHECK(fabs(v[5] - (60 + 0.25 - 0.003125)) < 1e-6);
        CHECK(i == 1 ? fabs(v[0] * cos(55 * M_PI / 180) + v[3]) < 1e-9 : v[0] == -v[3]);
    }
    cli_finish();
}
