/* raster_test.c - `delaunay raster` and `delaunay show` of a surface, with a real daemon. */
#include <string.h>
#include <unistd.h>

#include "clients/commands/show_relief.h"
#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

/* The plane z = x + 10 y over a square. */
static void make_plane(void)
{
    cli_begin();
    cli_run_well("add t 0 0  4 0  4 4  0 4");
    cli_run_well("fset t z 0 0  1 4  2 44  3 40");
    cli_run_well("triangulate t");
}

/* Runs `raster t z FILE OPTIONS` on a file in the directory. */
static const char *raster(int *status, const char *file, const char *options)
{
    char command[300];
    snprintf(command, sizeof command, "raster t z %s %s", cli_path(file), options);
    return cli_run(status, command);
}

TEST(raster_writes_an_ascii_grid_from_the_north_to_the_south)
{
    make_plane();
    cli_expect("raster t z - --width 4",
               "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
               "35.5 36.5 37.5 38.5\n25.5 26.5 27.5 28.5\n15.5 16.5 17.5 18.5\n5.5 6.5 7.5 8.5\n");
    cli_expect("raster t z - --cell 2 --viewport 2,-2,6,2",
               "ncols 2\nnrows 2\nxllcorner 2\nyllcorner -2\ncellsize 2\nNODATA_value -9999\n"
               "13 -9999\n-9999 -9999\n");
    cli_finish();
}

TEST(raster_passes_method_and_longest_edge_on)
{
    make_plane();
    cli_expect("raster t z - --width 1 --max-edge 1 --method nearest",
               "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 4\nNODATA_value -9999\n"
               "-9999\n");
    int status;
    CHECK(strstr(cli_run(&status, "raster t z - --method cubic"), "ERR SYNTAX") && status == 1);
    CHECK(strstr(cli_run(&status, "raster t y -"), "NOFIELD") && status == 1);
    CHECK(strstr(cli_run(&status, "raster none z -"), "NOSET") && status == 1);
    cli_finish();
}

TEST(raster_is_empty_outside_the_border_that_an_option_names)
{
    int status;
    make_plane();
    cli_run_well("constrain t border of 3 ring 0 1 2");
    const char *out = cli_run(&status, "raster t z - --width 2");
    CHECK(status == 0 && strstr(out, "\n-9999 ") == NULL);
    out = cli_run(&status, "raster t z - --width 2 --inside 3");
    CHECK_MSG(status == 0 && strstr(out, "\n-9999 ") != NULL, "%s", out);
    char any[400];
    snprintf(any, sizeof any, "%s", out);
    CHECK_STR(cli_run(&status, "raster t z - --width 2 --inside any"), any);
    CHECK(strstr(cli_run(&status, "raster t z - --inside 4"), "NOREGION") && status == 1);
    (void)cli_run(&status, "raster t z - --cell 0x20"); /* numbers are decimal everywhere */
    CHECK(status == 2);
    cli_run(&status, "raster t z - --inside x");
    CHECK(status == 2);
    cli_finish();
}

TEST(raster_goes_on_beyond_the_hull_and_is_clipped)
{
    int status;
    make_plane();
    cli_expect("raster t z - --cell 2 --viewport 2,-2,6,2 --outside nearest",
               "ncols 2\nnrows 2\nxllcorner 2\nyllcorner -2\ncellsize 2\nNODATA_value -9999\n"
               "13 14\n3 4\n");
    cli_run_well("add field 0 0  2 0  2 2  0 2");
    cli_run_well("constrain field border ring 0 1 2 3");
    cli_run_well("triangulate field");
    cli_expect("raster t z - --width 4 --clip field",
               "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
               "-9999 -9999 -9999 -9999\n-9999 -9999 -9999 -9999\n15.5 16.5 -9999 -9999\n"
               "5.5 6.5 -9999 -9999\n");
    CHECK(strstr(cli_run(&status, "raster t z - --clip none"), "NOSET") && status == 1);
    CHECK(strstr(cli_run(&status, "raster t z - --outside far"), "ERR SYNTAX") && status == 1);
    cli_finish();
}

TEST(raster_skips_missing_values_of_one_field)
{
    int status;
    make_plane();
    cli_run_well("add t 2 2");
    cli_expect(
        "raster t z - --cell 4",
        "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 4\nNODATA_value -9999\n-9999\n");
    cli_expect("raster t z - --cell 4 --missing skip",
               "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 4\nNODATA_value -9999\n22\n");
    CHECK(strstr(cli_run(&status, "raster t z - --missing zero"), "ERR SYNTAX") && status == 1);
    CHECK(strstr(cli_run(&status, "raster t z,z -"), "a raster has one field") && status == 1);
    cli_finish();
}

TEST(raster_writes_slopes_and_directions)
{
    int status;
    make_plane();
    cli_expect("raster t z - --width 2 --as slope",
               "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9999\n"
               "84.31756151648317 84.31756151648317\n84.31756151648317 84.31756151648317\n");
    CHECK(strstr(cli_run(&status, "raster t z - --width 2 --as aspect"),
                 "\n185.71059313749964 185.71059313749964\n") &&
          status == 0);
    CHECK(strstr(cli_run(&status, "raster t z - --as height"), "ERR SYNTAX") && status == 1);
    cli_finish();
}

TEST(raster_writes_bil_with_a_header_file)
{
    int status;
    make_plane();
    CHECK(strstr(raster(&status, "a.bil", "--width 2"),
                 "a.bil: 2 x 2 cells of 2, values from 11 to 33\n") != NULL);
    const char *got = peer_shell(&status, "od -An -tf4 %s", cli_path("a.bil"));
    float v[4];
    CHECK(sscanf(got, "%f %f %f %f", &v[0], &v[1], &v[2], &v[3]) == 4);
    CHECK(v[0] == 31 && v[1] == 33 && v[2] == 11 && v[3] == 13);
    got = peer_shell(&status, "cat %s", cli_path("a.hdr"));
    CHECK(strstr(got, "NROWS 2\nNCOLS 2\n") && strstr(got, "ULXMAP 1\nULYMAP 3\nXDIM 2\n"));
    cli_write("b.hdr", "mine\n");
    CHECK(strstr(raster(&status, "b.bil", ""), "--force replaces it") && status == 1);
    CHECK(access(cli_path("b.bil"), F_OK) != 0);
    cli_finish();
}

TEST(raster_that_fails_leaves_the_files_beside_it_as_they_are)
{
    static const struct {
        const char *file, *beside;
    } cases[] = {{"a.bil", "a.hdr"}, {"a.png", "a.pgw"}};
    int status;
    char before[400];
    make_plane();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        raster(&status, cases[i].file, "--width 2");
        CHECK(status == 0);
        snprintf(before, sizeof before, "%s",
                 peer_shell(&status, "cat %s", cli_path(cases[i].beside)));
        const char *got = peer_shell(
            &status, "trap '' XFSZ; ulimit -f 8; %s -p %s raster t z %s --width 200 2>&1",
            getenv("DELAUNAY"), cli_daemon.port_text, cli_path(cases[i].file));
        CHECK_MSG(status == 1, "%s", got);
        CHECK_STR(peer_shell(&status, "cat %s", cli_path(cases[i].beside)), before);
        CHECK(strlen(before) > 10);
    }
    peer_shell(&status, "f=%s; rm $f; mkdir $f", cli_path("a.png"));
    CHECK(strstr(raster(&status, "a.png", "--width 4"), "s a directory") != NULL && status == 1);
    CHECK_STR(peer_shell(&status, "cat %s", cli_path("a.pgw")), before);
    CHECK_STR(peer_shell(&status, "ls %s", cli_path("")), "a.bil\na.hdr\na.pgw\na.png\n");
    cli_finish();
}

TEST(raster_draws_a_png_with_one_pixel_a_cell)
{
    int status;
    make_plane();
    raster(&status, "a.png", "--width 12");
    CHECK(status == 0);
    const char *got = peer_shell(&status, "od -An -tu1 -j16 -N8 %s", cli_path("a.png"));
    unsigned b[8];
    CHECK(sscanf(got, "%u %u %u %u %u %u %u %u", b, b + 1, b + 2, b + 3, b + 4, b + 5, b + 6,
                 b + 7) == 8);
    CHECK(b[3] == 12 && b[7] == 12);
    raster(&status, "a.png", "--width 12 --colour light");
    CHECK(status == 0);
    CHECK(strstr(raster(&status, "a.png", "--colour red"), "unknown colour red") && status == 2);
    cli_finish();
}

TEST(raster_writes_a_world_file_beside_a_picture)
{
    int status;
    make_plane();
    raster(&status, "a.png", "--viewport 1,1,5,3 --width 8");
    CHECK(status == 0);
    CHECK_STR(peer_shell(&status, "cat %s", cli_path("a.pgw")), "0.5\n0\n0\n-0.5\n1.25\n2.75\n");
    cli_write("a.pgw", "mine\n");
    CHECK(strstr(raster(&status, "a.png", "--width 8"), "a.pgw: there is such a file") != NULL);
    CHECK(status == 1);
    peer_shell(&status, "command -v gdalinfo");
    if (status == 0) {
        raster(&status, "a.png", "--viewport 1,1,5,3 --width 8 --force");
        const char *got = peer_shell(&status, "gdalinfo %s", cli_path("a.png"));
        CHECK_MSG(strstr(got, "Upper Left  (   1.0000000,   3.0000000)") != NULL, "%s", got);
    }
    cli_finish();
}

TEST(raster_writes_a_png_that_others_read)
{
    int status;
    make_plane();
    raster(&status, "a.png", "--width 300");
    CHECK(status == 0);
    peer_shell(&status, "command -v python3");
    if (status != 0) {
        puts("skipped: python3 reads the PNG");
    } else {
        const char *got =
            peer_shell(&status,
                       "python3 -c 'import sys, zlib, struct\n"
                       "b = open(sys.argv[1], \"rb\").read(); p = 8; z = b\"\"\n"
                       "while p < len(b):\n"
                       "    n, k = struct.unpack(\">I4s\", b[p:p+8]); d = b[p+8:p+8+n]\n"
                       "    assert zlib.crc32(k + d) == struct.unpack(\">I\", b[p+8+n:p+12+n])[0]\n"
                       "    w, h = struct.unpack(\">II\", d[:8]) if k == b\"IHDR\" else (w, h)\n"
                       "    z += d if k == b\"IDAT\" else b\"\"; p += 12 + n\n"
                       "print(len(zlib.decompress(z)) == (4 * w + 1) * h, w, len(b) < w * h)' %s",
                       cli_path("a.png"));
        CHECK_STR(got, "True 300 True\n");
    }
    cli_finish();
}

TEST(raster_writes_geotiff_with_gdal)
{
    int status;
    make_plane();
    char path[100], command[300];
    snprintf(path, sizeof path, "%s", cli_path("a.tif"));
    snprintf(command, sizeof command, "PATH=/nonexistent %s -h 127.0.0.1 -p %s raster t z %s 2>&1",
             getenv("DELAUNAY"), cli_daemon.port_text, path);
    CHECK(strstr(peer_shell(&status, "%s", command),
                 "GeoTIFF needs gdal_translate (Debian: gdal-bin)") != NULL);
    CHECK(status == 1);
    CHECK_STR(peer_shell(&status, "ls %s", cli_path("")), "");
    peer_shell(&status, "command -v gdal_translate");
    bool can_convert = status == 0;
    if (can_convert) {
        raster(&status, "a.tif", "--width 2");
        CHECK(status == 0);
        CHECK_STR(peer_shell(&status, "ls %s", cli_path("")), "a.tif\n");
        const char *got = peer_shell(&status, "gdalinfo %s", path);
        CHECK(strstr(got, "Size is 2, 2\n") && strstr(got, "Pixel Size = (2.0") != NULL);
    }
    cli_finish();
    if (!can_convert)
        SKIP("the Debian package gdal-bin is missing");
}

TEST(raster_refuses_invalid_sizes)
{
    static const char *const wrong[] = {"--cell 0",      "--cell x",         "--cell nan",
                                        "--width 0",     "--width 2.5",      "--width 1e9",
                                        "--max-edge -1", "--viewport 1,2,3", "--format jpg"};
    int status;
    make_plane();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        raster(&status, "a.asc", wrong[i]);
        CHECK_MSG(status == 2, "%s", wrong[i]);
    }
    CHECK(strstr(raster(&status, "a.asc", "--cell 1e-9"), "too many cells") && status == 1);
    CHECK(strstr(raster(&status, "a.asc", "--cell 1 --width 4"), "--cell, or --width") &&
          status == 2);
    CHECK(strstr(cli_run(&status, "raster t z - -f png"), "png needs a file") && status == 2);
    CHECK(access(cli_path("a.asc"), F_OK) != 0);
    cli_finish();
}

TEST(raster_of_points_without_extent_needs_the_side_of_a_cell)
{
    int status;
    cli_begin();
    cli_run_well("add t fields z 1 2 3");
    cli_run_well("triangulate t");
    CHECK(strstr(raster(&status, "a.asc", ""), "--cell sets") && status == 1);
    CHECK(strstr(raster(&status, "a.asc", "--width 4"), "--cell sets") && status == 1);
    cli_expect("raster t z - --cell 2",
               "ncols 1\nnrows 1\nxllcorner 1\nyllcorner 2\ncellsize 2\nNODATA_value -9999\n"
               "-9999\n");
    cli_run_well("add t 1 4");
    CHECK(strstr(raster(&status, "a.asc", "--width 4"), "--cell sets") && status == 1);
    raster(&status, "a.asc", "");
    CHECK(status == 0);
    cli_finish();
}

TEST(raster_refuses_floats_for_values_beyond_them)
{
    int status;
    make_plane();
    cli_run_well("fset t z 0 1e300");
    CHECK(strstr(raster(&status, "a.bil", "--width 2"), "beyond those of 32-bit floats") != NULL);
    CHECK(status == 1 && access(cli_path("a.hdr"), F_OK) != 0);
    raster(&status, "a.asc", "--width 2");
    CHECK(status == 0);
    cli_finish();
}

TEST(raster_without_a_file_sends_the_request)
{
    make_plane();
    int status;
    const char *out = cli_run(&status, "raster t z 0 0 4 4 1 2");
    CHECK(status == 0 && strncmp(out, "OK 2", 4) == 0 && strstr(out, "\n32\n12\n") != NULL);
    cli_finish();
}

TEST(show_draws_heights_unless_the_mesh_is_requested)
{
    int status;
    make_plane();
    cli_expect("show t --width 4 --height 2", "@@@@\n-===\n");
    const char *mesh = cli_run(&status, "show t --width 4 --height 2 --mesh");
    CHECK(status == 0 && (unsigned char)mesh[0] == 0xE2);
    CHECK(strstr(cli_run(&status, "show t --field y"), "NOFIELD") != NULL && status == 1);
    cli_expect("--json show t --width 4 --height 2",
               "{\"ok\":true,\"lines\":[\"@@@@\",\"-===\"]}\n");
    cli_finish();
}

TEST(show_has_a_legend_of_heights_where_there_is_room)
{
    int status;
    char out[60000];
    make_plane();
    const char *plain = cli_run(&status, "show t --width 60 --height 8");
    size_t lines = 0;
    for (const char *p = plain; *p != '\0'; p++)
        lines += *p == '\n';
    CHECK_MSG(status == 0 && lines <= 8, "%s", plain);
    CHECK_MSG(strstr(plain, "\nz  ") != NULL &&
                  strstr(plain, " ...:::---===+++***###%%%@@@ ") != NULL,
              "%s", plain);
    CHECK(strstr(cli_run(&status, "show t --width 60 --height 7"), "z  ") == NULL && status == 0);
    CHECK(strstr(cli_run(&status, "show t --width 59 --height 8"), "z  ") == NULL && status == 0);
    CHECK(strstr(cli_run(&status, "--json show t --width 60 --height 8"), "z  ") == NULL &&
          status == 0);
    unsetenv("NO_COLOR");
    setenv("COLORTERM", "truecolor", 1);
    cli_run_on_terminal(cli_daemon.port_text, "show t --width 60 --height 8", out, sizeof out);
    const char *legend = strstr(out, "z  ");
    CHECK(legend != NULL && strstr(legend, "\033[48;2;70;128;88m") != NULL &&
          strstr(legend, "\033[0m ") != NULL);
    cli_finish();
}

TEST(show_draws_the_mesh_of_points_on_a_line_that_have_heights)
{
    int status;
    cli_begin();
    cli_run_well("add t fields z 1 2 3");
    cli_run_well("triangulate t");
    const char *mesh = cli_run(&status, "show t --width 4 --height 2");
    CHECK(status == 0 && (unsigned char)mesh[0] == 0xE2);
    cli_run_well("add t fields z 1 4 5  1 7 6");
    mesh = cli_run(&status, "show t --width 4 --height 2");
    CHECK(status == 0 && (unsigned char)mesh[0] == 0xE2);
    cli_finish();
}

TEST(show_uses_the_colours_that_the_terminal_has)
{
    char out[5000];
    make_plane();
    unsetenv("NO_COLOR");
    setenv("COLORTERM", "truecolor", 1);
    cli_run_on_terminal(cli_daemon.port_text, "show t --width 4 --height 2", out, sizeof out);
    CHECK(strstr(out, "\033[38;2;") != NULL && strstr(out, "\033[48;2;") != NULL);
    CHECK(strstr(out, "\xE2\x96\x80") != NULL);
    setenv("COLORTERM", "", 1);
    cli_run_on_terminal(cli_daemon.port_text, "show t --width 4 --height 2", out, sizeof out);
    CHECK(strstr(out, "\033[38;5;") != NULL && strstr(out, "38;2;") == NULL);
    CHECK(show_relief_cube(0x000000) == 16 && show_relief_cube(0xFFFFFF) == 231);
    CHECK(show_relief_cube(0xFF0000) == 196 && show_relief_cube(0x5F87AF) == 67);
    cli_finish();
}
