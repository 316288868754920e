/* show_relief.c - see show_relief.h. A terminal that does not announce all colours ($COLORTERM) gets the 256 colours
 * that all terminals have. */
#include "clients/commands/show_relief.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/output.h"
#include "clients/cli/request.h"
#include "clients/meshes/map_projection.h"
#include "clients/pictures/relief.h"
#include "clients/surfaces/raster_fetch.h"

enum { NO_COLOUR = 1 << 24 };

struct screen {
    const struct grid *g;
    /* the same cells, with values inside of borders alone; NULL: there are no borders */
    const struct grid *inside;
    struct relief relief;
    bool all_colours;
};

unsigned show_relief_cube(uint32_t rgb)
{
    unsigned at = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        unsigned v = rgb >> shift & 255; /* the cube has 0, 95, 135, 175, 215, 255 */
        at = 6 * at + (v < 48 ? 0 : v < 115 ? 1 : (v - 35) / 40);
    }
    return 16 + at;
}

static double value_at(const struct grid *g, uint32_t column, uint32_t row)
{
    return row < g->rows ? g->value[(size_t)row * g->columns + column] : (double)NAN;
}

/* Three quarters of the way to white. */
static uint32_t pale(uint32_t rgb)
{
    return 0xFFFFFF - ((0xFFFFFF - rgb) >> 2 & 0x3F3F3F);
}

static uint32_t colour_at(const struct screen *s, uint32_t column, uint32_t row)
{
    double dx, dy, z = value_at(s->g, column, row);
    if (isnan(z))
        return NO_COLOUR;
    relief_slope(s->g, column, row, &dx, &dy);
    uint32_t rgb = relief_colour(&s->relief, z, dx, dy);
    return s->inside != NULL && isnan(value_at(s->inside, column, row)) ? pale(rgb) : rgb;
}

static void put_colour(const struct screen *s, int ground, uint32_t rgb)
{
    if (rgb == NO_COLOUR)
        printf("\033[%d9m", ground);
    else if (s->all_colours)
        printf("\033[%d8;2;%u;%u;%um", ground, rgb >> 16, rgb >> 8 & 255, rgb & 255);
    else
        printf("\033[%d8;5;%um", ground, show_relief_cube(rgb));
}

/* The upper cell is the character, a half block; the lower one its background. */
static void print_colours(const struct screen *s)
{
    for (uint32_t j = 0; j < s->g->rows; j += 2) {
        uint32_t upper_before = NO_COLOUR, lower_before = NO_COLOUR;
        for (uint32_t i = 0; i < s->g->columns; i++) {
            uint32_t upper = colour_at(s, i, j), lower = colour_at(s, i, j + 1);
            bool swapped = upper == NO_COLOUR && lower != NO_COLOUR;
            uint32_t fore = swapped ? lower : upper, back = swapped ? upper : lower;
            if (fore != upper_before)
                put_colour(s, 3, fore);
            if (back != lower_before)
                put_colour(s, 4, back);
            upper_before = fore;
            lower_before = back;
            fputs(fore == NO_COLOUR ? " " : swapped ? "\xE2\x96\x84" : "\xE2\x96\x80", stdout);
        }
        puts("\033[0m");
    }
}

/* The higher, the denser. */
static char character(const struct screen *s, double z)
{
    static const char low_to_high[] = ".:-=+*#%@";
    double t = (z / 2 - s->relief.low / 2) / (s->relief.high / 2 - s->relief.low / 2);
    if (isnan(z))
        return ' ';
    return low_to_high[t > 0 ? (size_t)fmin(9 * t, 8) : 0];
}

/* Each line between two texts, of which the first has a comma before it from the second line on. */
static void print_plain(const struct screen *s, const char *before, const char *after)
{
    for (uint32_t j = 0; j < s->g->rows; j += 2) {
        fputs(j == 0 && before[0] == ',' ? before + 1 : before, stdout);
        for (uint32_t i = 0; i < s->g->columns; i++) {
            double upper = value_at(s->g, i, j);
            putchar(character(s, isnan(upper) ? value_at(s->g, i, j + 1) : upper));
        }
        fputs(after, stdout);
    }
}

static void print_json(const struct screen *s)
{
    json_begin(true);
    json_key("lines");
    putchar('[');
    print_plain(s, ",\"", "\"");
    putchar(']');
    json_finish();
}

/* ---- the legend ---- */

/* A legend takes the last line, unless the picture is too small for it, or is JSON. */
static bool has_legend(uint32_t columns, uint32_t lines)
{
    enum { LEAST_COLUMNS = 60, LEAST_LINES = 8 };
    return !json_chosen() && columns >= LEAST_COLUMNS && lines >= LEAST_LINES;
}

/* The lowest height, its colour or character to those of the highest one, and the highest height. */
static void print_legend(const struct screen *s, const char *field, bool plain)
{
    enum { BAR = 27 };
    double low = s->relief.low, high = s->relief.high;
    printf("%.20s  %.4g ", field, low);
    for (int i = 0; i < BAR; i++) {
        double share = (i + 0.5) / BAR, z = low * (1 - share) + high * share;
        if (!plain)
            put_colour(s, 4, relief_colour(&s->relief, z, 0, 0));
        putchar(plain ? character(s, z) : ' ');
    }
    printf("%s %.4g\n", plain ? "" : "\033[0m", high);
}

/* ---- from the server ---- */

/* Cells of a map of degrees. */
static enum delaunay_result squeeze(struct delaunay_client *c, const char *set,
                                    struct raster_request *request, const char **fault)
{
    struct map_projection d;
    enum delaunay_result r = raster_bounds(c, set, request->box, fault);
    if (r != DELAUNAY_OK)
        return r;
    request->has_box = true;
    if (!map_projection_choose(&d, request->box, 2)) {
        *fault = "--geographic: there are latitudes beyond 90 degrees";
        return DELAUNAY_STOPPED;
    }
    request->squeeze = d.x / d.y;
    return DELAUNAY_OK;
}

int show_relief(struct delaunay_client *c, const char *set, const char *field, uint32_t columns,
                uint32_t lines, bool plain, bool geographic)
{
    bool legend = has_legend(columns, lines);
    struct raster_request request = {.columns = columns, .most_rows = 2 * (lines - legend)};
    const char *fault = NULL, *terminal = getenv("COLORTERM");
    struct grid g;
    enum delaunay_result r = DELAUNAY_OK;
    if (geographic)
        r = squeeze(c, set, &request, &fault);
    if (r == DELAUNAY_OK)
        r = raster_fetch(c, set, field, &request, &g, &fault);
    if (r != DELAUNAY_OK)
        return r == DELAUNAY_STOPPED ? output_fault("", fault) : request_outcome(c, r);
    struct screen s = {.g = &g};
    struct grid inside = {0};
    s.relief.style = RELIEF_BOTH;
    s.all_colours =
        terminal != NULL && (strcmp(terminal, "truecolor") == 0 || strcmp(terminal, "24bit") == 0);
    request.inside = "any"; /* an error: without closed borders nothing is outside */
    if (raster_fetch(c, set, field, &request, &inside, &fault) == DELAUNAY_OK &&
        inside.columns == g.columns && inside.rows == g.rows && relief_fit(&s.relief, &inside))
        s.inside = &inside;
    else
        legend &= relief_fit(&s.relief, &g);
    if (json_chosen())
        print_json(&s);
    else if (plain)
        print_plain(&s, "", "\n");
    else
        print_colours(&s);
    if (legend)
        print_legend(&s, field, plain);
    raster_free(&g);
    raster_free(&inside);
    return EXIT_DONE;
}
