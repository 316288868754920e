/* star.h - the neighbours of a vertex of a settled mesh (hull.h), as ids: id[v] is that of vertex v.
 *
 * A star is read counterclockwise: the star of an interior vertex from anywhere, the star of a hull vertex
 * from its successor on the hull to its predecessor. */
#pragma once

#include "core/mesh/mesh.h"

/* Returns the number of neighbours of v, `limit` if it has more. */
uint32_t dt_star_degree(const struct dt_mesh *m, uint32_t v, uint32_t limit);

/* Its ring into ring[room]. Returns its degree, DT_NONE if it is larger than room. */
uint32_t dt_star_ring(const struct dt_mesh *m, const uint32_t *id, uint32_t v, uint32_t *ring,
                      size_t room);

/* The half edge from vertex u to vertex v, DT_NONE if they are not joined; found without a look at places. Both stars are searched in
 * step, so the cost is the smaller degree. */
uint32_t dt_edge_between(const struct dt_mesh *m, uint32_t u, uint32_t v);

/* Turns a star of n ids into a canonical ring. The ring of an interior point begins at the smallest id, the ring of a hull
 * point at its successor. Clockwise it is the same backwards; a hull point's ring then begins at its predecessor. */
void dt_ring_turn(uint32_t *ring, uint32_t n, bool on_hull, bool cw);

/* The same for an interior point, into to[n]. */
void dt_ring_copy(uint32_t *to, const uint32_t *ring, uint32_t n, bool cw);

/* ---- how a star is saved ---- */

/* The words that the image of the star of vertex v has, and the image. */
static inline uint32_t dt_star_words(const struct dt_mesh *m, uint32_t v)
{
    return 1 + dt_star_degree(m, v, DT_NONE);
}

void dt_star_save(const struct dt_mesh *m, const uint32_t *id, uint32_t v, uint32_t *image);
