/* shapes_test.c - cells, contour lines and bands read from rows, written as GeoJSON and WKT. */
#include "clients/surfaces/shapes.h"

#include <stdlib.h>
#include <string.h>

#include "clients/meshes/bounds.h"
#include "tests/test.h"

static bool take(struct shapes *s, const char *row)
{
    return shapes_take(s, row, strlen(row));
}

/* The output of a writer; the caller frees it. */
static char *written(const struct shapes *s, void (*write)(FILE *, const struct shapes *))
{
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    CHECK(out != NULL);
    write(out, s);
    CHECK(fclose(out) == 0);
    return text;
}

TEST(cells_become_polygons_that_end_where_they_begin)
{
    struct shapes s = {.kind = SHAPE_CELL};
    CHECK(take(&s, "3 3 0 0 1.5 0 0 1e-7"));
    CHECK(take(&s, "4294967295 4 0 0 1 0 1 1 0 1"));
    CHECK(s.n == 2 && s.corners == 7 && s.shape[1].first == 3 && s.shape[1].closed);
    char *text = written(&s, shapes_write_geojson);
    CHECK_STR(text,
              "{\"type\":\"FeatureCollection\",\"features\":[\n"
              "{\"type\":\"Feature\",\"properties\":{\"id\":3},\"geometry\":{\"type\":\"Polygon\","
              "\"coordinates\":[[[0,0],[1.5,0],[0,1e-7],[0,0]]]}},\n"
              "{\"type\":\"Feature\",\"properties\":{\"id\":4294967295},\"geometry\":{\"type\":"
              "\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,1],[0,0]]]}}\n]}\n");
    free(text);
    text = written(&s, shapes_write_wkt);
    CHECK_STR(text, "WKT,id\n\"POLYGON ((0 0,1.5 0,0 1e-7,0 0))\",3\n"
                    "\"POLYGON ((0 0,1 0,1 1,0 1,0 0))\",4294967295\n");
    free(text);
    shapes_free(&s);
}

TEST(contours_become_lines_with_their_level)
{
    struct shapes s = {.kind = SHAPE_CONTOUR};
    CHECK(take(&s, "-5 open 2 0 0 1 2"));
    CHECK(take(&s, "100.5 closed 3 0 0 1 0 0 1"));
    char *text = written(&s, shapes_write_geojson);
    CHECK_STR(text,
              "{\"type\":\"FeatureCollection\",\"features\":[\n"
              "{\"type\":\"Feature\",\"properties\":{\"level\":-5,\"closed\":false},\"geometry\":{"
              "\"type\":\"LineString\",\"coordinates\":[[0,0],[1,2]]}},\n"
              "{\"type\":\"Feature\",\"properties\":{\"level\":100.5,\"closed\":true},\"geometry\":"
              "{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,0],[0,1],[0,0]]}}\n]}\n");
    free(text);
    text = written(&s, shapes_write_wkt);
    CHECK_STR(text, "WKT,level,closed\n\"LINESTRING (0 0,1 2)\",-5,false\n"
                    "\"LINESTRING (0 0,1 0,0 1,0 0)\",100.5,true\n");
    free(text);
    shapes_free(&s);
}

TEST(bands_become_polygons_with_their_holes)
{
    struct shapes s = {.kind = SHAPE_BAND};
    CHECK(take(&s, "-inf 2.5 0 outer 3 0 0 9 0 0 9"));
    CHECK(take(&s, "-inf 2.5 0 hole 3 1 1 1 2 2 1"));
    CHECK(take(&s, "2.5 inf 1 outer 3 1 1 2 1 1 2"));
    CHECK(s.n == 3 && shapes_count(&s) == 2 && shapes_rings(&s, 0) == 2 &&
          shapes_rings(&s, 2) == 1);
    char *text = written(&s, shapes_write_geojson);
    CHECK_STR(text,
              "{\"type\":\"FeatureCollection\",\"features\":[\n"
              "{\"type\":\"Feature\",\"properties\":{\"low\":null,\"high\":2.5},\"geometry\":{"
              "\"type\":\"Polygon\",\"coordinates\":[[[0,0],[9,0],[0,9],[0,0]],"
              "[[1,1],[1,2],[2,1],[1,1]]]}},\n"
              "{\"type\":\"Feature\",\"properties\":{\"low\":2.5,\"high\":null},\"geometry\":{"
              "\"type\":\"Polygon\",\"coordinates\":[[[1,1],[2,1],[1,2],[1,1]]]}}\n]}\n");
    free(text);
    text = written(&s, shapes_write_wkt);
    CHECK_STR(text, "WKT,low,high\n"
                    "\"POLYGON ((0 0,9 0,0 9,0 0),(1 1,1 2,2 1,1 1))\",-inf,2.5\n"
                    "\"POLYGON ((1 1,2 1,1 2,1 1))\",2.5,inf\n");
    free(text);
    shapes_free(&s);
}

TEST(a_cell_without_corners_is_left_out)
{
    struct shapes s = {.kind = SHAPE_CELL};
    double box[4];
    CHECK(take(&s, "7 0") && s.n == 0 && !bounds_of(s.xy, s.corners, box));
    CHECK(take(&s, "8 3 -1 5 2 5 0 9") && bounds_of(s.xy, s.corners, box));
    CHECK(box[0] == -1 && box[1] == 5 && box[2] == 2 && box[3] == 9);
    shapes_free(&s);
}

TEST(rows_that_are_not_shapes_are_refused)
{
    static const char *const cells[] = {"",
                                        "a 3 0 0 1 0 0 1",
                                        "1",
                                        "1 3 0 0 1 0 0",
                                        "1 3 0 0 1 0 0 1 7",
                                        "1 -3 0 0",
                                        "1 4294967295 0 0",
                                        "1 3 0 0 1 nan 0 1"};
    static const char *const lines[] = {
        "",       "inf open 2 0 0 1 1",        "5 2 0 0 1 1", "5 ajar 2 0 0 1 1", "5 open 2 0 0 1",
        "5 open", "5 closed 3 0 0 1 0 0 1 4 5"};
    static const char *const bands[] = {"",
                                        "1",
                                        "1 2 0 open 3 0 0 1 0 0 1",
                                        "1 2 outer 3 0 0 1 0 0 1",
                                        "1 2 0 hole 3 0 0 1 0 0 1",
                                        "1 nan 0 outer 3 0 0 1 0 0 1",
                                        "infinity 2 0 outer 3 0 0 1 0 0 1"};
    for (size_t i = 0; i < sizeof bands / sizeof bands[0]; i++) {
        struct shapes s = {.kind = SHAPE_BAND};
        CHECK_MSG(!take(&s, bands[i]) && s.fault != NULL && s.n == 0, "%s", bands[i]);
        shapes_free(&s);
    }
    for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
        struct shapes s = {.kind = SHAPE_CELL};
        CHECK_MSG(!take(&s, cells[i]) && s.fault != NULL && s.n == 0, "%s", cells[i]);
        shapes_free(&s);
    }
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct shapes s = {.kind = SHAPE_CONTOUR};
        CHECK_MSG(!take(&s, lines[i]) && s.fault != NULL && s.n == 0, "%s", lines[i]);
        shapes_free(&s);
    }
}

TEST(many_shapes_with_many_corners_are_kept_apart)
{
    struct shapes s = {.kind = SHAPE_CONTOUR};
    char row[20000];
    for (unsigned i = 0; i < 600; i++) {
        size_t n = (size_t)snprintf(row, sizeof row, "%u open %u", i, 2 + i);
        for (unsigned k = 0; k < 2 + i; k++)
            n += (size_t)snprintf(row + n, sizeof row - n, " %u %u", i, k);
        CHECK(shapes_take(&s, row, n));
    }
    for (unsigned i = 0; i < 600; i++)
        for (unsigned k = 0; k < 2 + i; k++)
            CHECK(s.shape[i].n == 2 + i && s.xy[2 * (s.shape[i].first + k)] == i &&
                  s.xy[2 * (s.shape[i].first + k) + 1] == k);
    shapes_free(&s);
}
