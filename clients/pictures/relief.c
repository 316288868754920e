/* relief.c - see relief.h. Light as of a matt surface [Lambert 1760]: the cosine of its angle to the normal. */
#include "clients/pictures/relief.h"

#include <math.h>
#include <string.h>

/* Colours from the lowest to the highest ground, evenly spaced. */
static const unsigned char ramp[][3] = {{62, 123, 86},   {138, 172, 104}, {214, 208, 142},
                                        {201, 163, 103}, {158, 116, 82},  {146, 127, 120},
                                        {245, 244, 242}};
enum { RAMP_STEPS = sizeof ramp / sizeof ramp[0] - 1 };

static const double usual_slope = 0.5; /* of the exaggerated surface, in the mean */

bool relief_read_style(const char *name, enum relief_style *style)
{
    static const char *const names[] = {
        [RELIEF_BOTH] = "relief", [RELIEF_LIGHT] = "light", [RELIEF_HEIGHT] = "height"};
    for (int i = 0; i < 3; i++)
        if (strcmp(names[i], name) == 0) {
            *style = (enum relief_style)i;
            return true;
        }
    return false;
}

double relief_steepness(double slope)
{
    return slope > 0 && isfinite(usual_slope / slope) ? usual_slope / slope : 0;
}

/* 1 on level ground. */
static double brightness(const struct relief *r, double dx, double dy)
{
    double a = r->steepness * dx, b = r->steepness * dy;
    double light = (a - b) * M_SQRT1_2 + 1; /* (-a, -b, 1) times (-1, 1, sqrt 2), over sqrt 2 */
    return fmax(light, 0) / sqrt(a * a + b * b + 1);
}

static double ramp_at(double t, int channel)
{
    int i = t >= 1 ? RAMP_STEPS - 1 : (int)(t * RAMP_STEPS);
    double part = t * RAMP_STEPS - i;
    return ramp[i][channel] + part * (ramp[i + 1][channel] - ramp[i][channel]);
}

uint32_t relief_colour(const struct relief *r, double z, double dx, double dy)
{
    double t = r->high > r->low ? (z / 2 - r->low / 2) / (r->high / 2 - r->low / 2) : 0.5;
    double light = r->style == RELIEF_HEIGHT ? 1 : 0.25 + 0.75 * brightness(r, dx, dy);
    uint32_t rgb = 0;
    t = fmin(fmax(t, 0), 1);
    for (int i = 0; i < 3; i++) {
        double v = light * (r->style == RELIEF_LIGHT ? 190.0 : ramp_at(t, i));
        rgb = rgb << 8 | (uint32_t)lround(fmin(v, 255));
    }
    return rgb;
}

static double value_at(const struct grid *g, int64_t column, int64_t row)
{
    bool inside = column >= 0 && row >= 0 && column < g->columns && row < g->rows;
    return inside ? g->value[(size_t)row * g->columns + (size_t)column] : (double)NAN;
}

/* The rise from a over z to b, a cell apart each; nan: missing. */
static double rise(double a, double z, double b, double cell)
{
    if (isnan(a))
        return isnan(b) ? 0 : (b - z) / cell;
    return isnan(b) ? (z - a) / cell : (b - a) / (2 * cell);
}

void relief_slope(const struct grid *g, uint32_t column, uint32_t row, double *dx, double *dy)
{
    int64_t i = column, j = row;
    double z = value_at(g, i, j);
    *dx = rise(value_at(g, i - 1, j), z, value_at(g, i + 1, j), g->cell);
    *dy = rise(value_at(g, i, j + 1), z, value_at(g, i, j - 1), g->cell);
}

bool relief_fit(struct relief *r, const struct grid *g)
{
    double slopes = 0;
    size_t n = 0;
    if (!grid_range(g, &r->low, &r->high))
        return false;
    for (uint32_t j = 0; j < g->rows; j++)
        for (uint32_t i = 0; i < g->columns; i++) {
            double dx, dy;
            if (isnan(value_at(g, i, j)))
                continue;
            relief_slope(g, i, j, &dx, &dy);
            slopes += hypot(dx, dy);
            n++;
        }
    r->steepness = relief_steepness(slopes / (double)n);
    return true;
}

void relief_paint(const struct relief *r, const struct grid *g, unsigned char *rgba)
{
    memset(rgba, 0, 4 * (size_t)g->columns * g->rows);
    for (uint32_t j = 0; j < g->rows; j++)
        for (uint32_t i = 0; i < g->columns; i++, rgba += 4) {
            double dx, dy;
            if (isnan(value_at(g, i, j)))
                continue;
            relief_slope(g, i, j, &dx, &dy);
            uint32_t rgb = relief_colour(r, value_at(g, i, j), dx, dy);
            rgba[0] = (unsigned char)(rgb >> 16);
            rgba[1] = (unsigned char)(rgb >> 8);
            rgba[2] = (unsigned char)rgb;
            rgba[3] = 255;
        }
}
