/* locate.h - where a place lies in the mesh: a hint from the grid, then a short exact walk. */
#pragma once

#include "core/set/set.h"

#include <math.h>

/* Finds where q->at lies in the mesh of a set of at least two vertices. *half becomes
 *
 *   DT_INSIDE     a half edge of the triangle around it
 *   DT_ON_EDGE    the half edge that it is on (all points on one line: the half edge of a ghost)
 *   DT_ON_VERTEX  a half edge that leaves the vertex
 *   DT_OUTSIDE    a ghost beyond whose edge it lies
 *
 * If all points are on one line and the place is outside, *half is a ghost. A place on that line gets a ghost whose
 * corner 0 is the next end of the line, any other place gets any ghost. Exact. Prefetches the ids that a caller will
 * probably read. A half edge q->near saves most of the way; the answer does not depend on it. Cost: constant expected. */
enum dt_where dt_find(const struct dt *t, const struct dt_place *q, uint32_t *half);

/* The same for a place near which no half edge is known, without prefetching ids; *steps: about how many triangles the walk
 * passed, which shows whether edits have degraded the grid. */
enum dt_where dt_find_counting(const struct dt *t, struct dt_point q, uint32_t *half,
                               uint32_t *steps);

/* The same from a half edge of the caller's choice. Cost: the number of triangles between. */
enum dt_where dt_walk(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                      struct dt_point q, uint32_t *half);

/* The same over at most *steps triangles, which it subtracts from *steps; some points are not on the line of others. False: it has not
 * arrived, and *half is a half edge on the way. */
bool dt_walk_within(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                    struct dt_point q, uint32_t *steps, uint32_t *half);

/* ---- for walks, one by one and side by side (prefetch.h) ----
 *
 *              c           A walk towards q has come to the half edge h, from a to b, which q is not to the right of. It goes
 *             / \          on through b-c or c-a, or it has arrived. It keeps what q sees of an edge, so that a step
 *            /   \         computes only what c adds.
 *           a --- b
 *              h */
struct dt_way {
    struct dt_point a, b; /* relative to q */
    uint32_t h;
};

static inline struct dt_point dt_way_see(struct dt_point p, struct dt_point q)
{
    return (struct dt_point){p.x - q.x, p.y - q.y};
}

/* > 0 if q is to the left of the edge from a to b, rounded as by dt_orient2d_rounded; adds to *size. */
static inline double dt_way_side(struct dt_point a, struct dt_point b, double *size)
{
    double left = a.x * b.y, right = a.y * b.x;
    *size += fabs(left) + fabs(right);
    return left - right;
}

/* Crosses b-c, or else c-a, of the triangle whose third corner is c. */
static inline void dt_way_cross(const struct dt_mesh *m, struct dt_way *w, struct dt_point c,
                                bool bc)
{
    w->h = dt_twin(m, bc ? dt_next(w->h) : dt_prev(w->h));
    if (bc)
        w->a = c;
    else
        w->b = c;
}
