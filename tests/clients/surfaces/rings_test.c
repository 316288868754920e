/* rings_test.c - loops of an alpha shape become polygons with their holes. */
#include "clients/surfaces/rings.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

/* The corners of three squares, counterclockwise: the second one is beside the first one, the third one in it. */
static const double square[] = {-2, -2, 2, -2, 2,  2,  -2, 2,  7, -2, 11, -2,
                                11, 2,  7, 2,  -1, -1, 1,  -1, 1, 1,  -1, 1};

static void take(struct paths *r, const char *row)
{
    const char *fault;
    CHECK_MSG(rings_take(r, row, strlen(row), &fault), "%s", fault);
}

TEST(holes_follow_their_outer_ring_and_polygons_are_written_with_the_first_corner_at_the_end)
{
    char *text = NULL;
    size_t n;
    struct paths r = {0};
    struct shapes s = {.kind = SHAPE_RING};
    take(&r, "outer 4 0 1 2 3");
    take(&r, "outer 4 4 5 6 7");
    take(&r, "hole 4 11 10 9 8");
    CHECK(rings_to_shapes(&r, square, 2.5, &s) && shapes_count(&s) == 2);
    FILE *out = open_memstream(&text, &n);
    CHECK(out != NULL);
    shapes_write_wkt(out, &s);
    shapes_write_geojson(out, &s);
    CHECK(fclose(out) == 0);
    CHECK_STR(
        text,
        "WKT,radius,holes\n"
        "\"POLYGON ((-2 -2,2 -2,2 2,-2 2,-2 -2),(-1 1,1 1,1 -1,-1 -1,-1 1))\",2.5,1\n"
        "\"POLYGON ((7 -2,11 -2,11 2,7 2,7 -2))\",2.5,0\n"
        "{\"type\":\"FeatureCollection\",\"features\":[\n"
        "{\"type\":\"Feature\",\"properties\":{\"radius\":2.5,\"holes\":1},\"geometry\":{"
        "\"type\":\"Polygon\",\"coordinates\":[[[-2,-2],[2,-2],[2,2],[-2,2],[-2,-2]],"
        "[[-1,1],[1,1],[1,-1],[-1,-1],[-1,1]]]}},\n"
        "{\"type\":\"Feature\",\"properties\":{\"radius\":2.5,\"holes\":0},\"geometry\":{"
        "\"type\":\"Polygon\",\"coordinates\":[[[7,-2],[11,-2],[11,2],[7,2],[7,-2]]]}}\n]}\n");
    free(text);
    shapes_free(&s);
    paths_free(&r);
}

TEST(rows_that_are_no_loops_are_refused)
{
    static const char *const bad[] = {"",
                                      "inner 3 1 2 3",
                                      "hole",
                                      "hole 2 1 2",
                                      "outer 3 1 2",
                                      "outer 3 1 2 x",
                                      "outer 4000000000 1 2 3"};
    struct paths r = {0};
    const char *fault = NULL;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!rings_take(&r, bad[i], strlen(bad[i]), &fault) && fault != NULL, "%s", bad[i]);
    CHECK(r.n == 0);
    paths_free(&r);
}

TEST(a_hole_in_no_ring_is_a_fault)
{
    struct paths r = {0};
    struct shapes s = {.kind = SHAPE_RING};
    take(&r, "outer 4 0 1 2 3");
    take(&r, "hole 4 4 5 6 7");
    CHECK(!rings_to_shapes(&r, square, 1, &s) && strstr(s.fault, "in none of its parts") != NULL);
    shapes_free(&s);
    paths_free(&r);
}
