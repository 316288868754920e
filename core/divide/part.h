/* part.h - the triangulation of a range of points, which is a part of a larger one: made of a few points (block.c), or of two
 * neighbouring parts (merge.c).
 *
 * Merges allocate nothing. n points always have 2n - 2 triangles, ghosts included (mesh.h). So a triangulated range
 * [lo, hi) of the points owns the records 2 lo .. 2 hi - 3. A merge of [lo, mid) and [mid, hi) adds the two records
 * 2 mid - 2 and 2 mid - 1. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/bounds.h"
#include "core/mesh/mesh.h"

#define INLINE static inline __attribute__((always_inline))

#define DT_BLOCK 6u /* points of the largest block */

/* The arrays that merges work on. The records 2 lo .. 2 hi - 1 of the mesh and leaving[lo .. hi) belong to the thread
 * that works on the range [lo, hi). So threads may work on disjoint ranges at the same time. leaving[v] is always a half
 * edge that leaves v. For a hull vertex it is usually the ghost that starts at v; if all points lie on one line, it may
 * be a half edge of a former triangle. */
struct dt_merging {
    const struct dt_point *p;    /* borrowed, by vertex */
    uint32_t *half, *leaving;    /* borrowed: those of the mesh */
    struct dt_stop *stop;        /* borrowed; asked during long merges; NULL: never stopped */
    struct dt_wide_bounds bound; /* of one merge: below these, signs are uncertain */
};

/* The triangulation of a range of n > 0 points, or n = 0. */
struct dt_part {
    uint32_t n;
    uint32_t left, right; /* lexicographically smallest and greatest vertex */
    uint32_t bottom, top; /* smallest and greatest by (y, -x) */
    uint32_t ghost;       /* some ghost; unset if n = 1 */
    bool close;           /* merges with it should use the close filter (sight.h) */
};

/* Triangulates the vertices lo .. lo + n - 1, 0 < n <= DT_BLOCK, which are in order of (x, y). */
struct dt_part dt_block(const struct dt_merging *w, uint32_t lo, uint32_t n);

/* Joins a and b, the parts of [lo, mid) and [mid, hi). Every point of a precedes every point of b,
 * by (x, y) if axis is 0, by (y, -x) if it is 1. If the merge is stopped, it returns a part of no points, and the mesh
 * of the range is undefined. */
struct dt_part dt_merge_parts(const struct dt_merging *w, const struct dt_part *a,
                              const struct dt_part *b, unsigned axis, uint32_t mid);

/* Joins the nl vertices before mid, of which l is the last one along the cut, with the nr vertices from mid on, of
 * which r is the first one. The parts have the ghosts some_l and some_r; a part of one vertex has none. The ghosts of
 * the two new hull edges are the records 2 mid - 2 and 2 mid - 1. `close`: use the close filter. Returns whether the
 * next merge of the result should use it. A merge of many points polls, and ends early if it is stopped. */
bool dt_knit(const struct dt_merging *w, bool close, uint32_t l, uint32_t r, uint32_t nl,
             uint32_t nr, uint32_t some_l, uint32_t some_r, uint32_t mid);

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

static inline struct dt_merging dt_merging_of(const struct dt_point *p, const struct dt_mesh *m,
                                              struct dt_stop *stop)
{
    return (struct dt_merging){.p = p, .half = m->half, .leaving = m->leaving, .stop = stop};
}

/* The same for one merge, where `side` is the longer side of the box of all points concerned. */
INLINE struct dt_merging dt_merging_within(const struct dt_merging *w, double side)
{
    return (struct dt_merging){w->p, w->half, w->leaving, w->stop, dt_wide_bounds_of(side)};
}

/* ---- the basic operations of a merge ----
 *
 * Half edges are size_t in here, although they have 32 bits: h + 4 is then part of an address, and
 * no sum has to be cut to 32 bits first. */

INLINE void knit_link(const struct dt_merging *w, size_t h, size_t twin)
{
    w->half[h + 4] = (uint32_t)twin;
    w->half[twin + 4] = (uint32_t)h;
}

INLINE size_t knit_twin(const struct dt_merging *w, size_t h)
{
    return w->half[h + 4];
}

INLINE void knit_triangle(const struct dt_merging *w, size_t t, uint32_t a, uint32_t b, uint32_t c)
{
    w->half[t] = a;
    w->half[t + 1] = b;
    w->half[t + 2] = c;
}

/* Makes the record at t the ghost beyond the hull edge b->a. */
INLINE void knit_ghost(const struct dt_merging *w, size_t t, uint32_t a, uint32_t b)
{
    knit_triangle(w, t, a, b, DT_NONE);
    w->leaving[a] = (uint32_t)t;
}
