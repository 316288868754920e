/* insert.h - insertion of a vertex into a finished mesh. */
#pragma once

#include "core/mesh/cavity.h"

/* Adds vertex v, which is in no triangle yet, to the triangulation. xy[v] is its place; dt_find or dt_walk has found `where`
 * and `half` for it; `where` must not be DT_ON_VERTEX. If the mesh is no line, `half` may belong to any triangle that is in
 * conflict with v. If the mesh has one vertex only, `half` is that vertex. The mesh stays settled (hull.h). scratch is the
 * caller's, see cavity.h. A failure (DT_NOMEM, or the end of its work) leaves the mesh as it was.
 * Cost: the number of triangles replaced, about 4 on average. */
enum dt_status dt_insert(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                         enum dt_where where, uint32_t half, struct dt_cavity *scratch);

/* Whether q is certainly inside the circle of the triangle of half edge h. If so, q is not at a vertex, and the triangle is
 * in conflict with a new vertex at q. */
bool dt_is_certain_conflict(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                            struct dt_point q);

/* For remove_large.c: whether a new point at q would replace the triangle or ghost with base half
 * edge t, */
bool dt_conflict(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t, struct dt_point q);

/* and all that it would replace, t among them, into *c with the rim counterclockwise; c->record has
 * room for a triangle at each rim edge. */
enum dt_status dt_find_cavity(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t,
                              struct dt_point q, struct dt_cavity *c);

/* Adds vertex v; there must be room for it and for two triangles (dt_mesh_make_room). Its star replaces the triangles of the
 * cavity, which dt_find_cavity has just found for its place, with c->split == DT_NONE. The mesh has triangles, none of the cavity's
 * edges is fixed, and all are inside the hull. */
void dt_insert_found(struct dt_mesh *m, uint32_t v, struct dt_cavity *c);
