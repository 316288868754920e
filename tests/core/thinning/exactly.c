/* exactly.c - see exactly.h. */
#include "tests/core/thinning/exactly.h"

#include "core/exact/bignum.h"

#include <math.h>
#include <stdbool.h>

static void big_cross(struct dt_point o, struct dt_point a, struct dt_point b, struct dt_big *r)
{
    struct dt_big ax, ay, bx, by;
    ax = dt_big_difference(a.x, o.x);
    ay = dt_big_difference(a.y, o.y);
    bx = dt_big_difference(b.x, o.x);
    by = dt_big_difference(b.y, o.y);
    ax = dt_big_multiply(ax, by);
    ay = dt_big_multiply(ay, bx);
    *r = dt_big_subtract(ax, ay);
}

/* *sum / *all is the distance; the weights are areas, or on a line lengths. */
static void exact_off(const struct corner *k, int corners, struct dt_point q, double z,
                      struct dt_big *sum, struct dt_big *all)
{
    struct dt_big w, term;
    *sum = dt_big_of(0);
    *all = dt_big_of(0);
    for (int i = 0; i < corners; i++) {
        const struct corner *a = &k[(i + 1) % corners], *b = &k[(i + 2) % corners];
        bool by_x = k[0].at.x != k[1].at.x;
        if (corners == 3)
            big_cross(q, a->at, b->at, &w);
        else
            w = dt_big_difference(by_x ? a->at.x : a->at.y, by_x ? q.x : q.y);
        if (corners == 2 && i == 1)
            w.sign = -w.sign;
        *all = dt_big_add(*all, w);
        term = dt_big_difference(k[i].z, z);
        term = dt_big_multiply(term, w);
        *sum = dt_big_add(*sum, term);
    }
    all->sign = all->sign == 0 ? 0 : 1;
    sum->sign = sum->sign == 0 ? 0 : 1;
}

int exact_side(const struct corner *k, int corners, struct dt_point q, double z, double bound)
{
    struct dt_big sum, all, term;
    exact_off(k, corners, q, z, &sum, &all);
    term = dt_big_of(bound);
    term = dt_big_multiply(term, all);
    return dt_big_compare(sum, term);
}

double nearest_off(const struct corner *k, int corners, struct dt_point q, double z)
{
    struct dt_big sum, all;
    exact_off(k, corners, q, z, &sum, &all);
    sum = dt_big_divide(sum, all);
    return dt_big_nearest(sum);
}

double rounded_off(const struct corner *k, int corners, struct dt_point q, double z)
{
    double bx = k[1].at.x - k[0].at.x, by = k[1].at.y - k[0].at.y, bz = k[1].z - k[0].z;
    double dx = 0, dy = 0;
    if (corners == 2 && bx != 0)
        dx = bz / bx;
    else if (corners == 2)
        dy = bz / by;
    else {
        double cx = k[2].at.x - k[0].at.x, cy = k[2].at.y - k[0].at.y, cz = k[2].z - k[0].z;
        double bb = bx * bx + by * by, cc = cx * cx + cy * cy, area = bx * cy - by * cx;
        double ratio = (bb > cc ? bb : cc) / area;
        bool thin = !(ratio > 0 && ratio < 0x1p30);
        if (thin && (bz != 0 || cz != 0))
            return nearest_off(k, corners, q, z);
        if (bz != 0 || cz != 0) {
            dx = (bz * cy - cz * by) / area;
            dy = (cz * bx - bz * cx) / area;
        }
    }
    return fabs(k[0].z + (dx * (q.x - k[0].at.x) + dy * (q.y - k[0].at.y)) - z);
}
