/* part.h - the triangulation of a range of points, which is a part of a larger one.
 *
 * Merges allocate nothing: n points always have 2n - 2 triangles, ghosts included (mesh.h), so a range
 * [lo, hi) of the points owns the records 2 lo .. 2 hi - 3 when it is triangulated, and a merge of
 * [lo, mid) and [mid, hi) adds the two records 2 mid - 2 and 2 mid - 1. */
#ifndef DT_PART_H
#define DT_PART_H

#include "core/control/stop.h"
#include "core/mesh/mesh.h"

/* What merges work on. The mesh's records 2 lo .. 2 hi - 1 and leaving[lo .. hi) belong to the thread that
 * works on the range [lo, hi), so that ranges that do not overlap may be worked on at the same
 * time. leaving[v] is always a half edge that leaves v; of a hull vertex it is mostly the ghost that
 * starts there, on a line possibly a former triangle. */
struct dt_merging {
    const struct dt_point *p; /* borrowed, by vertex */
    struct dt_mesh *mesh;     /* borrowed; only half[] and leaving[] are used */
    struct dt_stop *stop;     /* borrowed; asked during long merges; NULL: never stopped */
};

/* The triangulation of a range of n > 0 points, or n = 0. */
struct dt_part {
    uint32_t n;
    uint32_t left, right; /* lexicographically smallest and greatest vertex */
    uint32_t bottom, top; /* smallest and greatest by (y, -x) */
    uint32_t ghost;       /* some ghost; unset if n = 1 */
    bool close;           /* merges with it should use the close filter (sight.h) */
};

/* The orders that axes 0 and 1 stand for; the second is the first with the plane turned by a right
 * angle. No branch, since it would be unpredictable. */
static inline bool dt_before_x(struct dt_point a, struct dt_point b)
{
    return (a.x < b.x) | ((a.x == b.x) & (a.y < b.y));
}

static inline bool dt_before_y(struct dt_point a, struct dt_point b)
{
    return (a.y < b.y) | ((a.y == b.y) & (a.x > b.x));
}

#endif
