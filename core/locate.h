/* locate.h - where a place lies in the mesh: a uniform grid of hints, then a short walk.
 *
 * Each cell of the grid holds a half edge near it (the paper keeps points in its cells; a half edge serves the same
 * search and leads straight into the mesh). */
#ifndef DT_LOCATE_H
#define DT_LOCATE_H

#include "core/mesh.h"

struct dt_hints {
    struct dt_point lo;   /* corner of the grid */
    double per_x, per_y;  /* cells per unit */
    uint32_t nx, ny;
    uint32_t *cell;       /* owns nx * ny half edges */
};

void dt_hints_clear(struct dt_hints *g);

/* Builds the grid for a mesh of which every vertex v has coordinates xy[v]. *g must be zeroed or cleared.
 * Cost: linear. */
enum dt_status dt_hints_build(struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy);

#endif
