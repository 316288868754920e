/* definition.h - triangulations checked by their definition, for tests of the engines. */
#pragma once

#include "core/mesh/mesh.h"

struct triangle {
    uint32_t v[3];
};

/* The canonical Delaunay triangulation of n distinct points by definition, O(n^4): every
 * counterclockwise triple whose circle no other point is in, each from its smallest vertex, sorted.
 * Room for 2n triangles; returns how many. */
uint32_t defined_triangles(const struct dt_point *p, uint32_t n, struct triangle *out);

/* The triangles of a mesh, ghosts left out, in the same form; number[v] is what to call vertex v.
 * Room for m->tri_end. */
uint32_t mesh_triangles(const struct dt_mesh *m, const uint32_t *number, struct triangle *out);

/* Returns the fault of a mesh as the triangulation of n vertices with coordinates p[], NULL if there is none. A
 * closed surface of the right size that is Delaunay at every edge and has a convex hull is the canonical
 * triangulation. */
const char *mesh_fault(const struct dt_mesh *m, const struct dt_point *p, uint32_t n);

/* Replaces n points by the distinct ones among them in random order (test_random); returns how
 * many. */
uint32_t keep_distinct(struct dt_point *p, uint32_t n);
