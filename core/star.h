/* star.h - the neighbours of vertices, as ids, one by one or many at once.
 *
 * A star is read counterclockwise: that of an interior vertex from anywhere, that of a hull vertex
 * from its successor on the hull to its predecessor. The mesh must be settled (core/hull.h). */
#ifndef DT_STAR_H
#define DT_STAR_H

#include "core/set.h"

enum { DT_STARS = 64, DT_STAR_MAX = 20 };

/* Stars of consecutive representatives. */
struct dt_stars {
    uint32_t n;
    uint32_t id[DT_STARS], vertex[DT_STARS];
    uint32_t degree[DT_STARS]; /* DT_NONE: more than DT_STAR_MAX, the ring was not read */
    bool on_hull[DT_STARS];
    uint32_t ring[DT_STARS][DT_STAR_MAX];
};

/* Reads the stars of the first representatives whose ids are >= id and < end, at most max of them.
 * Far faster than one by one, because the cache misses of all of them run at once. */
void dt_stars_read(const struct dt *t, uint32_t id, uint32_t end, uint32_t max, struct dt_stars *s);

/* How many neighbours v has, `limit` if it has more. */
uint32_t dt_star_degree(const struct dt_mesh *m, uint32_t v, uint32_t limit);

/* Their ids into ring[degree]. */
void dt_star_ring(const struct dt *t, uint32_t v, uint32_t *ring);

#endif
