/* hints_build.h - builds the grid of hints. */
#ifndef DT_HINTS_BUILD_H
#define DT_HINTS_BUILD_H

#include "core/grid/hints.h"

/* Builds the grid for a settled mesh of which every vertex v has coordinates xy[v]. *g is cleared
 * first, and left so unless DT_OK. Vertices that are in no triangle must have DT_NONE in leaving[].
 * opt, which may be NULL: its pool shares the work, and which of a cell's half edges is its hint may
 * then differ from time to time; its flag is polled. A caller that takes the grid for this mesh sets m->recycled to
 * false.
 * Cost: linear. */
enum dt_status dt_hints_build(struct dt_hints *g, const struct dt_mesh *m,
                              const struct dt_point *xy, const struct dt_options *opt);

#endif
