/* mesh_check.h - a plain proof that a mesh is the canonical triangulation, independent of
 * core/set/check.c. */
#pragma once

#include "core/mesh/mesh.h"

/* Fails the test unless m is a closed surface of the right size over its vertices (those with leaving[] set, or
 * one alone). It must be Delaunay everywhere under the tie rule, with a convex hull, and
 * settled (core/mesh/hull.h). */
void mesh_check(const struct dt_mesh *m, const struct dt_point *xy);
