/* rings_test.c - loops of an alpha shape become polygons with their holes. */
#include "clients/surfaces/rings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

/* Appends a square with this centre, counterclockwise, or a hole, clockwise. */
static void add_square(struct rings *r, double x, double y, double half, bool hole)
{
    static const double side[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    size_t at = r->corners;
    const char *row = hole ? "hole 4 0 1 2 3" : "outer 4 0 1 2 3";
    CHECK(rings_take(r, row, strlen(row)));
    for (size_t i = 0; i < 4; i++) {
        r->xy[2 * (at + i)] = x + half * side[hole ? 3 - i : i][0];
        r->xy[2 * (at + i) + 1] = y + half * side[hole ? 3 - i : i][1];
    }
}

TEST(a_hole_belongs_to_the_innermost_ring_around_it)
{
    struct rings r = {0};
    add_square(&r, 0, 0, 10, false);
    add_square(&r, 0, 0, 9, true);
    add_square(&r, 0, 0, 5, false); /* an island in the hole */
    add_square(&r, 1, 1, 2, true);
    add_square(&r, 20, 0, 4, false);
    add_square(&r, 20, 0, 1, true);
    add_square(&r, 22, 2, 1, true);
    CHECK(rings_place(&r));
    CHECK(r.ring[1].outer == 0 && r.ring[3].outer == 2);
    CHECK(r.ring[5].outer == 4 && r.ring[6].outer == 4);
    CHECK(r.ring[0].next == 1 && r.ring[1].next == r.n);
    CHECK(r.ring[4].next == 5 && r.ring[5].next == 6 && r.ring[6].next == r.n);
    rings_free(&r);
}

TEST(holes_of_many_rings_are_each_in_their_own)
{
    struct rings r = {0};
    for (int i = 0; i < 40; i++)
        for (int k = 0; k < 40; k++)
            add_square(&r, i, k, 0.4, false);
    for (int i = 0; i < 1600; i++)
        add_square(&r, (i * 7 % 1600) / 40 + 0.1, (i * 7 % 1600) % 40 - 0.2, 0.1, true);
    CHECK(rings_place(&r));
    for (size_t i = 1600; i < r.n; i++)
        CHECK(r.ring[i].outer == (i - 1600) * 7 % 1600);
    rings_free(&r);
}

TEST(holes_follow_their_outer_ring_and_polygons_are_written_with_the_first_corner_at_the_end)
{
    char *text = NULL;
    size_t n;
    struct rings r = {0};
    struct shapes s = {.kind = SHAPE_RING};
    add_square(&r, 0, 0, 2, false);
    add_square(&r, 9, 0, 2, false);
    add_square(&r, 0, 0, 1, true);
    CHECK(rings_place(&r) && rings_to_shapes(&r, 2.5, &s) && shapes_count(&s) == 2);
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
    rings_free(&r);
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
    struct rings r = {0};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!rings_take(&r, bad[i], strlen(bad[i])) && r.fault != NULL, "%s", bad[i]);
    CHECK(r.n == 0);
    rings_free(&r);
}

TEST(a_hole_in_no_ring_is_a_fault)
{
    struct rings r = {0};
    add_square(&r, 0, 0, 2, false);
    add_square(&r, 9, 0, 1, true);
    CHECK(!rings_place(&r) && strstr(r.fault, "in none of its parts") != NULL);
    rings_free(&r);
}
