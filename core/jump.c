/* jump.c - see jump.h. Records and vertices are in spatial order, so a sample takes them in even
 * steps, in an order that depends on nothing but their number. */
#include "core/jump.h"

#include <math.h>

#include "core/predicates.h"

/* Rounding errors of depth(), in relation to the sums of magnitudes, are below these. */
#define AREA_ERROR 1e-15
#define DEPTH_ERROR 2e-15

uint32_t dt_jump_samples(uint32_t n)
{
    return (uint32_t)sqrt((double)n);
}

/* How deep q lies at least in the circumcircle of the triangle at t: minus its power. Triangles so
 * thin that doubles cannot tell do not seem deep, so nobody is led astray by them. Less than anything
 * else for ghosts and dead records. */
static double depth(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t,
                    struct dt_point q)
{
    if (m->half[t + 2] >= DT_DEAD)
        return -HUGE_VAL;
    struct dt_point a = xy[m->half[t]], b = xy[m->half[t + 1]], c = xy[m->half[t + 2]];
    double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
    double ax = a.x - q.x, ay = a.y - q.y, bx = b.x - q.x, by = b.y - q.y;
    double cx = c.x - q.x, cy = c.y - q.y;
    double lift_a = ax * ax + ay * ay, lift_b = bx * bx + by * by, lift_c = cx * cx + cy * cy;
    double det =
        lift_a * (bx * cy - cx * by) + lift_b * (cx * ay - ax * cy) + lift_c * (ax * by - bx * ay);
    double size = lift_a * (fabs(bx * cy) + fabs(cx * by)) +
                  lift_b * (fabs(cx * ay) + fabs(ax * cy)) +
                  lift_c * (fabs(ax * by) + fabs(bx * ay));
    double least = det - DEPTH_ERROR * size, error = AREA_ERROR * (fabs(left) + fabs(right));
    double area = left - right + (least > 0 ? error : -error);
    return area > 0 ? least / area : -HUGE_VAL;
}

uint32_t dt_jump_triangle(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                          struct dt_point q)
{
    uint32_t best = dt_base(from), samples = dt_jump_samples(m->tri_end);
    double deepest = depth(m, xy, best, q);
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t t = 8 * (uint32_t)((uint64_t)m->tri_end * i / samples);
        double d = depth(m, xy, t, q);
        best = d > deepest ? t : best;
        deepest = d > deepest ? d : deepest;
    }
    return best;
}

uint32_t dt_jump_vertex(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                        struct dt_point q)
{
    uint32_t best = from, samples = dt_jump_samples(m->vert_cap);
    double nearest = dt_square_distance(xy[from], q);
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t v = (uint32_t)((uint64_t)m->vert_cap * i / samples);
        if (m->leaving[v] == DT_NONE)
            continue;
        double d = dt_square_distance(xy[v], q);
        best = d < nearest ? v : best;
        nearest = d < nearest ? d : nearest;
    }
    return best;
}
