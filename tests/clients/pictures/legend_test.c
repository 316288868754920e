/* legend_test.c - legends have round numbers at the right places, and the colours of the picture. */
#include "clients/pictures/legend.h"

#include <math.h>
#include <string.h>

#include "tests/test.h"

TEST(round_steps_are_exact_decimals)
{
    static const struct {
        double rough, step;
        const char *third;
    } cases[] = {{0.09, 0.1, "0.3"},     {1.4, 1, "3"},    {2, 2, "6"},
                 {40, 50, "150"},        {80, 100, "300"}, {3e-7, 2e-7, "6e-7"},
                 {1e200, 1e200, "3e200"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct round_step step = round_step_of(cases[i].rough);
        CHECK_MSG(round_step_times(step, 1) == cases[i].step, "%g", cases[i].rough);
        CHECK(round_step_times(step, 3) == atof(cases[i].third));
        CHECK(round_step_times(step, -3) == -atof(cases[i].third));
    }
}

/* Ticks are ascending, round, and where their heights are. */
TEST(a_legend_of_heights_has_a_few_round_numbers)
{
    static const double range[][2] = {{0, 1},       {-3.2, 17},      {212.5, 1060.25},
                                      {1e-9, 5e-9}, {-1e300, 1e299}, {999999, 1000001}};
    for (size_t i = 0; i < sizeof range / sizeof range[0]; i++) {
        struct relief r = {.style = RELIEF_BOTH, .low = range[i][0], .high = range[i][1]};
        struct legend l;
        CHECK(legend_of_heights(&l, &r, "z") && legend_shown(&l) == &l.svg);
        CHECK_MSG(l.svg.ticks >= 3 && l.svg.ticks <= 9, "%zu: %zu ticks", i, l.svg.ticks);
        for (size_t k = 0; k < l.svg.ticks; k++) {
            double v = atof(l.svg.tick[k].text), at = (v - r.low) / (r.high - r.low);
            CHECK(fabs(l.svg.tick[k].at - at) < 1e-9 && at >= 0 && at <= 1);
            CHECK(k == 0 || l.svg.tick[k].at > l.svg.tick[k - 1].at);
            CHECK_MSG(strspn(l.svg.tick[k].text, "-.0123456789e+") == strlen(l.svg.tick[k].text) &&
                          strlen(l.svg.tick[k].text) <= 9,
                      "%s", l.svg.tick[k].text);
        }
        CHECK(l.svg.colour[0] != l.svg.colour[l.svg.colours - 1] && strcmp(l.svg.low, "z") == 0);
        legend_free(&l);
    }
}

TEST(heights_that_do_not_differ_have_no_legend)
{
    static const double range[][2] = {
        {7, 7}, {HUGE_VAL, -HUGE_VAL}, {-1e308, 1e308}, {0, 5e-324}, {1e17, 1e17 + 64}};
    for (size_t i = 0; i < sizeof range / sizeof range[0]; i++) {
        struct relief r = {.low = range[i][0], .high = range[i][1]};
        struct legend l;
        CHECK(legend_of_heights(&l, &r, "z") && legend_shown(&l) == NULL);
        legend_free(&l);
    }
}

TEST(a_legend_of_bands_has_their_levels_and_colours)
{
    struct shape shape[] = {{.key = -HUGE_VAL, .high = 2},
                            {.key = 2, .high = 4},
                            {.key = 2, .high = 4},
                            {.key = 4, .high = 8}};
    struct shapes bands = {.kind = SHAPE_BAND, .shape = shape, .n = 4};
    struct relief r = {.style = RELIEF_HEIGHT, .low = 2, .high = 6};
    struct legend l;
    CHECK(legend_of_bands(&l, &r, &bands) && l.svg.colours == 3 && l.svg.ticks == 3);
    CHECK(strcmp(l.svg.tick[0].text, "2") == 0 && l.svg.tick[0].at == 1 / 3.);
    CHECK(strcmp(l.svg.tick[2].text, "8") == 0 && l.svg.tick[2].at == 1);
    CHECK(l.svg.colour[1] == relief_colour(&r, 3, 0, 0) &&
          l.svg.colour[2] == relief_colour(&r, 6, 0, 0));
    legend_free(&l);
    bands.n = 0;
    CHECK(legend_of_bands(&l, &r, &bands) && legend_shown(&l) == NULL);
    legend_free(&l);
}

TEST(triangles_have_the_step_of_their_least_angle)
{
    const double a[] = {0, 0}, b[] = {1, 0};
    for (int degrees = 1; degrees < 60; degrees++) {
        double half = degrees * M_PI / 360, tip[] = {0.5, 0.5 / tan(half)};
        unsigned want = degrees % 5 == 0 ? LEGEND_ANGLES : (unsigned)degrees / 5;
        if (want < LEGEND_ANGLES) /* at the end of a step doubles may say either */
            CHECK(legend_angle(a, b, tip) == want && legend_angle(tip, a, b) == want &&
                  legend_angle(b, tip, a) == want);
    }
    CHECK(legend_angle(a, b, b) == 0 && legend_angle(a, a, a) == 0);
    struct legend l;
    CHECK(legend_of_angles(&l) && l.svg.colours == LEGEND_ANGLES && l.svg.ticks == 7);
    CHECK(strcmp(l.svg.tick[6].text, "60\u00b0") == 0 && l.svg.tick[6].at == 1);
    legend_free(&l);
}

/* Relative luminance, about: the thinner the triangle the darker, up to the lightest step. */
TEST(colours_of_angles_grow_lighter_and_are_distinct)
{
    double before = -1;
    for (unsigned i = 0; i < LEGEND_ANGLES; i++) {
        uint32_t c = legend_angle_colour(i);
        double light = 0.21 * (c >> 16) + 0.72 * (c >> 8 & 255) + 0.07 * (c & 255);
        CHECK(i > 6 || light > before + 5);
        CHECK(i == 0 || c != legend_angle_colour(i - 1));
        before = light;
    }
}
