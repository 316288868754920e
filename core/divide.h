/* divide.h - the fast engine: divide and conquer over the order of a uniform grid. */
#ifndef DT_DIVIDE_H
#define DT_DIVIDE_H

#include "core/mesh.h"

/* Triangulates n distinct points. p[n] and from[n] are the caller's and are filled: vertex v of the
 * mesh is p[v] = in[from[v]], in grid order, so that neighbours in the plane are neighbours in
 * memory. *m must be zeroed or cleared; it is complete on return, and cleared on failure (DT_NOMEM,
 * DT_CANCELLED). It is settled (hull.h), and the same whatever the number of threads.
 *
 * Cost: O(n log n), about linear in practice; 2 bytes a point of scratch memory where points are spread
 * evenly, up to 24 where they are not, however many threads there are. */
enum dt_status dt_divide(const struct dt_point *in, uint32_t n, struct dt_point *p, uint32_t *from,
                         struct dt_mesh *m, const struct dt_options *opt);

#endif
