/* picture.h - a triangulated set as an SVG: what is drawn, and in which colours. */
#pragma once

#include "clients/meshes/map_projection.h"
#include "clients/meshes/model.h"
#include "clients/pictures/relief.h"

#include <stdio.h>

enum picture_colour { COLOUR_NONE, COLOUR_QUALITY, COLOUR_DEGREE, COLOUR_ANGLE, COLOUR_RELIEF };

struct picture {
    enum picture_colour colour;
    bool numbers, has_box;
    double box[4];   /* left, lower, right, upper */
    bool geographic; /* places are in degrees: the picture is a map of them, in kilometres */
    struct map_projection projection; /* for that, chosen by the caller */
    struct relief relief;    /* picture_write: fitted to the heights, if these are its colours */
    double left, top, pixel; /* picture_write: where the picture lies (svg_place) */
    size_t shown;            /* picture_write: the points that are in the picture */
    size_t unlabelled;       /* of these, those for whose ids there was no room */
};

/* Writes the model, which has heights if the colour is COLOUR_RELIEF, and reorders its points. With p->geographic latitudes are at most 90
 * degrees, and p->projection has been chosen. False when out of memory; ferror() reports failed writes. */
bool picture_write(FILE *out, struct picture *p, const char *name, struct model *m);
