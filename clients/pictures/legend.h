/* legend.h - what the colours of a picture mean: heights, bands, or least angles. */
#pragma once

#include "clients/pictures/relief.h"
#include "clients/pictures/svg.h"
#include "clients/surfaces/shapes.h"

struct legend {
    struct svg_legend svg;
    uint32_t *colour;      /* owns; what svg borrows */
    struct svg_tick *tick; /* owns; the same */
};

/* Heights from r->low to r->high, in the colours of level ground; name: of the field, without markup. False when out of memory, as
 * of the next two; legend_free in any case. */
bool legend_of_heights(struct legend *l, const struct relief *r, const char *name);

/* Bands, sorted by their levels: each with its colour. */
bool legend_of_bands(struct legend *l, const struct relief *r, const struct shapes *bands);

/* Least angles, in steps of 5 degrees. */
bool legend_of_angles(struct legend *l);

/* For svg_begin; NULL if there is nothing to explain: no band, or all heights are equal. */
const struct svg_legend *legend_shown(const struct legend *l);
void legend_free(struct legend *l);

/* The height whose colour a band has. */
double legend_band_height(const struct shape *band);

/* The step of a triangle's least angle, and its colour. */
enum { LEGEND_ANGLES = 12 };
unsigned legend_angle(const double *p, const double *q, const double *r);
uint32_t legend_angle_colour(unsigned step);

/* ---- round numbers ---- */

/* 1, 2, 5 or 10 times a power of ten. */
struct round_step {
    int digit, power;
};

/* The one nearest to `rough`, which is finite and above 0. */
struct round_step round_step_of(double rough);

/* `times` as much: the nearest double. */
double round_step_times(struct round_step step, long times);
