/* grid_test.c - the uniform grid: every point in one cell, few cells, right neighbours. */
#include "core/shelling/grid.h"

#include <math.h>
#include <stdlib.h>

#include "core/exact/predicates.h"
#include "tests/oracle/definition.h"
#include "tests/oracle/families.h"
#include "tests/test.h"

enum { MOST = 3000 };

static struct dt_point in[MOST], xy[MOST];
static uint32_t from[MOST];

static struct dt_grid build(const char *family, uint32_t n, uint64_t seed)
{
    struct dt_grid g = {.n = 0};
    family_points(family_find(family), in, n, seed);
    n = keep_distinct(in, n);
    CHECK(dt_grid_build(&g, in, n, xy, from) == DT_OK);
    CHECK(g.n == n);
    return g;
}

/* Places first..end are in the cells of c, each point in its own cell, and nothing is crowded but
 * has cells of its own. Returns how many cells there are. */
static size_t check_cells(const struct dt_cells *c, uint32_t first, uint32_t end, int depth)
{
    uint32_t cells = c->lines * c->length, sub = 0;
    size_t all = cells;
    CHECK(depth < 230 && c->start[0] == first && c->start[cells] == end);
    CHECK(cells <= 3 * (end - first) + 1);
    for (uint32_t i = 0; i < cells; i++) {
        CHECK(c->start[i] <= c->start[i + 1]);
        for (uint32_t k = c->start[i]; k < c->start[i + 1]; k++)
            CHECK(dt_cells_index(c, xy[k]) == i);
        CHECK(dt_cells_first_sub(c, i) == sub);
        if (c->start[i + 1] - c->start[i] > 32) {
            CHECK(sub < c->subs && c->sub_cell[sub] == i);
            all += check_cells(&c->sub[sub++], c->start[i], c->start[i + 1], depth + 1);
        }
    }
    CHECK(sub == c->subs);
    return all;
}

TEST(grid_puts_each_point_of_every_family_into_its_cell_and_has_few_cells)
{
    for (const struct family *f = families; f->name != NULL; f++)
        for (uint32_t n = 1; n <= MOST; n = n * 3 + 1) {
            struct dt_grid g = build(f->name, n, test_random());
            size_t cells = check_cells(&g.top, 0, g.n, 0);
            CHECK_MSG(cells <= 24 * (size_t)g.n + 1, "%s: %zu cells for %u points", f->name, cells,
                      g.n);
            bool *seen = calloc(g.n, 1);
            for (uint32_t k = 0; k < g.n; k++) {
                CHECK(!seen[from[k]] && dt_compare_xy(in[from[k]], xy[k]) == 0);
                seen[from[k]] = true;
            }
            free(seen);
            dt_grid_clear(&g);
        }
}

TEST(evenly_spread_points_need_no_cells_inside_of_cells)
{
    struct dt_grid g = build("uniform", MOST, test_random());
    CHECK(g.top.subs == 0);
    CHECK(fabs(g.top.lines * (double)g.top.length - MOST * 9 / 16.0) < 100);
    dt_grid_clear(&g);
}

TEST(lines_run_along_the_longer_side_of_the_box)
{
    struct dt_grid g = build("tall", 500, 1);
    CHECK(g.top.upright && g.top.lines < g.top.length);
    dt_grid_clear(&g);
    g = build("wide", 500, 1);
    CHECK(!g.top.upright && g.top.lines < g.top.length);
    dt_grid_clear(&g);
}

TEST(nearest_point_is_the_nearest_of_all)
{
    for (const struct family *f = families; f->name != NULL; f++) {
        struct dt_grid g = build(f->name, 200, test_random());
        for (uint32_t k = 0; k < g.n; k++) {
            uint32_t near = dt_grid_nearest(&g, k);
            CHECK((near == DT_NONE) == (g.n == 1));
            for (uint32_t i = 0; i < g.n; i++)
                CHECK(i == k || dt_compare_distance(xy[k], xy[i], xy[near]) >= 0);
        }
        dt_grid_clear(&g);
    }
}

TEST(nearest_point_passes_over_removed_ones)
{
    struct dt_grid g = build("uniform", 300, test_random());
    for (uint32_t k = 1; k < g.n; k++) {
        uint32_t near = dt_grid_nearest(&g, 0);
        CHECK(near != 0 && !dt_grid_removed(&g, near));
        dt_grid_remove(&g, near);
        CHECK(dt_grid_removed(&g, near));
    }
    CHECK(dt_grid_nearest(&g, 0) == DT_NONE);
    dt_grid_clear(&g);
}

TEST(the_start_point_is_in_the_middle)
{
    struct dt_grid g = build("uniform", MOST, test_random());
    struct dt_point p = xy[dt_grid_middle(&g)];
    CHECK(fabs(p.x - 0.5) < 0.1 && fabs(p.y - 0.5) < 0.1);
    dt_grid_clear(&g);
    for (const struct family *f = families; f->name != NULL; f++) {
        g = build(f->name, 50, test_random());
        CHECK(dt_grid_middle(&g) < g.n);
        dt_grid_clear(&g);
    }
}

TEST(grid_fails_cleanly_when_memory_runs_out)
{
    family_points(family_find("nested"), in, MOST, 3);
    uint32_t n = keep_distinct(in, MOST);
    for (long nth = 1;; nth++) {
        struct dt_grid g = {.n = 0};
        test_fail_alloc(nth);
        enum dt_status status = dt_grid_build(&g, in, n, xy, from);
        bool failed = test_alloc_failed();
        test_fail_alloc(0);
        CHECK(status == (failed ? DT_NOMEM : DT_OK));
        CHECK(!failed || (g.top.start == NULL && g.top.subs == 0));
        dt_grid_clear(&g);
        if (!failed)
            break;
    }
}
