/* voronoi.h - the weights of natural neighbours by their definition: the Voronoi cell of a place is clipped by one
 * half plane after the other, in numbers of 2,500 bits. */
#pragma once

#include "core/delaunay_surface.h"

/* weight[i] of the point p[i] at q, which is strictly inside the convex hull of the n distinct points and is none
 * of them. Cost: O(n k^2) for k natural neighbours, each step some microseconds. */
void voronoi_weights(const struct dt_point *p, uint32_t n, struct dt_point q,
                     enum dt_interpolation how, double *weight);
