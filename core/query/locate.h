/* locate.h - where a place lies in the mesh: a hint from the grid, then a short exact walk. */
#ifndef DT_LOCATE_H
#define DT_LOCATE_H

#include "core/grid/hints.h"

/* Where q lies in a mesh of at least two vertices; vertex v has coordinates xy[v]. *half becomes
 *   DT_INSIDE     a half edge of the triangle around q
 *   DT_ON_EDGE    the half edge that q is on (all points on one line: that of a ghost)
 *   DT_ON_VERTEX  a half edge that leaves the vertex at q
 *   DT_OUTSIDE    a ghost beyond whose edge q lies; all points on one line: any ghost if q is not
 * on that line, else one whose corner 0 is the end of the line next to q. Exact. Of id, by vertex or
 * NULL, nothing is read; entries that a caller will probably read then are fetched. A half edge near q
 * saves most of the way; whatever it is, the answer is the same. Cost: constant expected. */
enum dt_where dt_find(const struct dt_mesh *m, const struct dt_point *xy, const uint32_t *id,
                      const struct dt_hints *hints, uint32_t near, struct dt_point q,
                      uint32_t *half);

/* The same, and about how many triangles the walk passed, which shows whether edits have degraded the grid. */
enum dt_where dt_find_counting(const struct dt_mesh *m, const struct dt_point *xy,
                               const struct dt_hints *hints, struct dt_point q, uint32_t *half,
                               uint32_t *steps);

/* The same from a half edge of the caller's choice. Cost: the number of triangles between. */
enum dt_where dt_walk(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                      struct dt_point q, uint32_t *half);

#endif
