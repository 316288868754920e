/* crs_test.c - the reference system that a user names is written into files: GeoJSON, and rasters with what belongs beside them. */
#include "clients/meshes/crs.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/clients/cli.h"
#include "tests/clients/peer.h"
#include "tests/test.h"

TEST(reference_systems_are_read_as_names_and_as_urns)
{
    static const struct {
        const char *text, *authority, *code;
    } good[] = {{"EPSG:32629", "EPSG", "32629"},
                {"epsg:4326", "EPSG", "4326"},
                {"urn:ogc:def:crs:EPSG::32629", "EPSG", "32629"},
                {"URN:OGC:DEF:CRS:epsg:9.8.2:32629", "EPSG", "32629"},
                {"ESRI:102100", "ESRI", "102100"},
                {"crs84", "OGC", "CRS84"},
                {"OGC:CRS84", "OGC", "CRS84"},
                {"urn:ogc:def:crs:OGC:1.3:CRS84", "OGC", "CRS84"}};
    static const char *const bad[] = {"",
                                      "32629",
                                      "EPSG",
                                      "EPSG:",
                                      ":32629",
                                      "EPSG:32 629",
                                      "EPSG:1\"",
                                      "EPSG:1:2",
                                      "urn:ogc:def:crs:EPSG:32629x-",
                                      "urn:ogc:def:crs:EPSG:32629",
                                      "EPSG:123456789012345678901",
                                      "WGS 84:1"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        struct crs crs = {.code = ""};
        CHECK(!crs_is_given(&crs));
        CHECK_MSG(crs_read(good[i].text, &crs), "%s", good[i].text);
        CHECK_STR(crs.authority, good[i].authority);
        CHECK_STR(crs.code, good[i].code);
        CHECK(crs_is_given(&crs));
    }
    struct crs crs = {.authority = "A", .code = "1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!crs_read(bad[i], &crs) && crs.code[0] == '1', "%s", bad[i]);
    CHECK(!crs_is_given(NULL));
}

static const char *begun(const char *name)
{
    static char text[300];
    struct crs crs = {.code = ""};
    FILE *out = fmemopen(text, sizeof text, "w");
    CHECK(out != NULL);
    if (name != NULL)
        CHECK(crs_read(name, &crs));
    crs_begin_geojson(out, name != NULL ? &crs : NULL);
    CHECK(fclose(out) == 0);
    return text;
}

TEST(geojson_has_a_member_crs_only_where_it_is_given)
{
    CHECK_STR(begun(NULL), "{\"type\":\"FeatureCollection\",\"features\":[\n");
    CHECK_STR(begun("EPSG:32629"),
              "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":"
              "\"urn:ogc:def:crs:EPSG::32629\"}},\"features\":[\n");
    CHECK(strstr(begun("CRS84"), "\"urn:ogc:def:crs:OGC:1.3:CRS84\"") != NULL);
}

/* The plane z = x over a square with a line, and the square alone. */
static void make_set(void)
{
    cli_begin();
    cli_run_well("add t 500000 10  500004 10  500004 14  500000 14");
    cli_run_well("fset t z 0 0  1 4  2 4  3 0");
    cli_run_well("constrain t 0 2");
    cli_run_well("add u 500000 10  500004 10  500004 14  500000 14");
    cli_run_well("triangulate u");
    cli_run_well("triangulate t");
}

/* Runs `delaunay BEFORE FILE AFTER` on a file in the directory. */
static const char *run(int *status, const char *before, const char *file, const char *after)
{
    char command[300];
    snprintf(command, sizeof command, "%s %s %s", before, cli_path(file), after);
    return cli_run(status, command);
}

TEST(all_geojson_has_the_reference_system_and_is_read_again)
{
    static const struct {
        const char *before, *after;
    } commands[] = {{"contour t z", "--every 1 --crs EPSG:32629"},
                    {"contour t z", "--bands --every 1 --crs EPSG:32629"},
                    {"voronoi u", "--crs EPSG:32629"},
                    {"alpha u 4", "--crs EPSG:32629"},
                    {"export t", "--crs urn:ogc:def:crs:EPSG::32629"},
                    {"export t", "--lines --crs EPSG:32629"}};
    int status;
    make_set();
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        const char *out = run(&status, commands[i].before, "a.geojson", commands[i].after);
        CHECK_MSG(status == 0, "%s: %s", commands[i].before, out);
        const char *got = peer_shell(&status, "head -1 %s", cli_path("a.geojson"));
        CHECK_MSG(strstr(got, "{\"name\":\"urn:ogc:def:crs:EPSG::32629\"}},\"features\":[\n") !=
                      NULL,
                  "%s: %s", commands[i].before, got);
        out = run(&status, "load copy", "a.geojson", "--dry-run");
        CHECK_MSG(status == 0 && strstr(out, "geojson: points: 0") == NULL, "%s", out);
    }
    cli_finish();
}

TEST(a_reference_system_is_refused_where_a_format_has_none)
{
    static const char *const wrong[] = {
        "contour t z a.svg --crs EPSG:1",   "voronoi t a.wkt --crs EPSG:1",
        "alpha t 4 a.wkt --crs EPSG:1",     "export t a.obj --crs EPSG:1",
        "export t a.svg --crs EPSG:1",      "export t a.ndjson --crs EPSG:1",
        "raster t z - --crs EPSG:1",        "raster t z a.asc --crs 1",
        "contour t z a.geojson --crs EPSG", "run a.csv a.obj --crs EPSG:1"};
    int status;
    make_set();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *out = cli_run(&status, wrong[i]);
        CHECK_MSG(status == 2, "%s: %s", wrong[i], out);
    }
    cli_finish();
}

TEST(rasters_have_their_reference_system_beside_them)
{
    int status;
    make_set();
    char command[400];
    snprintf(command, sizeof command,
             "PATH=/none %s -h 127.0.0.1 -p %s raster t z %s --width 2 --crs EPSG:32629 2>&1",
             getenv("DELAUNAY"), cli_daemon.port_text, cli_path("a.asc"));
    CHECK(strstr(peer_shell(&status, "%s", command),
                 "--crs needs gdalsrsinfo (Debian: gdal-bin)") != NULL);
    CHECK(status == 1 && access(cli_path("a.asc"), F_OK) != 0);
    run(&status, "raster t z", "a.png", "--width 2 --crs EPSG:32629");
    CHECK(status == 0);
    CHECK_STR(peer_shell(&status, "cat %s", cli_path("a.png.aux.xml")),
              "<PAMDataset>\n  <SRS>EPSG:32629</SRS>\n</PAMDataset>\n");
    cli_write("b.png.aux.xml", "mine\n");
    CHECK(strstr(run(&status, "raster t z", "b.png", "--crs EPSG:32629"), "--force replaces it") !=
          NULL);
    CHECK(status == 1 && access(cli_path("b.png"), F_OK) != 0);
    cli_finish();
}

static bool has_gdal(void)
{
    int status;
    peer_shell(&status, "command -v gdalinfo && command -v gdalsrsinfo && command -v ogrinfo");
    return status == 0;
}

TEST(gdal_reads_where_rasters_and_geojson_lie)
{
    static const char *const endings[] = {"asc", "bil", "png", "tif"};
    int status;
    if (!has_gdal())
        SKIP("the Debian package gdal-bin is missing");
    make_set();
    for (size_t i = 0; i < 4; i++) {
        char file[20];
        snprintf(file, sizeof file, "a.%s", endings[i]);
        const char *out = run(&status, "raster t z", file,
                              "--cell 2 --viewport 500000,9,500006,13 --crs EPSG:32629");
        CHECK_MSG(status == 0, "%s", out);
        const char *got = peer_shell(&status, "gdalinfo %s", cli_path(file));
        CHECK_MSG(strstr(got, "Size is 3, 2\n") && strstr(got, "PROJCRS[\"WGS") &&
                      strstr(got, "one 29N\"") && strstr(got, "\nOrigin = (500000.0000000000") &&
                      strstr(got, ",13.0000000000") && strstr(got, "\nPixel Size = (2.0000000000"),
                  "%s: %s", file, got);
        if (i == 3)
            CHECK_MSG(strstr(got, "ID[\"EPSG\",32629]]") != NULL, "%s", got);
    }
    CHECK(strstr(run(&status, "raster t z", "b.asc", "--crs EPSG:999999"),
                 "gdalsrsinfo knows no such reference system"));
    CHECK(status == 1 && access(cli_path("b.asc"), F_OK) != 0 &&
          access(cli_path("b.prj"), F_OK) != 0);
    CHECK(
        strstr(run(&status, "raster t z", "b.tif", "--crs EPSG:999999"), "gdal_translate failed"));
    CHECK(status == 1 && access(cli_path("b.tif"), F_OK) != 0);
    run(&status, "contour t z", "c.geojson", "--every 1 --crs EPSG:32629");
    const char *got = peer_shell(&status, "ogrinfo -so -al %s", cli_path("c.geojson"));
    CHECK_MSG(strstr(got, "ID[\"EPSG\",32629]]") != NULL && strstr(got, "Extent: (500001.0"), "%s",
              got);
    cli_finish();
}

/* What `raster` writes `load` reads: the centres of the cells, with their values. */
TEST(a_raster_that_was_written_is_read_again)
{
    int status;
    make_set();
    run(&status, "raster t z", "a.asc", "--cell 2");
    CHECK(status == 0);
    run(&status, "load back", "a.asc", "");
    CHECK(status == 0);
    cli_expect("points back fields z",
               "OK 4\n0 500001 13 1\n1 500003 13 3\n2 500001 11 1\n3 500003 11 3\n");
    if (has_gdal()) {
        run(&status, "raster t z", "a.tif", "--cell 2");
        run(&status, "load from", "a.tif", "");
        CHECK(status == 0);
        cli_expect("points from fields z",
                   "OK 4\n0 500001 13 1\n1 500003 13 3\n2 500001 11 1\n3 500003 11 3\n");
    }
    cli_finish();
}
