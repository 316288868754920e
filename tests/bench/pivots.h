/* pivots.h - an order of points that defeats a selection by pivots from a known pseudo-random sequence. */
#ifndef BENCH_PIVOTS_H
#define BENCH_PIVOTS_H

#include "core/delaunay.h"

/* Writes n points on so many scales that three grids within one another part less than half of them each:
 * what is left is cut at its median. It is in an order in which every pivot is the smallest point that is
 * left, if the pivots are picked by dt_random_below from a state that begins with the number of points. */
void pivots_fill(struct dt_point *p, uint32_t n);

#endif
