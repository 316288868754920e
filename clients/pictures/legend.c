/* legend.c - see legend.h. */
#include "clients/pictures/legend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/number.h"

/* ---- round numbers ---- */

struct round_step round_step_of(double rough)
{
    int power = (int)floor(log10(rough));
    double times = rough / pow(10, power);
    int digit = times < 1.5 ? 1 : times < 3.5 ? 2 : times < 7.5 ? 5 : 10;
    return (struct round_step){digit, power};
}

/* Read from its digits: 5 * pow(10, -6) is not 5e-6. */
double round_step_times(struct round_step step, long times)
{
    char text[60];
    double v = 0;
    size_t n = (size_t)snprintf(text, sizeof text, "%lde%d", times * step.digit, step.power);
    return proto_read_double(text, n, &v) ? v : 0;
}

/* ---- any legend ---- */

/* Makes room for that many colours and ticks. */
static bool reserve(struct legend *l, size_t colours, size_t ticks)
{
    *l = (struct legend){.colour = calloc(colours + 1, sizeof *l->colour),
                         .tick = calloc(ticks + 1, sizeof *l->tick)};
    l->svg.low = l->svg.high = "";
    l->svg.colour = l->colour;
    l->svg.tick = l->tick;
    return l->colour != NULL && l->tick != NULL;
}

const struct svg_legend *legend_shown(const struct legend *l)
{
    return l->svg.colours > 0 ? &l->svg : NULL;
}

void legend_free(struct legend *l)
{
    free(l->colour);
    free(l->tick);
}

static void add_tick(struct legend *l, double at, double value, const char *unit)
{
    struct svg_tick *tick = &l->tick[l->svg.ticks++];
    tick->at = at;
    size_t n = proto_write_double(tick->text, value);
    strcpy(tick->text + n, unit);
}

/* ---- heights ---- */

bool legend_of_heights(struct legend *l, const struct relief *r, const char *name)
{
    enum { SHADES = 60, FEW = 5, TICKS = 4 * FEW };
    double span = r->high - r->low;
    if (!reserve(l, SHADES, TICKS))
        return false;
    if (!(span > 1e-290) || !isfinite(span) || fmax(fabs(r->low), fabs(r->high)) / span > 1e9)
        return true;
    struct round_step step = round_step_of(span / FEW);
    l->svg.low = name;
    l->svg.seamless = true;
    l->svg.colours = SHADES;
    for (int i = 0; i < SHADES; i++)
        l->colour[i] = relief_colour(r, r->low + (i + 0.5) / SHADES * span, 0, 0);
    for (long i = (long)floor(r->low / round_step_times(step, 1)); l->svg.ticks < TICKS; i++) {
        double v = round_step_times(step, i);
        if (v > r->high)
            break;
        if (v >= r->low)
            add_tick(l, (v - r->low) / span, v, "");
    }
    return true;
}

/* ---- bands ---- */

double legend_band_height(const struct shape *band)
{
    if (isinf(band->key))
        return isinf(band->high) ? 0 : band->high;
    return isinf(band->high) ? band->key : band->key / 2 + band->high / 2;
}

static bool begins_level(const struct shapes *bands, size_t i)
{
    return i == 0 || bands->shape[i].key > bands->shape[i - 1].key;
}

bool legend_of_bands(struct legend *l, const struct relief *r, const struct shapes *bands)
{
    size_t n = 0, k = 0;
    for (size_t i = 0; i < bands->n; i++)
        n += begins_level(bands, i);
    if (!reserve(l, n, n + 1))
        return false;
    l->svg.colours = n;
    for (size_t i = 0; i < bands->n; i++) {
        const struct shape *band = &bands->shape[i];
        if (!begins_level(bands, i))
            continue;
        l->colour[k] = relief_colour(r, legend_band_height(band), 0, 0);
        if (!isinf(band->key))
            add_tick(l, (double)k / (double)n, band->key, "");
        if (++k == n && !isinf(band->high))
            add_tick(l, 1, band->high, "");
    }
    return true;
}

/* ---- angles ---- */

/* From dark red by yellow to a light blue-green: the thinner a triangle, the darker, so that colour-blind eyes see the order. */
static const uint32_t angle_colour[LEGEND_ANGLES] = {0x7b161d, 0x9a2424, 0xb9322a, 0xd05c32,
                                                     0xe8863a, 0xefb05a, 0xf6d97a, 0xd8db9a,
                                                     0xb9ddb9, 0x96caaf, 0x73b8a5, 0x50a59b};

uint32_t legend_angle_colour(unsigned step)
{
    return angle_colour[step];
}

static double angle_at(const double *r, const double *p, const double *q)
{
    double ux = p[0] - r[0], uy = p[1] - r[1], vx = q[0] - r[0], vy = q[1] - r[1];
    return atan2(fabs(ux * vy - uy * vx), ux * vx + uy * vy) * (180 / M_PI);
}

unsigned legend_angle(const double *p, const double *q, const double *r)
{
    double least = fmin(angle_at(p, q, r), fmin(angle_at(q, r, p), angle_at(r, p, q)));
    double step = floor(least / (60.0 / LEGEND_ANGLES));
    return step >= 0 ? (unsigned)fmin(step, LEGEND_ANGLES - 1) : 0;
}

bool legend_of_angles(struct legend *l)
{
    enum { DEGREES = 60, APART = 10, TICKS = DEGREES / APART + 1 };
    if (!reserve(l, LEGEND_ANGLES, TICKS))
        return false;
    memcpy(l->colour, angle_colour, sizeof angle_colour);
    l->svg.colours = LEGEND_ANGLES;
    l->svg.low = "least angle";
    for (int v = 0; v <= DEGREES; v += APART)
        add_tick(l, (double)v / DEGREES, v, "\u00b0");
    return true;
}
