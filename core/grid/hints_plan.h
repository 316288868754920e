/* hints_plan.h - which grids the hints of a mesh consist of. */
#ifndef DT_HINTS_PLAN_H
#define DT_HINTS_PLAN_H

#include "core/control/stop.h"
#include "core/grid/hints.h"

/* Gives *g, which is clear, the grids for a settled mesh of at least two vertices. Each cell holds a
 * grid or is empty (DT_HINT_LENT); to each grid go a few vertices at least. If it is stopped, for lack
 * of memory or by the caller, *g is to be cleared. Cost: a fraction of a pass over the vertices. */
void dt_hints_plan(struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                   struct dt_stop *stop);

#endif
