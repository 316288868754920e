/* pointlist.h - the paper's point list: each point with the ordered ring of its neighbours. */
#ifndef DT_POINTLIST_H
#define DT_POINTLIST_H

#include "core/set/set.h"

/* Turns a star (core/set/view_stars.h) of n ids into a canonical ring: an interior point's begins at the
 * smallest id, a hull point's at its successor; clockwise the same backwards, a hull point's from
 * its predecessor on. */
void dt_ring_turn(uint32_t *ring, uint32_t n, bool on_hull, bool cw);

#endif
