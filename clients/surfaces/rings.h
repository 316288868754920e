/* rings.h - polygons with holes, from the loops of an alpha shape. */
#pragma once

#include "clients/points/paths.h"
#include "clients/surfaces/shapes.h"

/* Take a row `outer k id1 ... idk` or `hole k id1 ... idk` of ALPHA as a path, whose corners are the ids. False with a static
 * sentence in *fault; then *p has no new path. */
bool rings_take(struct paths *p, const char *row, size_t len, const char **fault);

/* When the corners are places in xy: appends to *s, whose kind is SHAPE_RING, each outer ring and after it its holes. False: see
 * s->fault. */
bool rings_to_shapes(struct paths *p, const double *xy, double radius, struct shapes *s);
