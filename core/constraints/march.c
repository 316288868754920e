/* march.c - see march.h. */
#include "core/constraints/march.h"

#include "core/mesh/star.h"

/* Whether r lies from p in the direction of q, all three on one line. */
static bool ahead(struct dt_point p, struct dt_point r, struct dt_point q)
{
    return dt_compare_xy(p, r) == dt_compare_xy(p, q);
}

/* Whether the way from the origin p of h to q begins along h, or in the triangle of h. */
static bool begins(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                   struct dt_point p, struct dt_point q, enum dt_march_step *step, uint32_t *half)
{
    uint32_t u = dt_dest(m, h), w = dt_apex_of(m, h);
    if (u == DT_NONE)
        return false;
    int side = dt_orient2d(p, xy[u], q);
    if (side == 0 && ahead(p, xy[u], q)) {
        *step = DT_MARCH_ALONG;
        *half = h;
        return true;
    }
    if (side <= 0 || w == DT_NONE || dt_orient2d(p, xy[w], q) >= 0)
        return false;
    *step = DT_MARCH_CROSS;
    *half = dt_next(h);
    return true;
}

/* The ghost at the hull vertex that near leaves beyond whose edge q lies, where the way leads out. */
static uint32_t ghost_beyond(const struct dt_mesh *m, const struct dt_point *xy, uint32_t near,
                             struct dt_point q)
{
    uint32_t h = near;
    do {
        uint32_t g = dt_base(h);
        if (dt_is_ghost(m, g) && dt_orient2d(xy[dt_origin(m, g)], xy[dt_origin(m, g + 1)], q) > 0)
            return g;
        h = dt_turn_ccw(m, h);
    } while (h != near);
    return DT_NONE;
}

enum dt_march_step dt_march_begin(const struct dt_mesh *m, const struct dt_point *xy, uint32_t near,
                                  struct dt_point q, uint32_t *half)
{
    struct dt_point p = xy[dt_origin(m, near)];
    enum dt_march_step step;
    uint32_t h = near;
    do {
        if (begins(m, xy, h, p, q, &step, half))
            return step;
        h = dt_turn_ccw(m, h);
    } while (h != near);
    *half = ghost_beyond(m, xy, near, q);
    return DT_MARCH_OUT;
}

enum dt_march_step dt_march_between(const struct dt_mesh *m, const struct dt_point *xy, uint32_t a,
                                    uint32_t b, uint32_t *half, bool *swapped)
{
    struct dt_point p = xy[a], q = xy[b];
    enum dt_march_step step;
    *swapped = false;
    if ((*half = dt_edge_between(m, a, b)) != DT_NONE)
        return DT_MARCH_ALONG;
    for (uint32_t from_a = m->leaving[a], from_b = m->leaving[b];;) {
        *swapped = false;
        if (begins(m, xy, from_a, p, q, &step, half))
            return step;
        *swapped = true;
        if (begins(m, xy, from_b, q, p, &step, half))
            return step;
        from_a = dt_turn_ccw(m, from_a);
        from_b = dt_turn_ccw(m, from_b);
    }
}

/* q is in the closed triangle of h. */
static enum dt_where arrive(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                            struct dt_point q, uint32_t *half)
{
    uint32_t t = dt_base(h);
    *half = t;
    for (uint32_t k = t; k < t + 3; k++)
        if (dt_compare_xy(xy[dt_origin(m, k)], q) == 0) {
            *half = k;
            return DT_ON_VERTEX;
        }
    for (uint32_t k = t; k < t + 3; k++)
        if (dt_orient2d(xy[dt_origin(m, k)], xy[dt_dest(m, k)], q) == 0) {
            *half = k;
            return DT_ON_EDGE;
        }
    return DT_INSIDE;
}

/* Goes on from the edge that the way from p crosses. True: *half and *where are what is asked for. False: the next part
 * begins at the vertex that *half leaves. */
static bool cross_on(const struct dt_mesh *m, const struct dt_point *xy, struct dt_point p,
                     struct dt_point q, uint32_t e, enum dt_where *where, uint32_t *half)
{
    for (;;) {
        if (dt_orient2d(xy[dt_origin(m, e)], xy[dt_dest(m, e)], q) >= 0) {
            *where = arrive(m, xy, e, q, half);
            return true;
        }
        uint32_t g = dt_twin(m, e), x = dt_apex_of(m, g);
        if (x == DT_NONE) {
            *half = dt_base(g);
            *where = DT_OUTSIDE;
            return true;
        }
        int side = dt_orient2d(p, q, xy[x]);
        if (side == 0) {
            *half = dt_prev(g);
            return false;
        }
        e = dt_march_next(m, e, side);
    }
}

enum dt_where dt_march_to(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                          struct dt_point q, uint32_t *half)
{
    enum dt_where where;
    uint32_t near = dt_base(h); /* corner 0, which is a vertex */
    for (;;) {
        struct dt_point p = xy[dt_origin(m, near)];
        if (dt_compare_xy(p, q) == 0) {
            *half = near;
            return DT_ON_VERTEX;
        }
        uint32_t e;
        switch (dt_march_begin(m, xy, near, q, &e)) {
        case DT_MARCH_OUT:
            *half = e;
            return DT_OUTSIDE;
        case DT_MARCH_CROSS:
            if (cross_on(m, xy, p, q, e, &where, half))
                return where;
            near = *half;
            break;
        default:
            if (dt_compare_xy(p, q) == dt_compare_xy(q, xy[dt_dest(m, e)])) { /* q is on e */
                *half = dt_is_ghost(m, e) ? dt_twin(m, e) : e;
                return DT_ON_EDGE;
            }
            near = dt_twin(m, e);
        }
    }
}
