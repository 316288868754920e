/* terrain_test.c - `delaunay run` and `draw` of terrain models, without a server. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/folder.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static bool has(const char *program)
{
    int status;
    peer_shell(&status, "command -v %s", program);
    return status == 0;
}

/* A grid of 3 x 2 cells, one of them without a value. */
#define MAKE_GRID                                                                                  \
    "printf 'ncols 3\\nnrows 2\\nxllcorner 0.5\\nyllcorner 10\\ncellsize 0.25\\n"                  \
    "NODATA_value -1\\n1.5 2.25 -1\\n4 5 6\\n' > a.asc; "

#define GRID_NODES                                                                                 \
    "5 2 1 1\n0 0.625 10.375 1.5 1\n1 0.875 10.375 2.25 1\n2 0.625 10.125 4 1\n"                   \
    "3 0.875 10.125 5 1\n4 1.125 10.125 6 1\n"

#define GRID_NOTES(name)                                                                           \
    "delaunay: " name ": using the centres of 3 x 2 cells of 0.25 x 0.25\n"                        \
    "delaunay: " name ": 1 cell without a value (-1) is left out\n"

TEST(run_reads_the_centres_of_the_cells_of_an_ascii_grid)
{
    folder_begin();
    folder_expect(MAKE_GRID "$D run a.asc - -f node", GRID_NOTES("a.asc") GRID_NODES);
    folder_expect("gzip -k a.asc; $D run a.asc.gz - -f node", GRID_NOTES("a.asc.gz") GRID_NODES);
    folder_expect("mv a.asc b; $D run - - -f node < b", GRID_NOTES("standard input") GRID_NODES);
    folder_expect(
        "printf 'ncols 1\\nnrows 1\\nxllcorner 0\\nyllcorner 0\\ncellsize 1\\n3,5' > bad.asc; "
        "$D run bad.asc - || echo $?",
        "delaunay: bad.asc:6: row 1, column 1: not a number: \"3,5\"; nothing was loaded "
        "(--skip-bad leaves such out)\n1\n");
    folder_expect("sed s/3,5$/nan/ bad.asc > empty.asc; $D run empty.asc - || echo $?",
                  "delaunay: empty.asc: using the centres of 1 x 1 cells of 1 x 1\n"
                  "delaunay: empty.asc: 1 cell without a value (-9999) is left out\n"
                  "delaunay: empty.asc: there are no points in it\n1\n");
    folder_finish();
}

/* A program in place of gdal_translate, which is asked for the frame first. */
TEST(run_reads_other_rasters_through_gdal_translate)
{
    static const char fake[] =
        "printf '#!/bin/sh\\necho \"$@\" >> asked\\n"
        "cat \"$3\".out; exit $(cat code)\\n' > gdal_translate; chmod +x gdal_translate; echo 0 > "
        "code; "
        "echo '<VRTDataset rasterXSize=\"3\" "
        "rasterYSize=\"2\"><GeoTransform>0.5,0.25,0,10.5,0,-0.25"
        "</GeoTransform><VRTRasterBand band=\"1\"/></VRTDataset>' > VRT.out; " MAKE_GRID
        "sed s/0.5$/0.500000000001/ a.asc > AAIGrid.out; echo 'PROJCS[\"a\"]' >> AAIGrid.out; "
        "printf 'II*\\0' > a.img; cp a.img B.TIF; cp a.img c; PATH=$PWD:$PATH; ";
    char command[1500];
    folder_begin();
    snprintf(command, sizeof command, "%s $D run a.img - -f node; cat asked", fake);
    folder_expect(command, GRID_NOTES("a.img") GRID_NODES
                  "-q -of VRT -mo reader=delaunay a.img /vsistdout/\n"
                  "-q -of AAIGrid -ot Float64 -unscale -a_ullr 0 2 3 0 a.img /vsistdout/\n");
    folder_expect("PATH=$PWD:$PATH; $D run B.TIF - -f node", GRID_NOTES("B.TIF") GRID_NODES);
    folder_expect("PATH=$PWD:$PATH; $D run c - -f node", GRID_NOTES("c") GRID_NODES);
    folder_expect(
        "$D run - - < c || echo $?",
        "delaunay: standard input: a raster is read from a file of its own or a zip archive, not "
        "from a pipe; nothing was loaded\n1\n");
    folder_expect("PATH=/none $D run c - || echo $?",
                  "delaunay: c: to read this raster the program gdal_translate is needed (Debian: "
                  "gdal-bin): No such file or directory; nothing was loaded\n1\n");
    folder_expect(
        "echo 1 > code; PATH=$PWD:$PATH; $D run a.img - || echo $?",
        "delaunay: a.img: gdal_translate could not read all of it; nothing was loaded\n1\n");
    folder_finish();
}

/* Exact: the place of a GeoTIFF has more digits than the headers that GDAL writes, its values are binary. */
TEST(run_reads_geotiff_with_all_digits_through_gdal)
{
    if (!has("gdal_translate"))
        SKIP("the Debian package gdal-bin is missing");
    folder_begin();
    folder_run(
        &(int){0},
        "printf 'ncols 2\\nnrows 2\\nxllcorner -6.2501388888888888\\nyllcorner 53\\n"
        "cellsize 0.00027777777777777778\\nNODATA_value -9999\\n"
        "0.1 2.123456789012345\\n-9999 7\\n' > a.asc; "
        "gdal_translate -q -ot Float64 -co PROFILE=GeoTIFF --config AAIGRID_DATATYPE Float64 a.asc "
        "a.tif");
    folder_expect(
        "$D run a.asc - -f node 2> /dev/null > want; $D run a.tif - -f node 2> /dev/null > got; "
        "diff want got && head -2 got",
        "3 2 1 1\n0 -6.25 53.000416666666666 0.1 1\n");
    folder_expect(
        "gdal_translate -q -a_ullr 0 10 4 14 a.tif up.tif; $D run up.tif - -f node 2> /dev/null",
        "3 2 1 1\n0 1 11 0.1 1\n1 3 11 2.123456789012345 1\n2 3 13 7 1\n");
    folder_expect(
        "gdal_translate -q -a_srs EPSG:4326 a.tif map.tif; "
        "for f in a map; do $D draw $f.tif a.svg 2>&1 | grep -c 'a map of degrees'; done; true",
        "0\n1\n");
    folder_expect(
        "gdal_translate -q -b 1 -b 1 a.tif two.tif; $D run two.tif - || echo $?",
        "delaunay: two.tif: the raster has several bands; gdal_translate -b 1 IN OUT chooses one; "
        "nothing was loaded\n1\n");
    folder_expect("gdal_translate -q -of VRT a.tif a.vrt; $D run a.vrt - -f node 2> /dev/null | "
                  "diff want -",
                  "");
    if (has("zip"))
        folder_expect("zip -q a.zip a.tif; $D run a.zip - -f node 2> /dev/null | diff want -", "");
    folder_finish();
}

/* The value that means: none is one of the values before they are scaled; the cell of 10000 is 0 afterwards. */
TEST(run_reads_rasters_with_scaled_values_masks_and_an_affine_place)
{
    if (!has("gdal_translate") || !has("gdalwarp"))
        SKIP("the Debian package gdal-bin is missing");
    folder_begin();
    folder_run(&(int){0}, "printf 'ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                          "0 10000\n10010 9990\n' > a.asc; gdal_translate -q -ot Int32 -a_nodata 0 "
                          "-a_scale 0.5 -a_offset -5000 a.asc a.tif");
    folder_expect("$D run a.tif - -f node",
                  "delaunay: a.tif: using the centres of 2 x 2 cells of 1 x 1\n"
                  "delaunay: a.tif: 1 cell without a value (nan) is left out\n"
                  "3 2 1 1\n0 1.5 1.5 0 1\n1 0.5 0.5 5 1\n2 1.5 0.5 -5 1\n");
    folder_expect("gdal_translate -q -b 1 -mask 1 --config GDAL_TIFF_INTERNAL_MASK YES "
                  "-a_nodata none -ot Float32 a.asc b.tif; $D run b.tif - 2>&1 | cut -c 1-59; "
                  "gdalwarp -q -dstnodata -1 b.tif c.tif; $D run c.tif - -f node 2>/dev/null",
                  "delaunay: b.tif: the raster has a mask; gdalwarp -dstnodata\n"
                  "3 2 1 1\n0 1.5 1.5 10000 1\n1 0.5 0.5 10010 1\n2 1.5 0.5 9990 1\n");
    folder_expect(
        "gdal_translate -q -of VRT a.asc t.vrt; sed '/<GeoTransform>/s/>.*</>100, 1, 0.5, "
        "200, 0.25, -1</' t.vrt > d.vrt; $D run d.vrt - -f node 2>/dev/null",
        "4 2 1 1\n0 100.75 199.625 0 1\n1 101.75 199.875 10000 1\n"
        "2 101.25 198.625 10010 1\n3 102.25 198.875 9990 1\n");
    folder_finish();
}

/* A plane with a peak that is 4 above it. */
#define MAKE_PEAK                                                                                  \
    "printf 'ncols 5\\nnrows 5\\nxllcenter 0\\nyllcenter 0\\ncellsize 1\\n"                        \
    "4 5 6 7 8\\n3 4 5 6 7\\n2 3 8 5 6\\n1 2 3 4 5\\n0 1 2 3 4\\n' > a.asc; "

#define PEAK_NOTE(kept, off)                                                                       \
    "delaunay: a.asc: using the centres of 5 x 5 cells of 1 x 1\n"                                 \
    "delaunay: " kept " of 25 points are kept; the worst of the others is off by " off "\n"

TEST(run_keeps_as_few_points_as_the_error_needs)
{
    folder_begin();
    folder_expect(MAKE_PEAK "$D run a.asc - -f node --error 4",
                  PEAK_NOTE("4", "4") "4 2 1 1\n0 0 4 4 1\n1 4 4 8 1\n2 0 0 0 1\n3 4 0 4 1\n");
    folder_expect("$D run a.asc a.obj --error 3.99",
                  PEAK_NOTE("5", "2") "a.obj: 5 points, 4 triangles, hull of 4\n");
    folder_expect("$D run a.asc a.obj --error 1.99",
                  PEAK_NOTE("9", "0") "a.obj: 9 points, 12 triangles, hull of 4\n");
    folder_expect("$D run a.asc a.obj --most 7",
                  PEAK_NOTE("7", "2") "a.obj: 7 points, 8 triangles, hull of 4\n");
    folder_expect(
        "$D run a.asc a.obj --most 7 --error 3 --json 2> /dev/null | tr , '\\n' | grep -E "
        "'\"(points|error)'",
        "\"points\":5\n\"points\":25\n\"error\":2}\n");
    folder_expect("$D draw a.asc a.svg --error 1.99",
                  PEAK_NOTE("9", "0") "a.svg: 9 points, 12 triangles, hull of 4\n");
    folder_finish();
}

TEST(lines_stay_in_a_light_mesh_and_it_is_refined_afterwards)
{
    folder_begin();
    folder_expect(
        "printf 'WKT\nPOINT Z (0 0 0)\nPOINT Z (4 0 0)\nPOINT Z (4 4 0)\nPOINT Z (0 4 0)\n"
        "POINT Z (2 0.5 0)\n\"LINESTRING Z (1 1 0,3 3 0)\"\n' > a.csv; "
        "$D run a.csv - -f poly --error 9 2> /dev/null",
        "6 2 1 1\n0 0 0 0 1\n1 4 0 0 1\n2 4 4 0 1\n3 0 4 0 1\n4 1 1 0 0\n5 3 3 0 0\n1 1\n"
        "0 4 5 0\n0\n");
    int status;
    const char *got = folder_run(&status, "$D run a.csv a.obj --error 9 --angle 20");
    CHECK_MSG(strstr(got, "6 of 7 points are kept") && strstr(got, "the least angle is ") &&
                  status == 0,
              "%s", got);
    folder_finish();
}

TEST(a_light_mesh_needs_heights_and_room_for_the_hull)
{
    int status;
    folder_begin();
    folder_expect("printf 'x,y,h,z\n0,0,1,1\n4,0,2,1\n0,4,7,1\n1,1,5,1\n' > a.csv; "
                  "$D run a.csv - -f ele --error 1 --field h --fields 2> /dev/null; "
                  "$D run a.csv - -f ele --error 1 2> /dev/null",
                  "3 3 0\n0 0 1 3\n1 0 3 2\n2 1 2 3\n1 3 0\n0 0 1 2\n");
    const char *got =
        folder_run(&status, "cut -d , -f 1,2 a.csv > flat.csv; $D run flat.csv - --error 1");
    CHECK(strstr(got, "delaunay: --error and --most need heights, a field z of the points") &&
          status == 1);
    got = folder_run(&status, "$D run a.csv - --most 2");
    CHECK(strstr(got, "RANGE 3 points must stay") && status == 1);
    static const char *const wrong[] = {"--error -1", "--error x", "--error nan", "--most 0",
                                        "--most 2.5"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char command[100];
        snprintf(command, sizeof command, "$D run a.csv - %s", wrong[i]);
        folder_run(&status, command);
        CHECK_MSG(status == 2, "%s", wrong[i]);
    }
    folder_finish();
}
