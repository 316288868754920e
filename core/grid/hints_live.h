/* hints_live.h - the grid of hints while the mesh changes beneath it.
 *
 * Edits update only the cell at their place, so any other cell may point to a record that is dead or reused
 * elsewhere. A reader of a hint therefore checks whether it is good; if it is not, a cell nearby has a better
 * one. When walks have grown long, or the set has, the grid is rebuilt: amortised constant cost. */
#ifndef DT_HINTS_LIVE_H
#define DT_HINTS_LIVE_H

#include "core/grid/hints.h"

/* The base half edge of a live triangle for q: what the grid has if that is good, else what a cell
 * nearby has. The mesh must have at least two vertices. */
uint32_t dt_hint_live(const struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                      struct dt_point q);

/* Enters the triangle of half edge h, which is near q, in the cell of q. */
void dt_hint_put(struct dt_hints *g, struct dt_point q, uint32_t h);

#endif
