/* flat.h - all triangles at once, and where the triangle of each record of the mesh is among them. */
#pragma once

#include "core/delaunay_arrays.h"
#include "core/set/set.h"

/* Writes the rows of DT_TRIANGLES, 3 words each. (*place_of)[i] belongs to record i of the mesh: four times its row, and the corner
 * that comes first there; DT_NONE: it is no triangle. The caller owns it (dt_array_free). DT_UNTRIANGULATED, DT_NOMEM: *place_of is
 * NULL. Cost: linear; 4 bytes for each id ever given, and 16 for each triangle, meanwhile. */
enum dt_status dt_flat_rows(const struct dt *t, bool cw, uint32_t *triangles, uint32_t **place_of);

/* Writes halfedges[] of dt_flat (delaunay_arrays.h) for rows with these places. */
void dt_flat_halfedges(const struct dt *t, bool cw, const uint32_t *place_of, uint32_t *halfedges);
