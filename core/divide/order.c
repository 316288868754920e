/* order.c - grid order by counting sort; see order.h. */
#include "core/divide/order.h"

#include <math.h>

#include "core/divide/small_sort.h"
#include "core/memory/sort.h"

#define MAX_BITS 24
#define SAMPLE 16  /* points, of a range of */
#define SAMPLED 64 /* points at least */

/* Returns how many of `bits` bits go to x so that cells are nearly square. */
static uint32_t bits_of_x(uint32_t bits, double width, double height)
{
    if (width == 0)
        return 0;
    if (height == 0)
        return bits;
    double wanted = floor((bits + log2(width / height)) / 2 + 0.5);
    return wanted < 0 ? 0 : wanted > bits ? bits : (uint32_t)wanted;
}

/* Decides from the top bit down which side each bit of the key cuts. */
static void choose_axes(struct dt_order *o, uint32_t x_bits, double width, double height)
{
    uint32_t y_bits = o->bits - x_bits;
    for (uint32_t s = o->bits; s-- > 0;) {
        bool cut_x = y_bits == 0 || (x_bits > 0 && width >= height);
        o->axis[s] = !cut_x;
        if (cut_x) {
            x_bits--;
            width /= 2;
        } else {
            y_bits--;
            height /= 2;
        }
    }
}

/* part[i] for i < count: the bits of i, moved to those positions of the key that cut the axis. */
static void spread_bits(const struct dt_order *o, unsigned axis, uint32_t count, uint32_t *part)
{
    part[0] = 0;
    uint32_t known = 1;
    for (uint32_t s = 0; s < o->bits && known < count; s++) {
        if (o->axis[s] != axis)
            continue;
        for (uint32_t i = 0; i < known; i++)
            part[known + i] = part[i] | 1u << s;
        known *= 2;
    }
}

/* How far the points of a sample lie off the line through their two neighbours along the longer side of
 * the box, on average; HUGE_VAL if they jump across it. */
static double roughness(const struct dt_point *p, uint32_t n, bool along_x)
{
    double u[SAMPLE], v[SAMPLE], along[SAMPLE], across[SAMPLE], sum = 0;
    uint32_t rank[SAMPLE], jumps = 0;
    uint64_t random = n;
    for (uint32_t i = 0; i < SAMPLE; i++) {
        struct dt_point q = p[dt_random_below(&random, n)];
        u[i] = along_x ? q.x : q.y;
        v[i] = along_x ? q.y : q.x;
    }
    dt_rank(u, SAMPLE, rank);
    for (uint32_t i = 0; i < SAMPLE; i++) {
        along[rank[i]] = u[i];
        across[rank[i]] = v[i];
    }
    for (uint32_t i = 1; i + 1 < SAMPLE; i++) {
        double gap = along[i + 1] - along[i - 1];
        double part = gap > 0 ? (along[i] - along[i - 1]) / gap : 0;
        double off = fabs(across[i] - across[i - 1] - part * (across[i + 1] - across[i - 1]));
        sum += off;
        jumps += off > gap;
    }
    return jumps > SAMPLE / 4 ? HUGE_VAL : sum / (SAMPLE - 2);
}

/* Points along a curve leave most cells of a grid empty and crowd the others. Returns the number of strips across the
 * longer side of the box that can replace the cells; 0 if that gains little. Strips are no narrower than the curve is
 * thick. */
static double strips_of(struct dt_box box, double cells, const struct dt_point *p, uint32_t n)
{
    if (n < SAMPLED)
        return 0;
    double width = dt_box_width(&box), height = dt_box_height(&box);
    double length = fmax(width, height), thickness = 2 * roughness(p, n, width >= height);
    double strips = thickness * cells > length ? length / thickness : cells;
    double side = sqrt(cells * length / fmin(width, height)); /* of a grid, in cells */
    return strips > 2 * side ? strips : 0;
}

void dt_order_plan(struct dt_order *o, struct dt_box box, double cells, const struct dt_point *p,
                   uint32_t n)
{
    double width = dt_box_width(&box), height = dt_box_height(&box);
    double strips = strips_of(box, cells, p, n), parts = strips > 0 ? strips : cells;
    double bits = floor(log2(parts < 4 ? 4 : parts) + 0.5);
    o->bits = bits > MAX_BITS ? MAX_BITS : (uint32_t)bits;
    uint32_t x_bits = bits_of_x(o->bits, width, height);
    if (strips > 0)
        x_bits = width >= height ? o->bits : 0;
    o->columns = 1u << x_bits;
    o->rows = 1u << (o->bits - x_bits);
    o->lo = box.lo;
    o->per_x = width > 0 ? o->columns / width : 0;
    o->per_y = height > 0 ? o->rows / height : 0;
    choose_axes(o, x_bits, width, height);
    o->column = o->row = NULL;
}

enum dt_status dt_order_tables(struct dt_order *o, struct dt_arena *arena)
{
    o->column = dt_arena_take(arena, o->columns, sizeof *o->column);
    o->row = dt_arena_take(arena, o->rows, sizeof *o->row);
    if (o->column == NULL || o->row == NULL)
        return DT_NOMEM;
    spread_bits(o, 0, o->columns, o->column);
    spread_bits(o, 1, o->rows, o->row);
    return DT_OK;
}

void dt_order_count(const struct dt_order *o, const struct dt_point *p, uint32_t n, uint32_t *key,
                    uint32_t *counts)
{
    const struct dt_order order = *o; /* a copy that the stores below cannot be thought to change */
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = dt_order_key(&order, p[i]);
        key[i] = k;
        counts[k]++;
    }
}

void dt_order_scatter(const uint32_t *key, uint32_t n, uint32_t *next, const struct dt_point *p,
                      const uint32_t *from, uint32_t first, struct dt_point *out,
                      uint32_t *out_from)
{
    if (from == NULL) {
        for (uint32_t i = 0; i < n; i++) {
            uint32_t to = next[key[i]]++;
            out[to] = p[i];
            out_from[to] = first + i;
        }
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t to = next[key[i]]++;
        out[to] = p[i];
        out_from[to] = from[i];
    }
}
