/* box.h - boxes along the axes, and the cells of a uniform grid over one.
 *
 * All grids of core/ number the cells of an axis by dt_cell. It is monotone, also as it rounds, and is
 * used for points and for the limits of searches alike. So a cut between two cells is strict, and a
 * search of the cells from one limit to the other misses no point between them. */
#pragma once

#include "core/delaunay.h"

/* Of two numbers, without the rules for NaN of fmin and fmax. */
static inline double dt_lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double dt_greater(double a, double b)
{
    return a > b ? a : b;
}

/* Closed: its border belongs to it. */
struct dt_box {
    struct dt_point lo, hi;
};

/* Makes the box contain p. A NaN changes nothing. */
static inline void dt_box_add(struct dt_box *b, struct dt_point p)
{
    b->lo.x = p.x < b->lo.x ? p.x : b->lo.x;
    b->hi.x = p.x > b->hi.x ? p.x : b->hi.x;
    b->lo.y = p.y < b->lo.y ? p.y : b->lo.y;
    b->hi.y = p.y > b->hi.y ? p.y : b->hi.y;
}

/* The tight box of n > 0 points. */
static inline struct dt_box dt_box_of(const struct dt_point *p, uint32_t n)
{
    struct dt_box b = {p[0], p[0]};
    for (uint32_t i = 1; i < n; i++)
        dt_box_add(&b, p[i]);
    return b;
}

/* The smallest box that contains both. */
static inline struct dt_box dt_box_join(struct dt_box a, struct dt_box b)
{
    dt_box_add(&a, b.lo);
    dt_box_add(&a, b.hi);
    return a;
}

static inline bool dt_box_contains(const struct dt_box *b, struct dt_point p)
{
    return b->lo.x <= p.x && p.x <= b->hi.x && b->lo.y <= p.y && p.y <= b->hi.y;
}

/* Whether they have a point in common. */
static inline bool dt_box_overlaps(const struct dt_box *a, const struct dt_box *b)
{
    return a->lo.x <= b->hi.x && b->lo.x <= a->hi.x && a->lo.y <= b->hi.y && b->lo.y <= a->hi.y;
}

static inline double dt_box_width(const struct dt_box *b)
{
    return b->hi.x - b->lo.x;
}

static inline double dt_box_height(const struct dt_box *b)
{
    return b->hi.y - b->lo.y;
}

/* The axis of its longer side: 0 = x, 1 = y. */
static inline unsigned dt_box_axis(const struct dt_box *b)
{
    return dt_box_width(b) >= dt_box_height(b) ? 0 : 1;
}

static inline double dt_box_side(const struct dt_box *b)
{
    double width = dt_box_width(b), height = dt_box_height(b);
    return width > height ? width : height;
}

/* The number, below n > 0, of the cell that `at` falls into, which is a distance from the grid's lower
 * border in cells. Places beyond the grid belong to its outermost cells; a NaN belongs to the first one. No
 * branch. */
static inline uint32_t dt_cell(double at, uint32_t n)
{
    double last = n - 1;
    at = at > 0 ? at : 0;
    return (uint32_t)(at < last ? at : last);
}
