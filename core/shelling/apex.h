/* apex.h - the paper's third-point search: which point completes the Delaunay triangle to the left of an edge. */
#pragma once

#include "core/shelling/grid.h"

/* The place of the apex of the directed edge a->b (places). The apex lies left of the edge; the circle through a, b and
 * the apex contains no other point that lies left of the edge. Ties are broken as dt_incircle_perturbed does. DT_NONE if
 * no point lies left of the edge: points collinear with a and b are never an apex. The result depends only on the edge
 * and the points that are not removed; it is undefined if the search has to stop. Cost: constant expected on evenly
 * spread points, counted by g->stop. */
uint32_t dt_apex(struct dt_grid *g, uint32_t a, uint32_t b);
