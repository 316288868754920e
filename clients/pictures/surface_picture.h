/* surface_picture.h - the ground of a triangulation with heights as SVG, with contour lines or Voronoi cells. */
#pragma once

#include "clients/meshes/model.h"
#include "clients/pictures/relief.h"
#include "clients/pictures/svg.h"
#include "clients/surfaces/shapes.h"

/* Fits r, whose style is given, to the heights of all points, or of what is inside of borders. Without heights r->low is above r->high. */
void surface_fit(struct relief *r, const struct model *m, int field);

/* Draws every triangle in the colour of its mean height and of its slope; what is outside of all borders is pale. False when out of
 * memory. */
bool surface_draw_ground(struct svg *s, const struct model *m, int field, const struct relief *r);

/* Draws the constraints of m, bold; call it where svg_constraint may be called. */
void surface_draw_constraints(struct svg *s, const struct model *m);

/* Moves the points within the box to the front; returns their number. */
size_t surface_cut_points(struct model *m, const double *box);

/* Writes a picture of contour lines, of the constraints of m, and of the ground below them if m has triangles. If there are more than five
 * levels, the multiples of five steps are heavy. numbers: the levels stand along heavy lines, or along all if none is heavy.
 * box: NULL or what is shown. unit: of the scale, "" if unknown. False when out of memory. */
bool surface_write_contours(FILE *out, const char *title, const struct shapes *lines,
                            const struct model *m, int field, const double *box, const char *unit,
                            bool numbers);

/* Writes a picture of bands, filled with the colours of their heights, of the constraints of m, and of what the colours mean. box: NULL or
 * what is shown. False when out of memory. */
bool surface_write_bands(FILE *out, const char *title, const struct shapes *bands,
                         const struct model *m, const double *box, const char *unit);

/* Writes a picture of cells and of the points of m; cells have the colours of the heights in m's field, if that is not
 * -1. False when out of memory. */
bool surface_write_cells(FILE *out, const char *title, const struct shapes *cells, struct model *m,
                         int field, const char *unit);

/* Writes a picture of an alpha shape and of the points of m. box: NULL or what is shown. False when out of memory. */
bool surface_write_rings(FILE *out, const char *title, const struct shapes *rings, struct model *m,
                         const double *box, const char *unit);
