/* order.h - points into grid order: a counting sort on the cells of a uniform grid, numbered by
 * interleaving the bits of column and row.
 *
 * The interleaving always cuts the longer remaining side of the box in half, so that every prefix
 * of a cell's number stands for a box, nearly square as long as the grid allows, and holds a
 * contiguous range of the sorted points:
 *
 *        key     1xx | 11x           the first cut of this wide box is at x,
 *        +----+------+------+        the second at y, the third at x again;
 *        | 010 | 011 | 110 | 111     cells 010 and 011 make up the range 01x.
 *        | 000 | 001 | 100 | 101
 *        +-----+-----+-----+----
 *
 * The cell of a coordinate is a monotone function of it (box.h), so each cut is strict: everything on one
 * side has a smaller x (or y) than everything on the other. Divide and conquer needs no more than that from an
 * order; no coordinates are compared.
 *
 * Source: the paper's grid; alternating cuts: Dwyer 1987. */
#pragma once

#include "core/exact/box.h"
#include "core/memory/arena.h"

/* Some points in some order and their names. */
struct dt_named {
    struct dt_point *p;
    uint32_t *from;
};

/* The same, only to be read. from == NULL: the input, whose points are named by their numbers. */
struct dt_source {
    const struct dt_point *p;
    const uint32_t *from;
};

struct dt_order {
    uint32_t bits;          /* of a key; there are 1 << bits cells */
    uint32_t columns, rows; /* powers of two; columns * rows = cells */
    unsigned char axis[32]; /* what bit s of a key cuts: 0 = x, 1 = y */
    struct dt_point lo;     /* the corner of the grid */
    double per_x, per_y;    /* columns and rows per unit; 0 for a side of no length */
    uint32_t *column, *row; /* borrow from the arena: a column's and a row's part of the key */
};

/* Plans a grid of about `cells` nearly square cells, at least 4, on the box of n > 0 points. If a sample of the points
 * lies along a curve, it plans a row of about that many strips instead. */
void dt_order_plan(struct dt_order *o, struct dt_box box, double cells, const struct dt_point *p,
                   uint32_t n);

/* Makes the tables that keys are looked up in. DT_NOMEM: nothing to undo. */
enum dt_status dt_order_tables(struct dt_order *o, struct dt_arena *arena);

static inline uint32_t dt_order_key(const struct dt_order *o, struct dt_point p)
{
    return o->column[dt_cell((p.x - o->lo.x) * o->per_x, o->columns)] |
           o->row[dt_cell((p.y - o->lo.y) * o->per_y, o->rows)];
}

/* Writes n keys and adds to the counts[cells]. */
void dt_order_count(const struct dt_order *o, const struct dt_point *p, uint32_t n, uint32_t *key,
                    uint32_t *counts);

/* Writes points to their places: *next[key] is the place of the next point of that cell, and is
 * advanced. from[i] is what is written as the origin of point i; NULL: `first` + i. */
void dt_order_scatter(const uint32_t *key, uint32_t n, uint32_t *next, const struct dt_point *p,
                      const uint32_t *from, uint32_t first, struct dt_point *out,
                      uint32_t *out_from);
