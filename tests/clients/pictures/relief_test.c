/* relief_test.c - colours of slopes and heights. */
#include "clients/pictures/relief.h"

#include <math.h>

#include "tests/test.h"

static unsigned light(uint32_t rgb)
{
    return (rgb >> 16) + (rgb >> 8 & 255) + (rgb & 255);
}

TEST(slopes_towards_the_light_are_brighter_than_those_away_from_it)
{
    struct relief r = {.style = RELIEF_LIGHT, .low = 0, .high = 1, .steepness = 1};
    unsigned level = light(relief_colour(&r, 0.5, 0, 0));
    CHECK(light(relief_colour(&r, 0.5, 0.3, 0)) > level);    /* falls to the west */
    CHECK(light(relief_colour(&r, 0.5, 0, -0.3)) > level);   /* to the north */
    CHECK(light(relief_colour(&r, 0.5, -0.3, 0)) < level);   /* to the east */
    CHECK(light(relief_colour(&r, 0.5, 0, 0.3)) < level);    /* to the south */
    CHECK(light(relief_colour(&r, 0.5, -1e300, 1e300)) > 0); /* never black */
    uint32_t grey = relief_colour(&r, 0.5, 0.2, 0.1);
    CHECK((grey >> 16) == (grey & 255) && (grey >> 8 & 255) == (grey & 255));
}

TEST(colours_by_height_do_not_depend_on_units)
{
    struct relief a = {.style = RELIEF_HEIGHT, .low = 0, .high = 1000},
                  b = {.style = RELIEF_HEIGHT, .low = -5e-3, .high = 5e-3};
    for (int i = 0; i <= 20; i++)
        CHECK(relief_colour(&a, 50 * i, 1, 1) == relief_colour(&b, (i - 10) * 5e-4, 0, 0));
    CHECK(relief_colour(&a, -1, 0, 0) == relief_colour(&a, 0, 0, 0));
    CHECK(relief_colour(&a, 2000, 0, 0) == relief_colour(&a, 1000, 0, 0));
    CHECK(relief_colour(&a, 0, 0, 0) != relief_colour(&a, 1000, 0, 0));
    a.high = 0; /* level ground */
    CHECK(relief_colour(&a, 0, 0, 0) == relief_colour(&b, 0, 0, 0));
}

TEST(relief_is_transparent_where_values_are_missing)
{
    double nan = (double)NAN, z[6] = {1, nan, 3, nan, nan, 2};
    struct grid g = {.cell = 1, .columns = 3, .rows = 2, .value = z};
    struct relief r = {.style = RELIEF_BOTH};
    unsigned char rgba[24];
    CHECK(relief_fit(&r, &g) && r.low == 1 && r.high == 3);
    relief_paint(&r, &g, rgba);
    for (int i = 0; i < 6; i++)
        CHECK(rgba[4 * i + 3] == (isnan(z[i]) ? 0 : 255));
    for (int i = 0; i < 6; i++)
        z[i] = nan;
    CHECK(!relief_fit(&r, &g));
}

TEST(slope_of_a_plane_is_the_same_at_every_cell)
{
    double z[20], dx, dy;
    struct grid g = {.cell = 0.5, .columns = 5, .rows = 4, .value = z};
    struct relief r = {.style = RELIEF_BOTH};
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 5; i++)
            z[5 * j + i] = 3 * 0.5 * i - 4 * 0.5 * j; /* rows go south */
    for (uint32_t j = 0; j < 4; j++)
        for (uint32_t i = 0; i < 5; i++) {
            relief_slope(&g, i, j, &dx, &dy);
            CHECK(dx == 3 && dy == 4);
        }
    CHECK(relief_fit(&r, &g) && r.steepness == 0.1);
}
