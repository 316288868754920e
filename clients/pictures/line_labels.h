/* line_labels.h - numbers along contour lines: on straight pieces of the lines, upright, with a halo, none over another. */
#pragma once

#include "clients/pictures/svg.h"
#include "clients/surfaces/shapes.h"

/* Draws the levels of the lines for which `labelled` is true, long lines first, and several times on very long ones. A line without a piece
 * that is nearly straight and free gets no number. Call it where svg_constraint may be called. False when out of memory. */
bool line_labels_draw(struct svg *s, const struct shapes *lines,
                      bool (*labelled)(const void *ctx, const struct shape *line), const void *ctx);
