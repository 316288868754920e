/* remove.h - deletion of a vertex from a finished mesh. */
#ifndef DT_REMOVE_H
#define DT_REMOVE_H

#include "core/mesh/cavity.h"

/* Removes vertex v from the triangulation; xy[v] must still be its place. The mesh stays settled (hull.h), leaving[v]
 * becomes DT_NONE. scratch is the caller's, see cavity.h. A failure (DT_NOMEM, and what its work says) leaves the mesh
 * as it was. Cost: O(d^2) for a degree d up to DT_STAR_SMALL, which is 6 on average; O(d log d) above. */
enum dt_status dt_remove(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                         struct dt_cavity *scratch);

#define DT_STAR_SMALL 48u

/* For remove.c: fills the hole left by the star of v, whose records and rim are in the cavity, by
 * the triangulation of its rim vertices. */
enum dt_status dt_remove_large(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                               struct dt_cavity *c);

/* For remove.c: replaces the star of v, whose records and rim are in the cavity, in a mesh with fixed edges.
 * DT_CROSSES, and nothing is changed: constraints that run through v would cross, or one ends there. */
enum dt_status dt_remove_fixed(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                               struct dt_cavity *c);

#endif
