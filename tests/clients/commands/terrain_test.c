/* terrain_test.c - `delaunay run` and `draw` of terrain models, without a server. */
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

static char directory[64];

static void begin(void)
{
    CHECK(getenv("DELAUNAY") != NULL);
    snprintf(directory, sizeof directory, "/tmp/delaunay_terrain_XXXXXX");
    CHECK(mkdtemp(directory) != NULL);
}

static void finish(void)
{
    int status;
    peer_shell(&status, "rm -r %s", directory);
}

/* Runs a shell command in the directory, in which $D is `delaunay`; nothing listens at its default address. */
static const char *run(int *status, const char *command)
{
    return peer_shell(status,
                      "D=$(realpath %s) DELAUNAYD=$(realpath %s) DELAUNAY_PORT=1 && "
                      "export D DELAUNAYD DELAUNAY_PORT && cd %s && { %s; } 2>&1",
                      getenv("DELAUNAY"), getenv("DELAUNAYD"), directory, command);
}

static void expect(const char *command, const char *want)
{
    int status;
    const char *got = run(&status, command);
    CHECK_STR(got, want);
    CHECK_MSG(status == 0, "%s: status %d", command, status);
}

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
    begin();
    expect(MAKE_GRID "$D run a.asc - -f node", GRID_NOTES("a.asc") GRID_NODES);
    expect("gzip -k a.asc; $D run a.asc.gz - -f node", GRID_NOTES("a.asc.gz") GRID_NODES);
    expect("mv a.asc b; $D run - - -f node < b", GRID_NOTES("standard input") GRID_NODES);
    expect("printf 'ncols 1\\nnrows 1\\nxllcorner 0\\nyllcorner 0\\ncellsize 1\\n3,5' > bad.asc; "
           "$D run bad.asc - || echo $?",
           "delaunay: bad.asc:6: row 1, column 1: not a number: \"3,5\"; nothing was loaded "
           "(--skip-bad leaves such out)\n1\n");
    expect("sed s/3,5$/nan/ bad.asc > empty.asc; $D run empty.asc - || echo $?",
           "delaunay: empty.asc: using the centres of 1 x 1 cells of 1 x 1\n"
           "delaunay: empty.asc: 1 cell without a value (-9999) is left out\n"
           "delaunay: empty.asc: there are no points in it\n1\n");
    finish();
}

/* A program in place of gdal_translate, which is asked for the frame first. */
TEST(run_reads_other_rasters_through_gdal_translate)
{
    static const char fake[] =
        "printf '#!/bin/sh\\necho \"$@\" >> asked\\n[ -f \"$7\" ] || exit 9\\n"
        "cat \"$3\".out; exit $(cat code)\\n' > gdal_translate; chmod +x gdal_translate; echo 0 > "
        "code; "
        "echo '<VRTDataset rasterXSize=\"3\" "
        "rasterYSize=\"2\"><GeoTransform>0.5,0.25,0,10.5,0,-0.25"
        "</GeoTransform><VRTRasterBand band=\"1\"/></VRTDataset>' > VRT.out; " MAKE_GRID
        "sed s/0.5$/0.500000000001/ a.asc > AAIGrid.out; echo 'PROJCS[\"a\"]' >> AAIGrid.out; "
        "printf 'II*\\0' > a.img; cp a.img B.TIF; cp a.img c; PATH=$PWD:$PATH; ";
    char command[1500];
    begin();
    snprintf(command, sizeof command, "%s $D run a.img - -f node; cat asked", fake);
    expect(command, GRID_NOTES("a.img") GRID_NODES
           "-q -of VRT -ot Float64 -unscale a.img /vsistdout/\n"
           "-q -of AAIGrid -ot Float64 -unscale a.img /vsistdout/\n");
    expect("PATH=$PWD:$PATH; $D run B.TIF - -f node", GRID_NOTES("B.TIF") GRID_NODES);
    expect("PATH=$PWD:$PATH; $D run c - -f node", GRID_NOTES("c") GRID_NODES);
    expect(
        "$D run - - < c || echo $?",
        "delaunay: standard input: a raster is read from a file of its own or a zip archive, not "
        "from a pipe; nothing was loaded\n1\n");
    expect("PATH=/none $D run c - || echo $?",
           "delaunay: c: to read this raster the program gdal_translate is needed (Debian: "
           "gdal-bin): No such file or directory; nothing was loaded\n1\n");
    expect("echo 1 > code; PATH=$PWD:$PATH; $D run a.img - || echo $?",
           "delaunay: a.img: gdal_translate could not read all of it; nothing was loaded\n1\n");
    finish();
}

/* Exact: the place of a GeoTIFF has more digits than the headers that GDAL writes, its values are binary. */
TEST(run_reads_geotiff_with_all_digits_through_gdal)
{
    if (!has("gdal_translate"))
        SKIP("the Debian package gdal-bin is missing");
    begin();
    run(&(int){0},
        "printf 'ncols 2\\nnrows 2\\nxllcorner -6.2501388888888888\\nyllcorner 53\\n"
        "cellsize 0.00027777777777777778\\nNODATA_value -9999\\n"
        "0.1 2.123456789012345\\n-9999 7\\n' > a.asc; "
        "gdal_translate -q -ot Float64 -co PROFILE=GeoTIFF --config AAIGRID_DATATYPE Float64 a.asc "
        "a.tif");
    expect("$D run a.asc - -f node 2> /dev/null > want; $D run a.tif - -f node 2> /dev/null > got; "
           "diff want got && head -2 got",
           "3 2 1 1\n0 -6.25 53.000416666666666 0.1 1\n");
    expect(
        "gdal_translate -q -b 1 -b 1 a.tif two.tif; $D run two.tif - || echo $?",
        "delaunay: two.tif: the raster has several bands; gdal_translate -b 1 IN OUT chooses one; "
        "nothing was loaded\n1\n");
    if (has("zip"))
        expect("zip -q a.zip a.tif; $D run a.zip - -f node 2> /dev/null | diff want -", "");
    finish();
}
