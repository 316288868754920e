/* line_labels_test.c - numbers of contour lines are on the line, upright, within the frame, and not over each other. */
#include "clients/pictures/line_labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/test.h"

static bool all_lines(const void *ctx, const struct shape *line)
{
    (void)ctx;
    (void)line;
    return true;
}

static void add_line(struct shapes *s, double level, bool closed, const double *xy, size_t n)
{
    s->shape = realloc(s->shape, (s->n + 1) * sizeof *s->shape);
    s->xy = realloc(s->xy, 2 * (s->corners + n) * sizeof *s->xy);
    CHECK(s->shape != NULL && s->xy != NULL);
    memcpy(s->xy + 2 * s->corners, xy, 2 * n * sizeof *xy);
    s->shape[s->n++] = (struct shape){.key = level, .closed = closed, .first = s->corners, .n = n};
    s->corners += n;
}

/* A picture of the lines in a box of side 10 at 0, 0, with their numbers; frees the lines. */
static char *picture_of(struct shapes *lines)
{
    const double box[] = {0, 0, 10, 10};
    char *text;
    size_t size;
    struct svg s;
    FILE *out = open_memstream(&text, &size);
    svg_begin(&s, out, "title", box, 10, false, NULL, "");
    CHECK(line_labels_draw(&s, lines, all_lines, NULL));
    svg_points(&s, NULL, NULL, 0);
    svg_end(&s);
    fclose(out);
    shapes_free(lines);
    return text;
}

struct number {
    double x, y, angle, level;
};

/* The numbers in the picture, of those below the halos; checks that both are the same. */
static size_t find_numbers(const char *text, struct number *number, size_t most)
{
    size_t n = 0;
    const char *group = strstr(text, "fill=\"#3c2410\"");
    for (const char *p = text; (p = strstr(p, " transform=\"rotate(")) != NULL; p++) {
        struct number found;
        CHECK(sscanf(p, " transform=\"rotate(%lf %lf %lf)\">%lf<", &found.angle, &found.x, &found.y,
                     &found.level) == 4);
        CHECK(found.angle >= -90 && found.angle <= 90);
        CHECK(found.x >= 400 && found.x <= 16400 && found.y >= 400 && found.y <= 16400);
        if (p < group)
            continue;
        CHECK(n < most);
        number[n++] = found;
    }
    return n;
}

TEST(a_straight_line_has_its_number_along_it)
{
    static const double ways[][4] = {
        {1, 1, 4, 4}, {4, 4, 1, 1}, {1, 4, 4, 1}, {2, 1, 2, 5}, {5, 3, 1, 3}};
    static const double angle[] = {-45, -45, 45, 90, 0};
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        struct shapes lines = {.kind = SHAPE_CONTOUR};
        struct number number[9];
        add_line(&lines, 12.5, false, ways[i], 2);
        char *text = picture_of(&lines);
        CHECK(find_numbers(text, number, 9) == 1 && number[0].level == 12.5);
        CHECK(fabs(fabs(number[0].angle) - fabs(angle[i])) < 0.1 &&
              (i > 2 || number[0].angle * angle[i] > 0));
        double x = (number[0].x - 400) / 1600, y = 10 - (number[0].y - 400) / 1600;
        double off = (x - ways[i][0]) * (ways[i][3] - ways[i][1]) -
                     (y - ways[i][1]) * (ways[i][2] - ways[i][0]);
        CHECK(fabs(off) < 0.01);
        CHECK(strstr(text, ">12.5</text>") != NULL);
        free(text);
    }
}

TEST(lines_that_are_short_or_bend_have_no_number)
{
    struct shapes lines = {.kind = SHAPE_CONTOUR};
    static const double tiny[] = {5, 5, 5.1, 5}, same[] = {5, 5, 5, 5, 5, 5}, place[] = {1, 1};
    double zigzag[2 * 200];
    struct number number[9];
    for (int i = 0; i < 200; i++)
        zigzag[2 * i] = 1 + 0.04 * i, zigzag[2 * i + 1] = i % 2 == 0 ? 2 : 2.12;
    add_line(&lines, 1, false, tiny, 2);
    add_line(&lines, 2, true, same, 3);
    add_line(&lines, 3, false, place, 1);
    add_line(&lines, 4, false, zigzag, 200);
    char *text = picture_of(&lines);
    CHECK(find_numbers(text, number, 9) == 0 && strstr(text, "text-anchor") == NULL);
    free(text);
}

/* Many lines in every direction: no two numbers are nearer than their height, and long lines have several. */
TEST(no_number_covers_another)
{
    enum { MOST = 2000 };
    static struct number number[MOST];
    struct shapes lines = {.kind = SHAPE_CONTOUR};
    for (int k = 0; k < 120; k++) {
        double xy[2 * 60], radius = 0.3 + 4.5 * k / 120;
        for (int i = 0; i < 60; i++) {
            xy[2 * i] = 5 + radius * cos(i * M_PI / 30);
            xy[2 * i + 1] = 5 + radius * sin(i * M_PI / 30);
        }
        add_line(&lines, k, true, xy, 60);
    }
    char *text = picture_of(&lines);
    size_t n = find_numbers(text, number, MOST), outer = 0;
    CHECK(n >= 20);
    for (size_t i = 0; i < n; i++) {
        outer += number[i].level == 119;
        for (size_t j = 0; j < i; j++) {
            double apart = hypot(number[i].x - number[j].x, number[i].y - number[j].y);
            CHECK_MSG(apart >= 240, "%g and %g are %g apart", number[i].level, number[j].level,
                      apart);
        }
    }
    CHECK(outer >= 2);
    free(text);
}
