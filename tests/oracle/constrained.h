/* constrained.h - constrained triangulations checked by their definition, with the exact arithmetic of exact.h alone. */
#pragma once

#include "core/delaunay.h"
#include "core/delaunay_constraints.h"

/* Returns the fault of the triangulation of t as the triangulation of its points and constraints, NULL if there is none. Its
 * triangles must tile the hull. Every constraint must be a chain of edges between neighbouring vertices on it. Every other
 * edge must be locally Delaunay under the perturbation. Cost: O(n^2). */
const char *constrained_fault(const struct dt *t);

/* Whether the segments a-b and c-d cross where no vertex of t is. */
bool constraints_cross(const struct dt *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
