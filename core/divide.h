/* divide.h - the fast engine: divide and conquer over the order of a uniform grid. */
#ifndef DT_DIVIDE_H
#define DT_DIVIDE_H

#include "core/order.h"
#include "core/plan.h"

/* Triangulates n distinct points. p[n] and from[n] are the caller's and are filled: vertex v of the
 * mesh is p[v], in grid order, so that neighbours in the plane are neighbours in memory. from[v] is
 * the name of that point: point in[i] has the name names[i], or i if names is NULL. *m must be zeroed or cleared; it is complete on return, and cleared on failure (DT_NOMEM,
 * DT_CANCELLED). It is settled (hull.h), and the same whatever the number of threads.
 *
 * Cost: O(n log n), about linear in practice; 2 bytes a point of scratch memory where points are spread
 * evenly, up to 24 where they are not, however many threads there are. */
enum dt_status dt_divide(const struct dt_point *in, const uint32_t *names, uint32_t n,
                         struct dt_point *p, uint32_t *from, struct dt_mesh *m,
                         const struct dt_options *opt);

/* Only brings n points, with names below DT_MAX_POINTS, into the order of dt_divide, and records in the plan (plan.h)
 * which of them coincide and what is left to be done. spare has room for n points; in may be the same. DT_NOMEM,
 * DT_CANCELLED: what is left is of no use. Cost: as much as dt_divide takes before the first merge. */
enum dt_status dt_divide_sort(struct dt_source in, uint32_t n, struct dt_named out,
                              struct dt_named spare, struct dt_plan plan, struct dt_pages *pages,
                              const struct dt_options *opt);

/* Triangulates n points that are sorted, with the steps of the plan, as dt_divide does. Cost: O(n log n), about linear
 * in practice; no memory but that of the mesh. */
enum dt_status dt_divide_sorted(const struct dt_point *p, uint32_t n, const uint16_t *step,
                                struct dt_mesh *m, const struct dt_options *opt);

/* For both: the records of the whole mesh are there, and `all` is the part that holds every point. Joins keep
 * leaving[] of every vertex right, so only the hull is left to be settled. */
void dt_divide_finish(struct dt_mesh *m, uint32_t n, const struct dt_part *all,
                      const struct dt_pool *pool, struct dt_stop *stop);

#endif
