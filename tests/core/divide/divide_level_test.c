/* divide_level_test.c - one grid over a range of points: when it helps, and when a cut at the median comes instead. */
#include "core/divide/divide_level.h"

#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

enum { N = 3000 };

/* Opens a level of N points, of which `apart` are far from the rest, behind `skew` useless grids. Sets *now to the useless
 * grids in a row with this one. */
static enum dt_opening open_level(uint32_t apart, unsigned skew, unsigned *now)
{
    static const struct dt_options none;
    static struct dt_point in[N], p[N], spare[N];
    static uint32_t from[N], spare_from[N];
    static uint16_t step[N];
    struct dt_pages *pages = dt_pages_new(SIZE_MAX);
    struct dt_arena arena = {.pages = pages};
    struct dt_level level = {.skew = 99};
    struct dt_division d = {.p = p,
                            .from = from,
                            .n = N,
                            .plan = {.step = step},
                            .spare = {spare, spare_from},
                            .pages = pages,
                            .opt = &none,
                            .stop = dt_stop_of(NULL)};
    for (uint32_t i = 0; i < N; i++) {
        double size = i < apart ? 1 : 0x1p-30;
        in[i] = (struct dt_point){size * test_uniform(), size * test_uniform()};
    }
    enum dt_opening opening =
        dt_level_open(&d, &arena, 1, (struct dt_source){in, NULL}, 0, N, skew, &level);
    *now = level.skew;
    dt_arena_clear(&arena);
    dt_pages_free(pages);
    return opening;
}

TEST(grid_of_which_one_cell_holds_most_is_tried_a_few_times_before_a_cut_at_the_median)
{
    unsigned now;
    for (unsigned skew = 0; skew < DT_ZOOMS; skew++)
        CHECK(open_level(10, skew, &now) == DT_LEVEL_OPEN && now == skew + 1);
    CHECK(open_level(10, DT_ZOOMS, &now) == DT_LEVEL_SKEWED);
}

TEST(grid_that_separates_half_of_the_points_is_no_useless_one)
{
    unsigned now;
    CHECK(open_level(N, DT_ZOOMS, &now) == DT_LEVEL_OPEN && now == 0);
    CHECK(open_level(N / 2 + 100, DT_ZOOMS, &now) == DT_LEVEL_OPEN && now == 0);
    CHECK(open_level(N / 2 - 100, DT_ZOOMS, &now) == DT_LEVEL_SKEWED);
}
