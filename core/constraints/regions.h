/* regions.h - what borders enclose: the regions, and which triangles are inside which.
 *
 * A place is inside the border of number k if a way from there to infinity crosses the borders of that number an odd
 * number of times. Edges that an odd number of them cover divide the plane into faces; a triangle's record has the number
 * of its face (core/mesh/fixed.h). Face 0 is the outside. Faces are numbered in the order of a tour that begins there and
 * crosses one such edge after the other, depth first:
 *
 *      +-------------+     0 | 1     what is inside 7 is a range of faces, 1 .. 3; inside 8: 3.
 *      | 7   +----+  |     1 | 2     (An enclosed face belongs to those borders that the way to it has crossed an odd
 *      |     | 8  |  |               number of times.)
 *      |  +--+-+  |  |               So a region is a few ranges, and edits of points, which carry faces from triangle
 *      |  | 9  |--+  |               to triangle, never change them.
 *      +-------------+
 */
#pragma once

#include "core/constraints/declared.h"
#include "core/mesh/mesh.h"
#include "core/points/points.h"

/* The faces first .. end - 1 are inside the border. */
struct dt_region_range {
    uint32_t first, end;
    uint32_t region; /* its index */
    uint32_t most;   /* the largest end in the part of the array around it: see dt_regions_of */
};

/* Start with {0}. */
struct dt_regions {
    bool current;                  /* else it is empty */
    struct dt_region *region;      /* owns n, by number; triangles are not counted */
    struct dt_region_range *range; /* owns: of closed regions, by first */
    uint32_t *sorted;              /* owns: the ranges by region, then by first, */
    uint32_t *start;               /* owns: and where those of a region begin; of n + 1 regions */
    bool *inside;                  /* owns: of every face, whether it is in a region */
    uint32_t n, ranges, faces;
    double area; /* of all that is inside */
};

void dt_regions_clear(struct dt_regions *r);
size_t dt_regions_memory(const struct dt_regions *r);

/* Makes *r, which is empty, the regions of the borders, and gives the triangles their faces; there are two vertices or
 * more. If it fails, faces mean nothing. Cost: the edges of borders, and the triangles. */
enum dt_status dt_regions_survey(struct dt_regions *r, struct dt_mesh *m, const struct dt_points *p,
                                 const struct dt_declared *d, struct dt_stop *work);

/* The same if all constraints are parts of one border: dt_is_one_border, which costs a pass over them. Then two faces are enough. */
bool dt_is_one_border(const struct dt_declared *d);
enum dt_status dt_regions_survey_one(struct dt_regions *r, struct dt_mesh *m,
                                     const struct dt_points *p, const struct dt_declared *d,
                                     struct dt_stop *work);

/* Whether faces and ranges, which are current, are those of the borders. Face 0, the face of the ghosts, must be in no region.
 * Faces on both sides of an edge must differ by its borders. Out of memory, true. */
bool dt_regions_hold(const struct dt_regions *r, const struct dt_mesh *m, const struct dt_points *p,
                     const struct dt_declared *d);

/* The region of the number, NULL if there is none. */
const struct dt_region *dt_regions_find(const struct dt_regions *r, uint32_t number);

/* Writes the indices of the regions that the face is in, in no order, as many as there is room for. Returns how many there
 * are. Cost: the logarithm of the ranges for each. */
uint32_t dt_regions_of(const struct dt_regions *r, uint32_t face, uint32_t *out, uint32_t room);

/* Whether the face is in the region, which is an index. Cost: the logarithm of its ranges. */
bool dt_regions_has(const struct dt_regions *r, uint32_t region, uint32_t face);

/* The inside of one region, or of any: DT_NONE. */
struct dt_enclosure {
    const struct dt_regions *regions; /* borrows until borders change */
    uint32_t region;
};

static inline bool dt_encloses(const struct dt_enclosure *e, uint32_t face)
{
    return e->region == DT_NONE ? e->regions->inside[face]
                                : dt_regions_has(e->regions, e->region, face);
}
