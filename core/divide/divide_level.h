/* divide_level.h - one grid of the divide engine over one range of points: sorted, by one thread or
 * by several. */
#pragma once

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/divide/order.h"
#include "core/divide/plan.h"
#include "core/divide/small_sort.h"

#define DT_POINTS_PER_CELL 2.0
#define DT_TILE 8192u /* points of a tile, which fits the second-level cache with its triangles */
#define DT_TILED (1u << 18) /* ranges of more points than this are sorted into tiles first */
#define DT_ZOOMS 3u         /* useless grids in a row before a range is cut at its median */

/* A whole sort. A range [lo, hi) of p, from and the plan, which are the result, and of the spare arrays belongs to
 * the thread that works on that range. */
struct dt_division {
    struct dt_point *p;
    uint32_t *from;
    uint32_t n;
    struct dt_plan plan;
    struct dt_named spare;  /* scratch for n points */
    struct dt_pages *pages; /* borrows; where other scratch memory comes from */
    const struct dt_options *opt;
    struct dt_stop stop; /* asked every few thousand points */
};

struct dt_level {
    struct dt_order order;
    uint32_t *start; /* borrows from the arena: cell c holds vertices lo + start[c] .. lo + start[c
                        + 1] - 1 */
    uint32_t lo;
    bool spare;    /* sorted into the spare arrays, to be sorted again from there; else into p */
    unsigned skew; /* grids in a row of which one cell held more than half */
};

/* The points from lo on, where the level has sorted them. */
static inline struct dt_source dt_level_source(const struct dt_division *d,
                                               const struct dt_level *level, uint32_t lo)
{
    return level->spare ? (struct dt_source){d->spare.p + lo, d->spare.from + lo}
                        : (struct dt_source){d->p + lo, d->from + lo};
}

enum dt_opening {
    DT_LEVEL_OPEN,
    DT_LEVEL_SKEWED, /* no grid helps: cut at the median */
    DT_LEVEL_DONE    /* all are at one place, and sorted; or division.stop says why not */
};

/* Sorts the points src[0 .. n-1], n > 0, to the places lo .. lo + n - 1 by a new grid. The source may be at lo in p or
 * in the spare arrays, or in memory that overlaps with neither. Up to `threads` threads of the pool share the work. The
 * level lives in the arena. */
enum dt_opening dt_level_open(struct dt_division *d, struct dt_arena *arena, unsigned threads,
                              struct dt_source src, uint32_t lo, uint32_t n, unsigned skew,
                              struct dt_level *level);

/* Brings the points to p[lo ..]. */
void dt_level_bring(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n);

/* Brings the points, which are not all at one place, to p[lo ..] and parts them at their median, or beside it so that
 * points at one place stay together. The first points precede the others by (x, y) if the returned axis is 0, by (y, -x)
 * if it is 1. Returns the number of first points: neither 0 nor n unless it has to stop. Cost: O(n). */
uint32_t dt_level_halve(struct dt_division *d, struct dt_source src, uint32_t lo, uint32_t n,
                        unsigned *axis);

/* The places lo .. *hi - 1 of the points of a level whose key starts with `key`, with s bits to go. */
static inline uint32_t dt_level_range(const struct dt_level *level, uint32_t key, uint32_t s,
                                      uint32_t *hi)
{
    *hi = level->lo + level->start[((size_t)key + 1) << s];
    return level->lo + level->start[(size_t)key << s];
}
