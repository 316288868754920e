/* locate.c - the walk: from triangle to triangle through an edge that has q strictly on its outer
 * side.
 *
 * In a Delaunay triangulation such a walk never comes back to a triangle, whichever edge it takes
 * where two qualify [De Floriani, Falcidieno, Nagy & Pienovi 1991; Devillers, Pion & Teillaud
 * 2002], so it ends. */
#include "core/locate.h"

#include "core/hull.h"
#include "core/predicates.h"

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

static enum dt_where walk_plane(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                                struct dt_point q, uint32_t *half)
{
    if (dt_is_ghost(m, h))
        h = dt_twin(m, dt_base(h));
    int s = side(m, xy, h, q);
    if (s < 0) {
        h = dt_twin(m, h);
        s = 1;
    }
    /* q is left of h, or on its line in the first triangle. */
    while (!dt_is_ghost(m, h)) {
        int s1 = side(m, xy, dt_next(h), q);
        if (s1 < 0) {
            h = dt_twin(m, dt_next(h));
            s = 1;
            continue;
        }
        int s2 = side(m, xy, dt_prev(h), q);
        if (s2 >= 0)
            return classify(h, s, s1, s2, half);
        h = dt_twin(m, dt_prev(h));
        s = 1;
    }
    *half = dt_base(h);
    return DT_OUTSIDE;
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
    return dt_mesh_is_line(m) ? walk_line(m, xy, from, q, half) : walk_plane(m, xy, from, q, half);
}

enum dt_where dt_find(const struct dt_mesh *m, const struct dt_point *xy,
                      const struct dt_hints *hints, struct dt_point q, uint32_t *half)
{
    return dt_walk(m, xy, dt_hint(hints, q), q, half);
}
