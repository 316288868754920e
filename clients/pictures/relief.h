/* relief.h - colours of a surface by its height and by the light on its slopes, which comes from the north-west, 45
 * degrees above the horizon. Slopes are exaggerated by a factor that suits the surface as a whole, so it does not
 * matter in which units heights and coordinates are. */
#pragma once

#include "clients/surfaces/grid_file.h"

enum relief_style {
    RELIEF_BOTH,  /* colours by height, light and shadow */
    RELIEF_LIGHT, /* grey, light and shadow */
    RELIEF_HEIGHT /* colours by height */
};

struct relief {
    enum relief_style style;
    double low, high; /* heights of the first and the last colour */
    double steepness; /* factor of slopes */
};

/* Takes a style's name; false if it is none. */
bool relief_read_style(const char *name, enum relief_style *style);

/* The factor for slopes whose mean is `slope`. */
double relief_steepness(double slope);

/* A colour, 0xRRGGBB, where the height is z and grows by dx and dy a unit eastwards and northwards. */
uint32_t relief_colour(const struct relief *r, double z, double dx, double dy);

/* The slope at a cell, from its neighbours that have values. */
void relief_slope(const struct grid *g, uint32_t column, uint32_t row, double *dx, double *dy);

/* Fits r, whose style is given, to a grid; false if that has no values. */
bool relief_fit(struct relief *r, const struct grid *g);

/* Fills rgba[4 * columns * rows]; transparent where there are no values. */
void relief_paint(const struct relief *r, const struct grid *g, unsigned char *rgba);
