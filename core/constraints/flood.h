/* flood.h - which triangles a polygon encloses: the sides are the edges that an odd number of constraints cover. */
#pragma once

#include "core/constraints/crossings.h"
#include "core/exact/sum.h"
#include "core/mesh/mesh.h"

/* The face of a triangle: 0 outside, 1 inside, once it is known; and a flag if loose sides may be in its interior. */
enum { DT_FLOOD_INSIDE = 1, DT_FLOOD_UNKNOWN = 2, DT_FLOOD_NEAR = 4 };

/* No face is known. */
void dt_flood_begin(struct dt_mesh *m);

/* Finds whether each triangle is outside or inside; ghosts are outside. The mesh has dt_fixed_begin and dt_flood_begin behind it.
 * `loose` are n sides that no edges stand for; with them, a triangle is inside if its centroid is enclosed an odd number of times. They
 * are looked at in triangles with the flag. *area, unless it is NULL, gets twice the area of what is inside, added. DT_NOMEM,
 * DT_CANCELLED: faces mean nothing. Cost: linear in the triangles, and for those with the flag in n. */
enum dt_status dt_flood(struct dt_mesh *m, const struct dt_point *xy,
                        const struct dt_segment *loose, size_t n, struct dt_stop *work,
                        struct dt_sum *area);
