/* sight.c - where the filters of sight.h are in doubt: closer bounds first, then the exact predicates.
 *
 * Filter. On circles and thin strips the box says little about the four points at hand. Let
 *
 *     CR(c) = |(r - l).x (c - l).y| + |(r - l).y (c - l).x|,
 *     DT(c) = |(c - l).x (c - r).x| + |(c - l).y (c - r).y|
 *
 * be the sums of magnitudes in cr and dt. A product of two rounded differences has a relative error
 * of at most 3 u, so |err cr| <= 4 u CR and |err dt| <= 4 u DT (+ O(u^2)), hence each product of a cr
 * and a dt errs by at most 9 u CR DT, and with S = DT(c) CR(x) + DT(x) CR(c)
 *
 *     |err det| <= 9 u S + u S = 10 u S.
 *
 * S itself is computed with a relative error of a few u; the bound used is 1.2e-15 S > 10.8 u S. */
#include "core/sight.h"

#include "core/predicates.h"

int dt_sight_above(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v)
{
    return (dt_orient2d(p[l], p[r], p[u]) > 0 ? SIGHT_LEFT : 0) |
           (dt_orient2d(p[l], p[r], p[v]) > 0 ? SIGHT_RIGHT : 0);
}

int dt_sight_below(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v)
{
    return (dt_orient2d(p[l], p[r], p[u]) < 0 ? SIGHT_LEFT : 0) |
           (dt_orient2d(p[l], p[r], p[v]) < 0 ? SIGHT_RIGHT : 0);
}

static bool in_circle(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t c, uint32_t x)
{
    return dt_incircle_perturbed(p[l], p[r], p[c], p[x]) > 0;
}

static dt_lanes cr_terms(const struct sight_base *at, const struct sight *c)
{
    return dt_lanes_abs((at->rx - at->lx) * (c->y - at->ly)) +
           dt_lanes_abs((at->ry - at->ly) * (c->x - at->lx));
}

static dt_lanes dt_terms(const struct sight_base *at, const struct sight *c)
{
    return dt_lanes_abs((c->x - at->lx) * (c->x - at->rx)) +
           dt_lanes_abs((c->y - at->ly) * (c->y - at->ry));
}

int dt_sight_better(const struct dt_point *p, uint32_t l, uint32_t r, int sides,
                    const uint32_t c[2], const uint32_t x[2])
{
    struct sight_base at = sight_base_of(p[l], p[r]);
    struct sight in_c = sight_of(p, &at, c[0], c[1]), in_x = sight_of(p, &at, x[0], x[1]);
    dt_lanes det = in_c.dt * in_x.cr - in_x.dt * in_c.cr;
    dt_lanes bound = sight_both(1.2e-15) * (dt_terms(&at, &in_c) * cr_terms(&at, &in_x) +
                                            dt_terms(&at, &in_x) * cr_terms(&at, &in_c));
    int better = sides & dt_lanes_bits(det > bound);
    int doubt = sides & ~better & ~dt_lanes_bits(det < -bound);
    if ((doubt & SIGHT_LEFT) && in_circle(p, l, r, c[0], x[0]))
        better |= SIGHT_LEFT;
    if ((doubt & SIGHT_RIGHT) && in_circle(p, l, r, c[1], x[1]))
        better |= SIGHT_RIGHT;
    return better;
}

bool dt_sight_left_wins(const struct dt_point *p, uint32_t l, uint32_t r, uint32_t u, uint32_t v)
{
    struct sight_base at = sight_base_of(p[l], p[r]);
    struct sight c = sight_of(p, &at, u, v);
    dt_lanes cr = cr_terms(&at, &c), dt = dt_terms(&at, &c);
    double det = c.dt[0] * c.cr[1] - c.dt[1] * c.cr[0];
    double bound = 1.2e-15 * (dt[0] * cr[1] + dt[1] * cr[0]);
    return fabs(det) > bound ? det < 0 : !in_circle(p, l, r, u, v);
}
