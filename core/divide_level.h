/* divide_level.h - one grid of the divide engine over one range of points: sorted, by one thread or
 * by several.
 *
 * What divide.c and divide_tasks.c share. */
#ifndef DT_DIVIDE_LEVEL_H
#define DT_DIVIDE_LEVEL_H

#include "core/few.h"
#include "core/merge.h"
#include "core/order.h"
#include "core/parallel.h"
#include "core/plan.h"
#include "core/stop.h"

#define DT_POINTS_PER_CELL 2.0
#define DT_TILE 8192u /* points of a tile, which fits the second-level cache with its triangles */
#define DT_TILED (1u << 18) /* ranges of more points than this are sorted into tiles first */
#define DT_ZOOMS 3u         /* useless grids in a row before a range is cut at its median */

/* A whole build. A range [lo, hi) of p and from, which are the result, belongs to the thread that works on
 * that range, as do the mesh's records 2 lo .. 2 hi - 1. */
struct dt_division {
    struct dt_merging merging; /* p and the mesh */
    struct dt_point *p;
    uint32_t *from;
    uint32_t n;
    const struct dt_options *opt;
    struct dt_plan plan;   /* with steps: the points are only sorted, and this is recorded */
    struct dt_named spare; /* then scratch for n points */
    struct dt_stop stop;   /* asked every few thousand points */
    atomic_uint finished;  /* points of finished tiles, for progress */
};

/* Scratch for n points from lo on and their names: at either end of the range's records of the mesh, 64
 * bytes a point, which no merge has written yet; without a mesh, the spare arrays. */
static inline struct dt_named dt_aside(const struct dt_division *d, uint32_t lo, uint32_t n)
{
    uint32_t *half = d->merging.mesh->half;
    if (d->plan.step != NULL)
        return (struct dt_named){d->spare.p + lo, d->spare.from + lo};
    return (struct dt_named){(void *)(half + 16 * (size_t)lo), half + 16 * ((size_t)lo + n) - n};
}

struct dt_level {
    struct dt_order order;
    uint32_t *start; /* borrows from the arena: cell c holds vertices lo + start[c] .. lo + start[c
                        + 1] - 1 */
    uint32_t lo;
    bool tiles;          /* put aside by tiles, each to be sorted again; else sorted into p */
    unsigned skew;       /* grids in a row of which one cell held more than half */
    struct dt_part done; /* points that are sorted to the end, and are in no cell */
};

/* The n vertices from lo on, which are one cell or more of the level. */
static inline struct dt_source
dt_level_source(const struct dt_division *d, const struct dt_level *level, uint32_t lo, uint32_t n)
{
    struct dt_named aside = dt_aside(d, lo, n);
    return level->tiles ? (struct dt_source){aside.p, aside.from}
                        : (struct dt_source){d->p + lo, d->from + lo};
}

enum dt_opening {
    DT_LEVEL_OPEN,
    DT_LEVEL_SKEWED, /* no grid helps: cut at the median */
    DT_LEVEL_FAILED  /* division.stop says why */
};

/* Sorts the points src[0 .. n-1], n > DT_BLOCK, to vertices lo .. lo + n - 1 by a new grid. src may be
 * aside, p + lo (then it is copied first), or anything that overlaps with neither. Up to `threads` threads
 * of the pool share the work. The level lives in the arena. Where points are only sorted, those at one place and
 * those that no grid helps are sorted to the end; the level has no cells with points then. */
enum dt_opening dt_level_open(struct dt_division *d, struct dt_arena *arena, unsigned threads,
                              struct dt_source src, uint32_t lo, uint32_t n, unsigned skew,
                              struct dt_level *level);

/* Brings the points to p[lo ..] and partitions them so that the first n / 2 precede the others by
 * (x, y) or (y, -x); returns the axis, and the points at the median's place (median.h). n > 0. Cost: O(n). */
struct dt_piece dt_level_median(struct dt_division *d, struct dt_source src, uint32_t lo,
                                uint32_t n, unsigned *axis);

/* Points src[0 .. n-1], n > 0, become the vertices lo .. lo + n - 1 and are triangulated. */
struct dt_part dt_divide_range(struct dt_division *d, struct dt_arena *arena, struct dt_source src,
                               uint32_t lo, uint32_t n, unsigned skew);

/* Triangulates the vertices of a level whose key starts with `key`, with s bits to go. */
struct dt_part dt_divide_cells(struct dt_division *d, struct dt_arena *arena,
                               const struct dt_level *level, uint32_t key, uint32_t s);

/* The vertices lo .. *hi - 1 of that range. */
static inline uint32_t dt_level_range(const struct dt_level *level, uint32_t key, uint32_t s,
                                      uint32_t *hi)
{
    *hi = level->lo + level->start[((size_t)key + 1) << s];
    return level->lo + level->start[(size_t)key << s];
}

/* Joins two neighbouring parts, or records that it has to be done. */
static inline struct dt_part dt_divide_join(struct dt_division *d, const struct dt_part *a,
                                            const struct dt_part *b, unsigned axis, uint32_t mid)
{
    if (d->plan.step != NULL)
        return dt_plan_join(&d->plan, a, b, axis);
    return dt_merge_parts(&d->merging, a, b, axis, mid);
}

/* Triangulates all of d->n points on `threads` threads of the pool; returns the part that holds
 * them. */
struct dt_part dt_divide_tasks(struct dt_division *d, struct dt_source in, unsigned threads);

#endif
