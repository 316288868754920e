/* divide.h - the fast engine: divide and conquer over the order of a uniform grid. */
#pragma once

#include "core/divide/order.h"
#include "core/divide/plan.h"
#include "core/mesh/mesh.h"

/* Brings n points into grid order, so that neighbours in the plane are neighbours in memory. Records in the plan (plan.h)
 * which points coincide and the steps of a build. Names are below DT_COINCIDENT unless all points are distinct. spare
 * has room for n points; in may be the same. -0 becomes 0. opt may be NULL. DT_NOMEM, DT_CANCELLED: the arrays
 * are then undefined. The result does not depend on the number of threads.
 *
 * Cost: O(n log n), about linear in practice. Scratch memory: 2 bytes a point if points are spread evenly, at most 24
 * otherwise, with any number of threads. */
enum dt_status dt_divide_sort(struct dt_source in, uint32_t n, struct dt_named out,
                              struct dt_named spare, struct dt_plan plan, struct dt_pages *pages,
                              const struct dt_options *opt);

/* Triangulates n sorted points by the steps of their plan: vertex v of the mesh is p[v]. The mesh must be zeroed or
 * cleared; it is complete on return, and cleared on failure (DT_NOMEM, DT_CANCELLED). It is settled (hull.h), and does not
 * depend on the number of threads. opt may be NULL. Cost: O(n log n), about linear in practice; no memory besides the
 * mesh. */
enum dt_status dt_divide_sorted(const struct dt_point *p, uint32_t n, const uint16_t *step,
                                struct dt_mesh *m, const struct dt_options *opt);

/* Both, for n distinct points, where point in[i] has the name names[i], or i if names is NULL. p[n] and from[n] are the
 * caller's and get the sorted points and their names. Cost: of both, and 2 bytes a point; the mesh is the scratch memory
 * of the sort. */
enum dt_status dt_divide(const struct dt_point *in, const uint32_t *names, uint32_t n,
                         struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                         const struct dt_options *opt);
