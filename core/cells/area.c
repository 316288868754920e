/* area.c - areas of polygons, two at a time.
 *
 * The sum over the corners, as the first one sees them, is a chain of additions of double words, each waiting for the one
 * before. So two polygons are in the two lanes of a vector. The shorter polygon continues with copies of its first corner,
 * which add zero. */
#include "core/delaunay_surface.h"
#include "core/exact/lanes2.h"

/* The corners of two polygons, one in each lane. */
struct pair {
    const struct dt_point *corner[2];
    size_t n[2];
};

static struct dt_lanes2 minus(struct dt_lanes2 a)
{
    return (struct dt_lanes2){-a.hi, -a.lo};
}

static dt_lanes areas_of(const struct pair *p)
{
    static const struct dt_point none = {0, 0};
    const struct dt_point *first[2], *next[2];
    size_t longest = p->n[0] > p->n[1] ? p->n[0] : p->n[1];
    for (int k = 0; k < 2; k++)
        first[k] = p->n[k] > 0 ? p->corner[k] : &none;
    dt_lanes x = {first[0]->x, first[1]->x}, y = {first[0]->y, first[1]->y};
    struct dt_lanes2 sum = {dt_lanes_both(0), dt_lanes_both(0)}, ax = sum, ay = sum;
    struct dt_lanes2 ax_split = sum, ay_split = sum;
    for (size_t i = 1; i < longest; i++) {
        for (int k = 0; k < 2; k++)
            next[k] = i < p->n[k] ? p->corner[k] + i : first[k];
        struct dt_lanes2 bx = dt_lanes2_sum((dt_lanes){next[0]->x, next[1]->x}, -x);
        struct dt_lanes2 by = dt_lanes2_sum((dt_lanes){next[0]->y, next[1]->y}, -y);
        struct dt_lanes2 bx_split = dt_lanes2_split(bx.hi), by_split = dt_lanes2_split(by.hi);
        if (i > 1) {
            sum = dt_lanes2_add(sum, dt_lanes2_multiply(ax, ax_split, by, by_split));
            sum = dt_lanes2_add(sum, minus(dt_lanes2_multiply(ay, ay_split, bx, bx_split)));
        }
        ax = bx;
        ay = by;
        ax_split = bx_split;
        ay_split = by_split;
    }
    return sum.hi / 2 + 0.0;
}

double dt_polygon_area(const struct dt_point *corner, size_t n)
{
    return areas_of(&(struct pair){{corner, corner}, {n, 0}})[0];
}

void dt_cell_areas(const struct dt_cell *cell, size_t n, const struct dt_point *corner,
                   double *area)
{
    for (size_t i = 0; i + 1 < n; i += 2) {
        const struct dt_point *other = corner + cell[i].corners;
        struct pair p = {{corner, other}, {cell[i].corners, cell[i + 1].corners}};
        dt_lanes both = areas_of(&p);
        area[i] = both[0];
        area[i + 1] = both[1];
        corner = other + cell[i + 1].corners;
    }
    if (n % 2 == 1)
        area[n - 1] = dt_polygon_area(corner, cell[n - 1].corners);
}
