/* samples.h - the points that are thinned out, in an order in which neighbours in the plane are neighbours in memory, and
 * blocks of them.
 *
 * A block of level 1 has sixteen points, a block of level k four blocks of the level below, the last one perhaps fewer; points are
 * level 0. As the points are in Morton order, blocks are small in the plane, too. A block within one triangle stands for all of its points.
 * Often its box and its range of values show that none of its points can be the worst point of the triangle, or that all of
 * them are on the same side of a new edge. */
#pragma once

#include "core/control/stop.h"
#include "core/delaunay_thinning.h"
#include "core/exact/predicates.h"

#include <math.h>

/* Half a cache line. */
struct dt_sample {
    struct dt_point at;
    double z;       /* nan: it has no value */
    uint64_t index; /* in the arrays of the caller */
};

/* A point rounded to floats: as seen from the middle of all points and of the range of all values, in units that make all
 * three at most 1. Four are in a cache line. */
struct dt_rounded {
    float x, y, z;
    uint32_t item; /* its number; or in a list the item of a block, which has no place */
};

/* The box of its points, from its middle to its sides, and the range of their values, nan if a point has no value. */
struct dt_bunch {
    struct dt_point at;
    double width, height;
    double least, most;
};

enum { DT_BLOCK_LEVELS = 14, DT_BLOCK_POINTS = 16, DT_BLOCK_PARTS = 4 };

struct dt_samples {
    struct dt_sample *v;        /* owns n, in Morton order */
    struct dt_rounded *rounded; /* owns n: the same */
    uint32_t n;
    double largest;         /* magnitude of a value */
    struct dt_point middle; /* see struct dt_rounded, as the next three */
    double middle_value;
    double per_length, per_value; /* powers of two */
    struct dt_bunch *block;       /* owns: those of level 1, then of level 2, and so on */
    uint32_t start[DT_BLOCK_LEVELS + 1], count[DT_BLOCK_LEVELS + 1]; /* by level; count[0]: n */
    uint32_t levels;                                                 /* the highest one */
};

/* A block or a point, by its level and its number there. */
static inline uint32_t dt_item_of(uint32_t level, uint32_t number)
{
    return level << 28 | number;
}

static inline uint32_t dt_item_level(uint32_t item)
{
    return item >> 28;
}

static inline uint32_t dt_item_number(uint32_t item)
{
    return item & ((1u << 28) - 1);
}

static inline const struct dt_bunch *dt_item_block(const struct dt_samples *s, uint32_t item)
{
    return &s->block[s->start[dt_item_level(item)] + dt_item_number(item)];
}

/* On which side of a line from p all of a block is, strictly: 1, to the left, or -1; 0: that is in doubt. The line has the direction
 * `way`, which is a rounded difference of places. */
static inline int dt_block_side(const struct dt_bunch *b, struct dt_point p, struct dt_point way)
{
    const double left = way.x * (b->at.y - p.y), right = way.y * (b->at.x - p.x);
    const double reach = fabs(way.x) * b->height + fabs(way.y) * b->width;
    const double doubt = reach * (1 + 0x1p-48) + DT_ORIENT_BOUND * (fabs(left) + fabs(right));
    return (left - right > doubt) - (left - right < -doubt);
}

/* 1: all points of a block come after p in lexicographic order, -1: before p; 0: that is in doubt. */
static inline int dt_block_order(const struct dt_bunch *b, struct dt_point p)
{
    const int x = (b->at.x - b->width > p.x) - (b->at.x + b->width < p.x);
    const int y = (b->at.y - b->height > p.y) - (b->at.y + b->height < p.y);
    return b->width > 0 || b->at.x != p.x ? x : y;
}

/* The parts of a block: *first and those that follow. Returns how many they are. */
static inline uint32_t dt_item_parts(const struct dt_samples *s, uint32_t item, uint32_t *first)
{
    const uint32_t level = dt_item_level(item) - 1;
    const uint32_t parts = level == 0 ? DT_BLOCK_POINTS : DT_BLOCK_PARTS;
    const uint32_t number = parts * dt_item_number(item), left = s->count[level] - number;
    *first = dt_item_of(level, number);
    return left < parts ? left : parts;
}

/* DT_NOMEM, DT_CANCELLED; to be cleared in any case. Cost: O(n), and 16 bytes for each meanwhile. */
enum dt_status dt_samples_init(struct dt_samples *s, const struct dt_thinning *in,
                               struct dt_stop *stop);
void dt_samples_clear(struct dt_samples *s);

/* The bytes that n of them take at most. */
size_t dt_samples_memory(uint32_t n);
