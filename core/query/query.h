/* query.h - functions that all searches near a place use. */
#ifndef DT_QUERY_H
#define DT_QUERY_H

#include "core/set/set.h"

/* The half edge from u to v, DT_NONE if there is none. Both stars are searched in step, so that a
 * vertex of high degree costs no more than its partner. */
uint32_t dt_half_between(const struct dt_mesh *m, uint32_t u, uint32_t v);

/* The corners of the triangle of the half edge h, from the smallest id. */
void dt_triangle_ids(const struct dt *t, uint32_t h, bool cw, uint32_t row[3]);

/* For a search from star to star that walks round the origin of h: fetches the triangle beyond the edge
 * opposite to it, which the stars of two neighbours share. */
static inline void dt_fetch_beyond_star(const struct dt_mesh *m, uint32_t h)
{
    dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(h)))]);
}

/* Replaces the vertices list->v[from .. n - 1], which are distinct, by their ids in ascending order.
 * Cost: linear. */
void dt_vertices_to_ids(const struct dt *t, struct dt_ids *list, size_t from);

#endif
