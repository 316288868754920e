/* jump.c - see jump.h. Records and vertices are in spatial order, so a sample takes them in even
 * steps, in an order that depends on nothing but their number. */
#include "core/hints/jump.h"

#include <math.h>

#include "core/exact/predicates.h"

uint32_t dt_jump_samples(uint32_t n)
{
    return (uint32_t)sqrt((double)n);
}

/* A lower bound of how deep q lies in the circumcircle of the triangle at t: minus its power. Triangles too
 * thin for doubles get a small one, so they mislead no search. Less than anything else for ghosts and dead
 * records. */
static double depth(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t,
                    struct dt_point q)
{
    if (m->half[t + 2] >= DT_DEAD)
        return -HUGE_VAL;
    struct dt_point a = xy[m->half[t]], b = xy[m->half[t + 1]], c = xy[m->half[t + 2]];
    double area_size, area = dt_orient2d_rounded(b, c, a, &area_size);
    double det_size, det = dt_incircle_rounded(a, b, c, q, &det_size);
    double least = det - DT_CLOSE_DET_BOUND * det_size, error = DT_ORIENT_BOUND * area_size;
    area += least > 0 ? error : -error;
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
