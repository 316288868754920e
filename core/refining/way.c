/* way.c - see way.h. */
#include "core/refining/way.h"

#include "core/exact/predicates.h"
#include "core/mesh/fixed.h"

/* Where q is in the triangle of h, of whose edges it is outside of none, given its sides of them. */
static struct dt_way_end end_in(uint32_t h, const int side[3])
{
    static const uint32_t next[3] = {1, 2, 0};
    for (uint32_t k = 0; k < 3; k++)
        if (side[k] == 0 && side[next[k]] == 0)
            return (struct dt_way_end){DT_ON_VERTEX, h + next[k]};
    for (uint32_t k = 0; k < 3; k++)
        if (side[k] == 0)
            return (struct dt_way_end){DT_ON_EDGE, h + k};
    return (struct dt_way_end){DT_INSIDE, h};
}

/* Goes straight from the corner p, opposite to h, to q beyond the edge of h. */
static struct dt_way_end go_on(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                               struct dt_point p, struct dt_point q)
{
    for (;;) {
        if (dt_is_fixed(m, h))
            return (struct dt_way_end){DT_OUTSIDE, h};
        uint32_t g = dt_twin(m, h), right = dt_next(g), left = dt_prev(g);
        struct dt_point w = xy[dt_apex_of(m, g)];
        int side[3];
        side[g & 3] = 1;
        side[right & 3] = dt_orient2d(xy[dt_origin(m, right)], w, q);
        side[left & 3] = dt_orient2d(w, xy[dt_dest(m, left)], q);
        if (side[right & 3] >= 0 && side[left & 3] >= 0)
            return end_in(dt_base(g), side);
        if (side[right & 3] < 0 && side[left & 3] < 0)
            h = dt_orient2d(p, q, w) > 0 ? right : left;
        else
            h = side[right & 3] < 0 ? right : left;
    }
}

struct dt_way_end dt_way(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                         struct dt_point q)
{
    int side[3], beyond = 0;
    uint32_t out = h;
    for (uint32_t k = 0; k < 3; k++) {
        side[k] = dt_orient2d(xy[dt_origin(m, h + k)], xy[dt_dest(m, h + k)], q);
        beyond += side[k] < 0;
        out = side[k] < 0 ? h + k : out;
    }
    if (beyond == 0)
        return end_in(h, side);
    if (beyond > 1)
        return (struct dt_way_end){DT_OUTSIDE, DT_NONE}; /* rounding: the triangle is that thin */
    return go_on(m, xy, out, xy[dt_apex_of(m, out)], q);
}
