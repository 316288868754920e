/* local_move.h - a vertex that moves so little that no edge changes. */
#ifndef DT_LOCAL_MOVE_H
#define DT_LOCAL_MOVE_H

#include "core/mesh.h"
#include "core/work.h"

/* *stays: whether the mesh stays the canonical triangulation, as it is, if vertex v moves from xy[v]
 * to `to`; false for vertices on the hull. Nothing is changed. Cost: the degree of v, taken off the
 * work. */
enum dt_status dt_stays_delaunay(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                 struct dt_point to, struct dt_work *work, bool *stays);

#endif
