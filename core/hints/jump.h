/* jump.h - where a search that has walked too far should continue.
 *
 * Walks are short where the grid of hints leads close to the place. They are long where thin triangles lie across the
 * way: inside a circle, or between two far lines of points, a search passes a large share of all triangles. Both kinds
 * of walk approach q in some measure:
 *
 *     to a triangle    its circumcircle has q ever deeper inside (the triangles, lifted to the
 *                      paraboloid, are a convex surface, and the walk climbs above q)
 *     to a vertex      its distance to q becomes ever smaller
 *
 * A walk that begins at the best of a sample passes only better ones. If the sample has about the root of n of n
 * triangles, the walk passes about the root of n triangles, for any distribution of the points.
 * [Devroye, Muecke & Zhu, "A note on point location in Delaunay triangulations of random points", 1998] jump to the
 * nearest sampled vertex also to find a triangle, which needs evenly spread points. If all triangles are equally good,
 * as the triangles of one circle, a sample does not help. */
#pragma once

#include "core/mesh/mesh.h"

/* The root of n: the size of a sample of n, and the length of a walk from which a sample pays. */
uint32_t dt_jump_samples(uint32_t n);

/* Returns the base half edge of the triangle in whose circumcircle q lies deepest, up to rounding, among a sample of
 * triangles and the triangle at the base half edge `from`. Not for points on one line. */
uint32_t dt_jump_triangle(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                          struct dt_point q);

/* Returns the vertex nearest to q, up to rounding, among a sample of vertices and `from`. */
uint32_t dt_jump_vertex(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                        struct dt_point q);
