/* sight.c - the stages behind the filters of sight.h: the close filter, then the exact predicates. */
#include "core/divide/sight.h"

#include "core/exact/predicates.h"

int dt_sight_side(const struct dt_point *p, bool above, uint32_t l, uint32_t r, uint32_t u,
                  uint32_t v)
{
    int wanted = above ? 1 : -1;
    return (dt_orient2d(p[l], p[r], p[u]) == wanted ? SIGHT_LEFT : 0) |
           (dt_orient2d(p[l], p[r], p[v]) == wanted ? SIGHT_RIGHT : 0);
}

static bool in_circle(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t c, uint32_t x)
{
    int sign = dt_incircle_exact(p[l], p[r], p[c], p[x]);
    return (sign != 0 ? sign : dt_incircle_tie(p[l], p[r], p[c], p[x])) > 0;
}

int dt_sight_better(const struct dt_point *p, uint32_t l, uint32_t r, int sides,
                    const uint32_t c[2], const uint32_t x[2])
{
    struct sight_base at = sight_base_of(p[l], p[r]);
    struct sight in_c = sight_of(p, &at, c[0], c[1]), in_x = sight_of(p, &at, x[0], x[1]);
    dt_lanes det = in_c.dt * in_x.cr - in_x.dt * in_c.cr, bound = sight_close(&in_c, &in_x);
    int better = sides & dt_lanes_bits(det > bound);
    int doubt = sides & ~better & ~dt_lanes_bits(det < -bound);
    if (doubt == 0)
        return better | SIGHT_SETTLED;
    if ((doubt & SIGHT_LEFT) && in_circle(p, l, r, c[0], x[0]))
        better |= SIGHT_LEFT;
    if ((doubt & SIGHT_RIGHT) && in_circle(p, l, r, c[1], x[1]))
        better |= SIGHT_RIGHT;
    return better;
}

int dt_sight_left_wins(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v)
{
    if (dt_is_rectangle(p[l], p[v], p[r], p[u])) /* on lattices no other doubt is as frequent */
        return dt_incircle_tie(p[l], p[r], p[u], p[v]) < 0 ? SIGHT_LEFT : 0;
    struct sight_base at = sight_base_of(p[l], p[r]);
    struct sight c = sight_of(p, &at, u, v);
    double det = c.dt[0] * c.cr[1] - c.dt[1] * c.cr[0];
    if (fabs(det) > sight_close_of_pair(&c))
        return SIGHT_SETTLED | (det < 0 ? SIGHT_LEFT : 0);
    return in_circle(p, l, r, u, v) ? 0 : SIGHT_LEFT;
}
