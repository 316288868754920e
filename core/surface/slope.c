/* slope.c - the gradient of the linear surface, its steepness and its direction, at a place that has been found in the mesh. */
#include "core/exact/degrees.h"
#include "core/query/query.h"
#include "core/surface/value.h"

#include <math.h>

/* Makes *best the triangle of the half edge if that has a surface and comes first in DT_TRIANGLES; best: DT_NONE for none. */
static void offer(struct dt_valuer *v, uint32_t half, uint32_t *best)
{
    if (dt_has_surface(v, half) && (*best == DT_NONE || dt_triangle_precedes(v->t, half, *best)))
        *best = dt_base(half);
}

static enum dt_status first_around(struct dt_valuer *v, uint32_t half, uint32_t *best)
{
    enum dt_status s = DT_OK;
    uint32_t h = half;
    do {
        s = dt_work(&v->work, 1);
        offer(v, h, best);
        h = dt_turn_ccw(&v->t->mesh, h);
    } while (s == DT_OK && h != half);
    return s;
}

/* The triangle that counts at the place: *base, DT_NONE if there is none. */
static enum dt_status first_triangle(struct dt_valuer *v, enum dt_where where, uint32_t half,
                                     uint32_t *base)
{
    *base = DT_NONE;
    if (half == DT_NONE || where == DT_OUTSIDE)
        return DT_OK;
    if (where == DT_ON_VERTEX)
        return first_around(v, half, base);
    offer(v, half, base);
    if (where == DT_ON_EDGE)
        offer(v, dt_twin(&v->t->mesh, half), base);
    return DT_OK;
}

static struct dt_gradient gradient_in(const struct dt_valuer *v, uint32_t base)
{
    const uint32_t *corner = v->t->mesh.half + base;
    const struct dt_point *xy = v->t->points.xy;
    const struct dt_point p[] = {xy[corner[0]], xy[corner[1]], xy[corner[2]]};
    const double z[] = {dt_value_of(v, corner[0]), dt_value_of(v, corner[1]),
                        dt_value_of(v, corner[2])};
    if (isnan(z[0]) || isnan(z[1]) || isnan(z[2]))
        return (struct dt_gradient){(double)NAN, (double)NAN};
    return dt_gradient_of(p, z);
}

/* Places in one triangle usually follow each other, so its numbers are kept. */
static void measure(struct dt_valuer *v, uint32_t base)
{
    struct dt_gradient g = gradient_in(v, base);
    v->sloped = base;
    v->sloped_of = v->s;
    v->slope[0] = v->s->quantity == DT_SLOPE    ? dt_degrees_steep(g.dx, g.dy)
                  : v->s->quantity == DT_ASPECT ? dt_degrees_downhill(g.dx, g.dy)
                                                : g.dx;
    v->slope[1] = g.dy;
}

enum dt_status dt_slope_at(struct dt_valuer *v, enum dt_where where, uint32_t half, double *out)
{
    uint32_t base, n = dt_surface_numbers(v->s);
    enum dt_status s = first_triangle(v, where, half, &base);
    if (s == DT_OK && base != DT_NONE && (base != v->sloped || v->s != v->sloped_of))
        measure(v, base);
    for (uint32_t i = 0; i < n; i++)
        out[i] = base == DT_NONE ? (double)NAN : v->slope[i];
    return s;
}
