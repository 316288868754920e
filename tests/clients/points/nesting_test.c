/* nesting_test.c - rings within rings are holes, each in the innermost ring around it; compared with all pairs of rings. */
#include "clients/points/nesting.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

enum { MOST = 4200 };

static struct paths p;
static double xy[8 * MOST];

/* Appends a square with this centre; the number tells where it was. */
static void add_square(double x, double y, double half, bool hole)
{
    static const double side[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    CHECK(p.n < MOST && paths_begin(&p, true, (uint32_t)p.n, 0, 0));
    for (size_t i = 0; i < 4; i++) {
        xy[2 * p.corners] = x + half * side[i][0];
        xy[2 * p.corners + 1] = y + half * side[i][1];
        CHECK(paths_corner(&p, p.corners));
    }
    p.path[p.n - 1].n = 4;
    p.path[p.n - 1].closed = true;
    p.path[p.n - 1].hole = hole;
}

/* Compares the numbers of the paths, holes with a minus sign. */
static void expect(const char *want)
{
    char got[400] = "";
    for (size_t i = 0, n = 0; i < p.n; i++)
        n += (size_t)snprintf(got + n, sizeof got - n, "%s%s%u", i > 0 ? " " : "",
                              p.path[i].hole ? "-" : "", (unsigned)p.path[i].number);
    CHECK_STR(got, want);
    paths_free(&p);
}

static void add_islands(bool known)
{
    add_square(0, 0, 10, false);
    add_square(20, 0, 4, false);
    add_square(0, 0, 9, known);
    add_square(0, 0, 5, false); /* an island in the hole */
    add_square(22, 2, 1, known);
    add_square(1, 1, 2, known);
    add_square(20, -1, 1, known);
}

TEST(a_hole_belongs_to_the_innermost_ring_around_it)
{
    for (int known = 0; known < 2; known++) {
        add_islands(known == 1);
        CHECK(paths_nest(&p, 0, known == 1, xy) == NESTING_DONE);
        expect("0 -2 1 -4 -6 3 -5");
    }
}

TEST(paths_before_and_paths_that_are_open_are_no_rings)
{
    add_square(0, 0, 20, false);
    add_square(0, 0, 10, false);
    add_square(0, 0, 5, false);
    p.path[2].closed = false;
    add_square(1, 1, 2, false);
    CHECK(paths_nest(&p, 1, false, xy) == NESTING_DONE);
    expect("0 1 -3 2");
}

TEST(a_known_hole_in_no_ring_is_found_and_changes_nothing)
{
    add_square(9, 0, 1, true);
    add_square(0, 0, 2, false);
    CHECK(paths_nest(&p, 0, true, xy) == NESTING_LONE);
    expect("-0 1");
    CHECK(paths_nest(&p, 0, false, xy) == NESTING_DONE);
    expect("");
}

/* Squares of a tree: each is in the quarter of another one, at random. */
static void add_tree(double x, double y, double half, int depth)
{
    add_square(x, y, half, false);
    for (int k = 0; k < 4 && depth > 0; k++)
        if (test_random() % 3 != 0)
            add_tree(x + (k % 2 ? half : -half) / 2, y + (k / 2 ? half : -half) / 2, 0.45 * half,
                     depth - 1);
}

static bool is_within(size_t a, size_t b)
{
    const double *inner = xy + 8 * a, *outer = xy + 8 * b;
    return a != b && inner[0] > outer[0] && inner[1] > outer[1] && inner[4] < outer[4] &&
           inner[5] < outer[5];
}

TEST(rings_of_random_trees_are_nested_as_all_pairs_say)
{
    for (int round = 0; round < 20; round++) {
        for (int i = 0; i < 3; i++)
            add_tree(3 * i, 0, 1, 5);
        const size_t n = p.n;
        CHECK(paths_nest(&p, 0, false, xy) == NESTING_DONE && p.n == n);
        size_t outer = 0;
        for (size_t i = 0; i < n; i++) {
            const size_t ring = p.path[i].number;
            size_t around = 0, least = ring;
            for (size_t k = 0; k < n; k++)
                if (is_within(ring, k)) {
                    around++;
                    least = least == ring || is_within(k, least) ? k : least;
                }
            CHECK(p.path[i].hole == (around % 2 == 1));
            outer = p.path[i].hole ? outer : ring;
            CHECK(!p.path[i].hole || outer == least);
        }
        paths_free(&p);
    }
}
