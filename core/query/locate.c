/* locate.c - the walk: from triangle to triangle through an edge that has q strictly on its outer
 * side.
 *
 * In a Delaunay triangulation such a walk never returns to a triangle, even if two edges qualify and it takes any of
 * them [De Floriani, Falcidieno, Nagy & Pienovi 1991; Devillers, Pion & Teillaud 2002]. So it ends. In a triangulation
 * with constraints it may return. Then it takes a limited number of steps, and after these the straight way (march.h). */
#include "core/query/locate.h"

#include "core/constraints/march.h"
#include "core/exact/predicates.h"
#include "core/hints/hints.h"
#include "core/hints/jump.h"
#include "core/mesh/hull.h"

#define PATIENCE 64 /* triangles; nearly every walk is shorter than a dozen */

/* q is in the closed triangle at t, on these sides of its half edges; none is negative. */
static enum dt_where classify(uint32_t t, const int side[3], uint32_t *half)
{
    int on = (side[0] == 0) + (side[1] == 0) + (side[2] == 0);
    *half = t;
    if (on == 0)
        return DT_INSIDE;
    if (on == 1) {
        *half = side[0] == 0 ? t : side[1] == 0 ? t + 1 : t + 2;
        return DT_ON_EDGE;
    }
    *half = side[0] != 0   ? t + 2
            : side[1] != 0 ? t
                           : t + 1; /* the corner opposite to the side that q is not on */
    return DT_ON_VERTEX;
}

enum { ARRIVED = 3 };

/* Fetches the neighbours beyond the two other edges of the triangle at h: one of them is next, and which one is known
 * only when the corner's coordinates have come. Also fetches the corner's entry in id, unless id is NULL. */
static inline void fetch_beyond(const struct dt_mesh *m, const uint32_t *id, uint32_t h)
{
    dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(h)))]);
    dt_fetch(&m->half[dt_base(dt_twin(m, dt_prev(h)))]);
    if (id != NULL)
        dt_fetch(&id[dt_apex_of(m, h)]);
}

/* A way from the edge of half edge h, on the side on which q is. *strictly: q is not on the line of that edge. */
static inline struct dt_way set_out(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                                    struct dt_point q, bool *strictly)
{
    struct dt_point p = xy[dt_origin(m, h)], r = xy[dt_dest(m, h)];
    struct dt_point a = dt_way_see(p, q), b = dt_way_see(r, q);
    int side = dt_orient2d(p, r, q);
    *strictly = side != 0;
    return side < 0 ? (struct dt_way){b, a, dt_twin(m, h)} : (struct dt_way){a, b, h};
}

/* Rounding errors leave the place of q open: the edge 0, 1 or 2 of the triangle at t that has q on its outer side, exactly. ARRIVED if
 * q is in the closed triangle. */
static uint32_t exact_exit(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t,
                           struct dt_point q, enum dt_where *where, uint32_t *half)
{
    struct dt_point a = xy[m->half[t]], b = xy[m->half[t + 1]], c = xy[m->half[t + 2]];
    int side[3] = {dt_orient2d(a, b, q), dt_orient2d(b, c, q), dt_orient2d(c, a, q)};
    for (uint32_t k = 0; k < 3; k++)
        if (side[k] < 0)
            return k;
    *where = classify(t, side, half);
    return ARRIVED;
}

/* Through the edge of its triangle, no ghost, that has q farther on its outer side, where rounding does not blur that. False:
 * q is in the closed triangle; *half and *where as for dt_find. strictly: q is not on the line of w->h. */
static inline bool step(const struct dt_mesh *m, const struct dt_point *xy, struct dt_point q,
                        struct dt_way *w, bool strictly, enum dt_where *where, uint32_t *half)
{
    struct dt_point c = dt_way_see(xy[dt_apex_of(m, w->h)], q);
    double size = 0, next = dt_way_side(w->b, c, &size), prev = dt_way_side(c, w->a, &size);
    double least = next < prev ? next : prev, error = DT_ORIENT_BOUND * size;
    bool to_next = next < prev;
    if (least > error && strictly) {
        *where = DT_INSIDE;
        *half = dt_base(w->h);
        return false;
    }
    if (least >= -error) {
        uint32_t k = exact_exit(m, xy, dt_base(w->h), q, where, half);
        if (k == ARRIVED)
            return false;
        to_next = dt_base(w->h) + k == dt_next(w->h);
    }
    dt_way_cross(m, w, c, to_next);
    return true;
}

/* Walks over at most *steps triangles and subtracts their number from *steps. True: arrived, *half and
 * *where as for dt_find. False: *half is a half edge to continue from. */
static bool walk_plane(const struct dt_mesh *m, const struct dt_point *xy, const uint32_t *id,
                       uint32_t h, struct dt_point q, uint32_t *steps, enum dt_where *where,
                       uint32_t *half)
{
    bool strictly;
    uint32_t from = dt_is_ghost(m, h) ? dt_twin(m, dt_base(h)) : dt_base(h);
    struct dt_way w = set_out(m, xy, from, q, &strictly);
    for (; !dt_is_ghost(m, w.h); strictly = true) {
        fetch_beyond(m, id, w.h);
        if (!step(m, xy, q, &w, strictly, where, half))
            return true;
        if ((*steps)-- == 0) {
            *half = w.h;
            return false;
        }
    }
    *half = dt_base(w.h);
    *where = DT_OUTSIDE;
    return true;
}

/* All points on one line: along the ghosts of one side, towards corner 0. */
static enum dt_where walk_line(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                               struct dt_point q, uint32_t *half)
{
    uint32_t g = dt_base(h);
    *half = g;
    if (dt_orient2d(xy[dt_origin(m, g)], xy[dt_dest(m, g)], q) != 0)
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
    uint32_t steps = m->fixed == NULL ? UINT32_MAX : PATIENCE;
    if (dt_mesh_is_line(m))
        return walk_line(m, xy, from, q, half);
    while (!walk_plane(m, xy, NULL, from, q, &steps, &where, half)) {
        from = *half;
        if (m->fixed != NULL)
            return dt_march_to(m, xy, dt_is_ghost(m, from) ? dt_twin(m, dt_base(from)) : from, q,
                               half);
    }
    return where;
}

bool dt_walk_within(const struct dt_mesh *m, const struct dt_point *xy, uint32_t from,
                    struct dt_point q, uint32_t *steps, uint32_t *half)
{
    enum dt_where where;
    bool arrived = walk_plane(m, xy, NULL, from, q, steps, &where, half);
    *steps = arrived ? *steps : 0;
    return arrived;
}

/* The walk from the nearest hint was long: many thin triangles lie across its way, as within a circle of points
 * with nothing inside. It continues from where it was, for a while, and then from the best of a sample. */
static enum dt_where find_again(const struct dt_mesh *m, const struct dt_point *xy,
                                struct dt_point q, uint32_t *half)
{
    enum dt_where where;
    uint32_t steps = dt_jump_samples(m->tri_end);
    if (walk_plane(m, xy, NULL, *half, q, &steps, &where, half))
        return where;
    return dt_walk(m, xy, dt_jump_triangle(m, xy, *half, q), q, half);
}

/* dt_find and dt_find_counting. */
static inline enum dt_where find(const struct dt *t, uint32_t near, const uint32_t *id,
                                 struct dt_point q, uint32_t *half, uint32_t *steps)
{
    const struct dt_mesh *m = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    const struct dt_hints *hints = &t->hints;
    enum dt_where where;
    uint32_t h, left = PATIENCE;
    *steps = 4 * PATIENCE;
    if (hints->grids == 0)
        return dt_walk(m, xy, m->hull, q, half);
    if (near < 8 * (uint64_t)m->tri_end && !dt_is_dead(m, near)) {
        h = near;
        id = NULL; /* who knew q knew that before */
    } else if (m->recycled) {
        h = dt_hint_live(hints, m, xy, q);
    } else {
        h = dt_hint_fetching(hints, m, xy, q);
        if (dt_is_dead(m, h))
            h = dt_hint_live(hints, m, xy, q);
    }
    if (id != NULL)
        dt_hint_fetch_ids(id, h);
    *steps = 0;
    if (dt_mesh_is_line(m))
        return walk_line(m, xy, h, q, half);
    bool arrived = walk_plane(m, xy, id, h, q, &left, &where, half);
    *steps = arrived ? PATIENCE - left : 4 * PATIENCE;
    return arrived ? where : find_again(m, xy, q, half);
}

enum dt_where dt_find_counting(const struct dt *t, struct dt_point q, uint32_t *half,
                               uint32_t *steps)
{
    return find(t, DT_NONE, NULL, q, half, steps);
}

enum dt_where dt_find(const struct dt *t, const struct dt_place *q, uint32_t *half)
{
    uint32_t steps;
    return find(t, q->near, t->points.id, q->at, half, &steps);
}
