/* box_test.c - boxes, and the cells of a grid. */
#include "core/exact/box.h"

#include <math.h>

#include "tests/test.h"

/* Few values, so that borders and corners meet. */
static struct dt_point few(void)
{
    return (struct dt_point){test_below(7), test_below(7)};
}

TEST(the_box_of_points_contains_them_and_touches_them_on_all_sides)
{
    for (int i = 0; i < 2000; i++) {
        struct dt_point p[6];
        uint32_t n = 1 + test_below(6);
        for (uint32_t k = 0; k < n; k++)
            p[k] = few();
        struct dt_box b = dt_box_of(p, n);
        int sides = 0;
        for (uint32_t k = 0; k < n; k++) {
            CHECK(dt_box_contains(&b, p[k]));
            sides |= (p[k].x == b.lo.x) | (p[k].x == b.hi.x) << 1 | (p[k].y == b.lo.y) << 2 |
                     (p[k].y == b.hi.y) << 3;
        }
        CHECK(sides == 15);
        uint32_t half = n / 2;
        struct dt_box joined =
            half == 0 ? b : dt_box_join(dt_box_of(p, half), dt_box_of(p + half, n - half));
        CHECK(joined.lo.x == b.lo.x && joined.hi.x == b.hi.x && joined.lo.y == b.lo.y &&
              joined.hi.y == b.hi.y);
    }
}

TEST(boxes_overlap_where_they_share_a_point)
{
    for (int i = 0; i < 5000; i++) {
        struct dt_box a = dt_box_of((struct dt_point[]){few(), few()}, 2),
                      b = dt_box_of((struct dt_point[]){few(), few()}, 2);
        bool share = false;
        for (int k = 0; k < 49; k++) {
            struct dt_point p = {k % 7, k / 7};
            share |= dt_box_contains(&a, p) && dt_box_contains(&b, p);
        }
        CHECK(dt_box_overlaps(&a, &b) == share && dt_box_overlaps(&b, &a) == share);
        CHECK(dt_box_side(&a) == fmax(a.hi.x - a.lo.x, a.hi.y - a.lo.y));
        CHECK((dt_box_axis(&a) == 0 ? dt_box_width(&a) : dt_box_height(&a)) == dt_box_side(&a));
    }
}

TEST(cells_ascend_and_the_outermost_contain_places_beyond_the_box)
{
    static const double order[] = {-HUGE_VAL, -0x1p300,    -1,     -0x1p-1074,  -0.0,
                                   0,         0x1p-1074,   0.5,    1 - 0x1p-53, 1,
                                   1.5,       2 - 0x1p-52, 2,      2.75,        3,
                                   3.5,       0x1p31,      0x1p32, 0x1p300,     HUGE_VAL};
    static const uint32_t of_three[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        CHECK(dt_cell(order[i], 3) == of_three[i]);
        CHECK(dt_cell(order[i], 1) == 0);
        CHECK(i == 0 || dt_cell(order[i - 1], UINT32_MAX) <= dt_cell(order[i], UINT32_MAX));
    }
    CHECK(dt_cell((double)NAN, 3) == 0);
}
