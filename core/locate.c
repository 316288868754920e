/* locate.c - the walk: from triangle to triangle through an edge that has q strictly on its outer
 * side.
 *
 * In a Delaunay triangulation such a walk never comes back to a triangle, whichever edge it takes
 * where two qualify [De Floriani, Falcidieno, Nagy & Pienovi 1991; Devillers, Pion & Teillaud
 * 2002], so it ends. */
#include "core/locate.h"

#include "core/hints_live.h"
#include "core/hull.h"
#include "core/predicates.h"

#define PATIENCE 64 /* triangles; nearly every walk is shorter than a dozen */

/* > 0 if q lies left of the half edge h of a triangle. */
static int side(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h, struct dt_point q)
{
    return dt_orient2d(xy[dt_origin(m, h)], xy[dt_dest(m, h)], q);
}

/* q is in the closed triangle of h, on these sides of h, next(h) and prev(h); none is negative. */
static enum dt_where classify(uint32_t h, int s0, int s1, int s2, uint32_t *half)
{
    uint32_t next = dt_next(h), prev = dt_prev(h);
    if (s0 != 0 && s1 != 0 && s2 != 0) {
        *half = h;
        return DT_INSIDE;
    }
    if ((s0 != 0) + (s1 != 0) + (s2 != 0) == 2) {
        *half = s0 == 0 ? h : s1 == 0 ? next : prev;
        return DT_ON_EDGE;
    }
    *half = s0 != 0   ? prev
            : s1 != 0 ? h
                      : next; /* the corner opposite to the side that q is not on */
    return DT_ON_VERTEX;
}

/* Walks at most *steps triangles far and takes what it walked off *steps. True: arrived, *half and
 * *where as for dt_find. False: *half is a half edge to go on from. */
static bool walk_plane(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                       struct dt_point q, uint32_t *steps, enum dt_where *where, uint32_t *half)
{
    if (dt_is_ghost(m, h))
        h = dt_twin(m, dt_base(h));
    int s = side(m, xy, h, q);
    if (s < 0) {
        h = dt_twin(m, h);
        s = 1;
    }
    /* q is left of h, or on its line in the first triangle. */
    for (; !dt_is_ghost(m, h); s = 1) {
        int s1 = side(m, xy, dt_next(h), q);
        int s2 = s1 < 0 ? 0 : side(m, xy, dt_prev(h), q);
        if (s1 >= 0 && s2 >= 0) {
            *where = classify(h, s, s1, s2, half);
            return true;
        }
        h = dt_twin(m, s1 < 0 ? dt_next(h) : dt_prev(h));
        if ((*steps)-- == 0) {
            *half = h;
            return false;
        }
    }
    *half = dt_base(h);
    *where = DT_OUTSIDE;
    return true;
}

/* All points on one line: along the ghosts of one side, towards corner 0. */
static enum dt_where walk_line(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                               struct dt_point q, uint32_t *half)
{
    uint32_t g = dt_base(h);
    *half = g;
    if (side(m, xy, g, q) != 0)
        return DT_OUTSIDE;
    for (;;) {
        struct dt_point a = xy[dt_origin(m, g)], b = xy[dt_dest(m, g)];
        int from_a = dt_compare_xy(q, a), from_b = dt_compare_xy(q, b);
        if (from_a == 0 || from_b == 0) {
            *half = from_a == 0 ? g : dt_next(g);
            return DT_ON_VERTEX;
        }
        *half = g;
        if (from_a != from_b)
            return DT_ON_EDGE;
        if (from_a != dt_compare_xy(a, b)) { /* q lies beyond b: turn round */
            g = dt_twin(m, g);
            *half = g;
        }
        if (dt_hull_turns(m, g))
            return DT_OUTSIDE;
        g = dt_hull_step(m, g, false);
    }
}

enum dt_where dt_walk(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                      struct dt_point q, uint32_t *half)
{
    enum dt_where where;
    uint32_t steps = UINT32_MAX;
    if (dt_mesh_is_line(m))
        return walk_line(m, xy, from, q, half);
    while (!walk_plane(m, xy, from, q, &steps, &where, half))
        from = *half;
    return where;
}

/* The walk from the nearest hint has taken long: many thin triangles lie across its way, as within
 * a circle of points with nothing inside. From one of the four sides it may be short. */
static enum dt_where find_again(const struct dt_mesh *m, const struct dt_point *xy,
                                const struct dt_hints *hints, struct dt_point q, uint32_t *half)
{
    enum dt_where where;
    uint32_t far = *half;
    for (unsigned direction = 0; direction < 4; direction++) {
        uint32_t h = dt_hint_beyond(hints, q, direction), steps = PATIENCE;
        if (h != DT_NONE && !dt_is_dead(m, h) && walk_plane(m, xy, h, q, &steps, &where, half))
            return where;
    }
    return dt_walk(m, xy, far, q, half);
}

enum dt_where dt_find_counting(const struct dt_mesh *m, const struct dt_point *xy,
                               const struct dt_hints *hints, struct dt_point q, uint32_t *half,
                               uint32_t *steps)
{
    enum dt_where where;
    uint32_t h = dt_hint_live(hints, m, xy, q), left = PATIENCE;
    *steps = 0;
    if (dt_mesh_is_line(m))
        return walk_line(m, xy, h, q, half);
    bool arrived = walk_plane(m, xy, h, q, &left, &where, half);
    *steps = arrived ? PATIENCE - left : 4 * PATIENCE;
    return arrived ? where : find_again(m, xy, hints, q, half);
}

enum dt_where dt_find(const struct dt_mesh *m, const struct dt_point *xy,
                      const struct dt_hints *hints, struct dt_point q, uint32_t *half)
{
    uint32_t steps;
    return dt_find_counting(m, xy, hints, q, half, &steps);
}
