/* circles.c - see circles.h. */
#include "core/surface/circles.h"

#include <stdlib.h>

enum dt_status dt_circles_init(struct dt_circles *c, uint32_t n)
{
    c->circle = malloc(n * sizeof *c->circle);
    c->mask = n - 1;
    if (c->circle == NULL)
        return DT_NOMEM;
    for (uint32_t i = 0; i < n; i++)
        c->circle[i].triangle = DT_NONE;
    return DT_OK;
}

void dt_circles_clear(struct dt_circles *c)
{
    free(c->circle);
    *c = (struct dt_circles){0};
}

void dt_circle_make(struct dt_circle *k, const struct dt *t, uint32_t triangle)
{
    const struct dt_point *xy = t->points.xy;
    const uint32_t *v = t->mesh.half + triangle;
    uint32_t least = dt_compare_xy(xy[v[1]], xy[v[0]]) < 0 ? 1 : 0;
    least = dt_compare_xy(xy[v[2]], xy[v[least]]) < 0 ? 2 : least;
    struct dt_point p = xy[v[least]], q = xy[v[(least + 1) % 3]], r = xy[v[(least + 2) % 3]];
    struct dt_point a = {q.x - p.x, q.y - p.y}, b = {r.x - p.x, r.y - p.y};
    k->triangle = triangle;
    k->corner = p;
    k->centre = dt_centre_at(a, b, a.x * a.x + a.y * a.y, b.x * b.x + b.y * b.y);
}
