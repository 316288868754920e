/* apex_test.c - the third-point search against a linear scan. */
#include "core/shelling/apex.h"

#include "core/exact/predicates.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MOST = 400 };

static struct dt_point in[MOST], xy[MOST];
static uint32_t from[MOST];

static uint32_t slow_apex(const struct dt_grid *g, uint32_t a, uint32_t b)
{
    uint32_t best = DT_NONE;
    for (uint32_t c = 0; c < g->n; c++) {
        if (dt_grid_removed(g, c) || dt_orient2d(xy[a], xy[b], xy[c]) <= 0)
            continue;
        if (best == DT_NONE || dt_incircle_perturbed(xy[a], xy[b], xy[best], xy[c]) > 0)
            best = c;
    }
    return best;
}

/* Edges of all lengths, most of them not Delaunay: the search has to be right for any. */
static void check_edges(struct dt_grid *g, unsigned rounds, const char *name)
{
    for (unsigned i = 0; i < rounds; i++) {
        uint32_t a = test_below(g->n), b = test_below(2) ? test_below(g->n) : dt_grid_nearest(g, a);
        if (a == b || dt_grid_removed(g, a) || dt_grid_removed(g, b))
            continue;
        CHECK_MSG(dt_apex(g, a, b) == slow_apex(g, a, b), "%s, %u points, edge %u %u", name, g->n,
                  a, b);
    }
}

TEST(apex_is_the_best_of_all_points_left_of_the_edge)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 2; n <= MOST; n = n * 3 / 2 + 1) {
            struct dt_grid g = {.n = 0};
            family_points(f, in, n, test_random());
            uint32_t kept = keep_distinct(in, n);
            CHECK(dt_grid_build(&g, in, kept, xy, from) == DT_OK);
            if (kept > 1)
                check_edges(&g, 150, f->name);
            dt_grid_clear(&g);
        }
}

TEST(apex_is_never_a_removed_point)
{
    struct dt_grid g = {.n = 0};
    family_points(family_find("uniform"), in, MOST, test_random());
    CHECK(dt_grid_build(&g, in, MOST, xy, from) == DT_OK);
    for (unsigned i = 0; i < 350; i++) {
        dt_grid_remove(&g, test_below(MOST));
        uint32_t a = 0;
        while (dt_grid_removed(&g, a))
            a++;
        uint32_t b = dt_grid_nearest(&g, a);
        CHECK(dt_apex(&g, a, b) == slow_apex(&g, a, b));
        CHECK(dt_apex(&g, b, a) == slow_apex(&g, b, a));
    }
    dt_grid_clear(&g);
}

/* By the tie rule the greatest corner of a square is cut off, so it is no apex of its diagonal's
 * far side but of the diagonal that avoids it. */
TEST(apex_of_a_tie_follows_the_rule)
{
    struct dt_point square[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    struct dt_grid g = {.n = 0};
    CHECK(dt_grid_build(&g, square, 4, xy, from) == DT_OK);
    uint32_t place[4];
    for (uint32_t k = 0; k < 4; k++)
        place[from[k]] = k;
    CHECK(dt_apex(&g, place[0], place[1]) == place[3]);
    CHECK(dt_apex(&g, place[1], place[2]) == place[3]);
    CHECK(dt_apex(&g, place[3], place[1]) == place[2] ||
          dt_apex(&g, place[1], place[3]) == place[0]);
    CHECK(dt_apex(&g, place[1], place[0]) == DT_NONE);
    dt_grid_clear(&g);
}

TEST(points_on_the_line_of_the_edge_are_never_its_apex)
{
    struct dt_point line[5] = {{0, 0}, {1, 3}, {2, 6}, {3, 9}, {5, 15}};
    struct dt_grid g = {.n = 0};
    CHECK(dt_grid_build(&g, line, 5, xy, from) == DT_OK);
    for (uint32_t a = 0; a < 5; a++)
        for (uint32_t b = 0; b < 5; b++)
            CHECK(a == b || dt_apex(&g, a, b) == DT_NONE);
    dt_grid_clear(&g);
}
