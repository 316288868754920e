/* constrained.h - constrained triangulations checked by their definition, with the exact arithmetic of exact.h alone. */
#ifndef CONSTRAINED_H
#define CONSTRAINED_H

#include "core/delaunay.h"
#include "core/delaunay_constraints.h"

/* What is wrong with the triangulation of t as that of its points and constraints, NULL if nothing: its triangles tile
 * the hull, every constraint is a chain of edges between neighbouring vertices on it, and every other edge is locally
 * Delaunay under the perturbation. Cost: O(n^2). */
const char *constrained_fault(const struct dt *t);

/* Whether the segments a-b and c-d cross where no vertex of t is. */
bool constraints_cross(const struct dt *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

#endif
