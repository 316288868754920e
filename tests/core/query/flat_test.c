/* flat_test.c - the triangles as flat arrays. */
#include <stdlib.h>

#include "core/delaunay_arrays.h"
#include "tests/core/sets.h"
#include "tests/test.h"

static uint32_t next_of(uint32_t e)
{
    return e % 3 == 2 ? e - 2 : e + 1;
}

/* Room for all triangles and nothing after it, so that a sanitizer sees writes behind it. */
static uint32_t *room_for(uint32_t triangles)
{
    return malloc(triangles == 0 ? 1 : triangles * 3 * sizeof(uint32_t));
}

static void flat_has_the_rows_of_the_table(const struct pair *pair)
{
    for (int cw = 0; cw < 2; cw++) {
        struct dt_cursor c;
        size_t rows, words;
        CHECK(dt_table_begin(pair->t, NULL, DT_TRIANGLES, cw, &c) == DT_OK);
        uint32_t *want = room_for(c.rows), *got = room_for(c.rows);
        CHECK(dt_table_read(pair->t, &c, want, (size_t)c.rows * 3, c.rows, &rows, &words) == DT_OK);
        CHECK(dt_flat(pair->t, cw, got, NULL) == DT_OK);
        struct dt_ids expected = {want, words, words}, found = {got, words, words};
        check_equal_ids("triangles", &found, &expected);
        free(want);
        free(got);
    }
}

TEST(flat_triangles_are_those_of_the_table_in_its_order)
{
    for_each_pair(flat_has_the_rows_of_the_table);
}

static void halfedges_run_back(const struct pair *pair)
{
    for (int cw = 0; cw < 2; cw++) {
        struct dt_summary sum;
        uint32_t outer = 0;
        dt_summary(pair->t, &sum);
        uint32_t n = sum.triangles, *tri = room_for(n), *half = room_for(n);
        CHECK(dt_flat(pair->t, cw, tri, half) == DT_OK);
        for (uint32_t e = 0; e < 3 * n; e++) {
            uint32_t twin = half[e];
            outer += twin == DT_NONE;
            CHECK(twin == DT_NONE ||
                  (twin < 3 * n && half[twin] == e && tri[twin] == tri[next_of(e)] &&
                   tri[next_of(twin)] == tri[e]));
        }
        CHECK(n == 0 || outer == sum.hull);
        free(tri);
        free(half);
    }
}

TEST(flat_halfedges_run_back_along_the_same_edge_or_are_on_the_hull)
{
    for_each_pair(halfedges_run_back);
}

TEST(flat_sorts_the_triangles_of_a_hub)
{
    enum { RIM = 100 };
    struct dt_point p[RIM + 1] = {{0, 0}};
    uint64_t seed = 7;
    for (int i = 1; i <= RIM; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        double u = (double)(seed >> 40) / (1 << 24); /* on the circle, in random order */
        double s = 4 * (u < 0.5 ? u : u - 1);
        double c = u < 0.5 ? 1 : -1;
        p[i] = (struct dt_point){c * (1 - s * s) / (1 + s * s), c * 2 * s / (1 + s * s)};
    }
    struct dt *t = set_of(p, RIM + 1);
    struct pair pair = {t, NULL};
    flat_has_the_rows_of_the_table(&pair);
    halfedges_run_back(&pair);
    dt_free(t);
}

TEST(flat_needs_a_triangulation)
{
    struct dt *t = dt_new(0);
    CHECK(dt_flat(t, false, NULL, NULL) == DT_UNTRIANGULATED);
    CHECK(dt_triangulate(t, NULL) == DT_OK);
    CHECK(dt_flat(t, false, NULL, NULL) == DT_OK); /* no triangles */
    dt_free(t);
}
