/* svg_test.c - drawings are well-formed and lie within their frame for all kinds of points. */
#include "clients/pictures/svg.h"

#include <math.h>
#include <string.h>

#include "tests/test.h"

static void find_box(const double *xy, size_t n, double box[4])
{
    memcpy(box, (const double[]){xy[0], xy[1], xy[0], xy[1]}, 4 * sizeof *box);
    for (size_t i = 1; i < n; i++) {
        box[0] = fmin(box[0], xy[2 * i]);
        box[1] = fmin(box[1], xy[2 * i + 1]);
        box[2] = fmax(box[2], xy[2 * i]);
        box[3] = fmax(box[3], xy[2 * i + 1]);
    }
}

/* Draws the points, the triangles a b c of tri[3 * triangles], and all points as hull; returns the text of
 * the file. */
static char *drawing(const double *xy, size_t n, const uint32_t *tri, size_t triangles)
{
    char *text;
    size_t size;
    uint32_t id[1000];
    struct svg s;
    double box[4];
    FILE *out = open_memstream(&text, &size);
    find_box(xy, n, box);
    for (uint32_t i = 0; i < n; i++)
        id[i] = i;
    svg_begin(&s, out, "title", box, n, false, NULL, "");
    for (size_t i = 0; i < triangles; i++)
        svg_triangle(&s, "t", false, xy, tri + 3 * i);
    svg_hull(&s, xy, id, n);
    svg_points(&s, xy, id, n);
    svg_end(&s);
    CHECK(s.triangles == triangles && !ferror(out));
    fclose(out);
    return text;
}

static unsigned count(const char *text, const char *what)
{
    unsigned n = 0;
    for (; (text = strstr(text, what)) != NULL; text++)
        n++;
    return n;
}

/* The number of closed lines. */
static unsigned closed(const char *text)
{
    return count(text, "zM") + count(text, "z\"");
}

/* Every element closed, every attribute quoted, every M within the frame. */
static void check_sound(const char *text)
{
    double width, height, x, y;
    CHECK(sscanf(strstr(text, "viewBox"), "viewBox=\"0 0 %lf %lf\"", &width, &height) == 2);
    CHECK(width > 0 && height > 0);
    CHECK(count(text, "<path") ==
          count(text, "\"/>\n") - 1); /* the remaining element is the background */
    CHECK(count(text, "\"") % 2 == 0);
    CHECK(count(text, "nan") == 0 && count(text, "inf") == 0);
    CHECK(strcmp(text + strlen(text) - 7, "</svg>\n") == 0);
    for (const char *m = text; (m = strchr(m, 'M')) != NULL; m++) {
        CHECK(sscanf(m, "M%lf %lf", &x, &y) == 2);
        CHECK(x >= 0 && x <= width && y >= 0 && y <= height);
    }
}

TEST(svg_draws_triangles_hull_points_and_ids)
{
    static const double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, 2, 2};
    static const uint32_t tri[] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 0, 4, 3};
    char *text = drawing(xy, 5, tri, 4);
    check_sound(text);
    CHECK(closed(text) == 5); /* four triangles and the hull */
    CHECK(count(text, "h0") == 5);
    CHECK(count(text, "<text") == 6 && strstr(text, ">4</text>") != NULL);
    /* y points up: the point 0 4 is in the upper left corner of the frame, 0 0 in the lower left
     * one */
    CHECK(strstr(text, "M400 400h0") != NULL && strstr(text, "M400 16400h0") != NULL);
    free(text);
}

TEST(svg_draws_points_on_a_line_as_an_open_hull)
{
    static const double xy[] = {0, 0, 1, 0, 2, 0};
    char *text = drawing(xy, 3, NULL, 0);
    check_sound(text);
    CHECK(count(text, "class=\"h\"") == 1 && closed(text) == 0);
    free(text);
}

TEST(svg_draws_a_single_place)
{
    static const double xy[] = {7, -3, 7, -3};
    for (size_t n = 1; n <= 2; n++) {
        char *text = drawing(xy, n, NULL, 0);
        check_sound(text);
        free(text);
    }
}

TEST(svg_draws_coordinates_of_extreme_magnitude)
{
    static const double huge[] = {-0x1p201, -0x1p201, 0x1p201, -0x1p201, 0, 0x1p201};
    static const double tiny[] = {0, 0, 0x1p-142, 0, 0, 0x1p-142};
    static const uint32_t tri[] = {0, 1, 2};
    const double *set[] = {huge, tiny};
    for (int i = 0; i < 2; i++) {
        char *text = drawing(set[i], 3, tri, 1);
        check_sound(text);
        free(text);
    }
}

TEST(svg_shares_paths_between_many_triangles)
{
    static double xy[2 * 1000];
    static uint32_t tri[3 * 998];
    for (uint32_t i = 0; i < 1000; i++) {
        xy[2 * i] = i / 2;
        xy[2 * i + 1] = i % 2;
        if (i < 998)
            tri[3 * i] = i, tri[3 * i + 1] = i + 1, tri[3 * i + 2] = i + 2;
    }
    char *text = drawing(xy, 1000, tri, 998);
    check_sound(text);
    CHECK(count(text, "class=\"t\"") == 2 && closed(text) == 999);
    CHECK(count(text, "<text") == 1); /* the scale's */
    free(text);
}

TEST(svg_has_a_scale_of_a_round_length)
{
    static const struct {
        double side;
        const char *label;
    } cases[] = {{4, ">1</text>"},        {10, ">2</text>"},      {16, ">5</text>"},
                 {1e-9, ">2e-10</text>"}, {3000, ">1000</text>"}, {0x1p201, ">1e+60</text>"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double a = cases[i].side;
        double xy[] = {0, 0, a, 0, a, a, 0, a};
        char *text = drawing(xy, 4, NULL, 0);
        CHECK_MSG(strstr(text, cases[i].label) != NULL, "%g: %s", a, text);
        free(text);
    }
}

/* Every text lies within the frame, if a letter is no wider than 0.58 of its height. */
static void check_texts(const char *text)
{
    double width, height, size = 0, x, y;
    CHECK(sscanf(strstr(text, "viewBox"), "viewBox=\"0 0 %lf %lf\"", &width, &height) == 2);
    for (const char *p = text; (p = strchr(p, '<')) != NULL; p++) {
        sscanf(p, "<g font-size=\"%lf\"", &size);
        if (strncmp(p, "<text", 5) != 0)
            continue;
        sscanf(p, "<text font-size=\"%lf\"", &size);
        CHECK(sscanf(strstr(p, " x="), " x=\"%lf\" y=\"%lf\"", &x, &y) == 2);
        const char *words = strchr(p, '>') + 1;
        double end = x + 0.58 * size * (double)strcspn(words, "<");
        CHECK_MSG(x >= 0 && end <= width + 1 && y >= 0.7 * size && y <= height, "%.60s", p);
    }
}

TEST(svg_keeps_labels_scale_and_legend_within_the_frame)
{
    static const struct svg_legend legend = {.low = "flat", .high = "equilateral"};
    static const double shapes[][8] = {{0, 0, 1, 0, 1, 1, 0, 1},
                                       {0, 0, 0, 0, 0, 9, 0, 9},
                                       {0, 0, 9, 0, 9, 0, 0, 0},
                                       {5, 5, 5, 5, 5, 5, 5, 5},
                                       {0, 0, 1, 0, 1, 30, 0, 30}};
    uint32_t id[4] = {4294967295u, 1000000000, 123456, 7};
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        char *text;
        size_t size;
        struct svg s;
        const double *xy = shapes[i];
        double box[4] = {xy[0], xy[1], xy[4], xy[5]};
        FILE *out = open_memstream(&text, &size);
        svg_begin(&s, out, "title", box, 4, false, &legend, "");
        svg_points(&s, xy, id, 4);
        svg_end(&s);
        fclose(out);
        check_texts(text);
        CHECK(strstr(text, ">flat</text>") != NULL && count(text, "class=\"q") == SVG_SHADES);
        free(text);
    }
}

TEST(svg_draws_what_meets_the_box_and_cuts_it_off)
{
    static const double box[4] = {0, 0, 1, 1};
    static const double around[] = {-1e9, -1e9, 1e9, -1e9, 0, 1e9}, beside[] = {2, 0, 3, 0, 2, 1},
                        across[] = {-5, 0.4, 6, 0.5, -5, 0.6};
    static const double *const triangles[] = {around, beside, across};
    for (size_t i = 0; i < 3; i++) {
        char *text;
        size_t size;
        struct svg s;
        const double *xy = triangles[i];
        FILE *out = open_memstream(&text, &size);
        svg_begin(&s, out, "title", box, 1, true, NULL, "");
        svg_triangle(&s, "t", false, xy, (const uint32_t[]){0, 1, 2});
        svg_hull(&s, xy, (const uint32_t[]){0, 1, 2}, 3);
        svg_points(&s, xy, NULL, 0);
        svg_end(&s);
        fclose(out);
        CHECK(s.triangles == (i == 1 ? 0 : 1) && strstr(text, "clip-path=\"url(#box)\"") != NULL);
        CHECK(count(text, "class=\"h\"") == (i == 2 ? 1 : 0));
        for (const char *m = text; (m = strchr(m, 'M')) != NULL; m++) {
            double x, y; /* nothing is far outside, even for a huge triangle */
            CHECK(sscanf(m, "M%lf %lf", &x, &y) == 2 && x >= -1700 && x <= 18500 && y >= -1700);
        }
        free(text);
    }
}
