/* pivots.h - an order of points that defeats a selection by pivots from a known pseudo-random sequence. */
#pragma once

#include "core/delaunay.h"

/* Writes n points on so many scales that three nested grids separate less than half of them each, so that
 * the rest is split at its median. They are in an order in which every pivot is the smallest remaining point,
 * if pivots are picked by dt_random_below from a state that begins with the number of points. */
void pivots_fill(struct dt_point *p, uint32_t n);
