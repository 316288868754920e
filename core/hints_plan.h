/* hints_plan.h - which grids the hints of a mesh consist of. */
#ifndef DT_HINTS_PLAN_H
#define DT_HINTS_PLAN_H

#include "core/hints.h"

/* Gives *g, which is clear, the grids for a settled mesh of at least two vertices. Each cell holds a
 * grid or is empty (DT_HINT_LENT); to each grid go a few vertices at least. DT_NOMEM: *g is to be
 * cleared. Cost: a fraction of a pass over the vertices. */
enum dt_status dt_hints_plan(struct dt_hints *g, const struct dt_mesh *m,
                             const struct dt_point *xy);

#endif
