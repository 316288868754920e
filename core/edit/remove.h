/* remove.h - deletion of a vertex from a finished mesh. */
#pragma once

#include "core/mesh/cavity.h"

/* Removes vertex v from the triangulation; xy[v] must still be its place. The mesh stays settled (hull.h), leaving[v]
 * becomes DT_NONE. scratch is the caller's, see cavity.h. A failure (DT_NOMEM, or the end of its work) leaves the mesh
 * as it was. Cost: O(d^2) for a degree d up to DT_STAR_SMALL, which is 6 on average; O(d log d) above. */
enum dt_status dt_remove(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                         struct dt_cavity *scratch);

#define DT_STAR_SMALL 48u

/* ---- for remove.c ---- */

/* Constraints that run through a vertex, seen from its star. */
struct dt_through {
    uint32_t n;       /* fixed spokes: 0 or 2 */
    uint32_t half[2]; /* these: half edges from the vertex */
    uint32_t at[2];   /* the corners of the rim to which they lead, ascending */
    uint32_t covers;  /* constraints that cover them */
    uint32_t face[2]; /* of the triangles from either one on; all are of face[0] if there is none */
};

/* Fills the hole left by the star of v, whose records and rim are in the cavity, by the triangulation of its rim
 * vertices. Either none or both of the edges from v along the hull were fixed, and no others. Real triangles get the
 * face. */
enum dt_status dt_remove_large(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                               struct dt_cavity *c, uint32_t face);

/* The same if constraints run through v and it is no hull vertex. */
enum dt_status dt_remove_between(struct dt_mesh *m, const struct dt_point *xy, struct dt_cavity *c,
                                 const struct dt_through *t);

/* Looks at the star of v, whose records and rim are in the cavity. False: constraints that run through v would cross,
 * or a constraint ends at v. */
bool dt_find_through(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                     const struct dt_cavity *c, struct dt_through *t);
