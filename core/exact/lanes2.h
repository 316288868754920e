/* lanes2.h - rounding errors and double words, two side by side: double2.h in lanes. Every operation gives the same
 * bits in each lane as its original in double2.h. */
#pragma once

#include "core/exact/double2.h"
#include "core/exact/lanes.h"

struct dt_lanes2 {
    dt_lanes hi, lo;
};

/* a + b = hi + lo exactly. */
static inline struct dt_lanes2 dt_lanes2_sum(dt_lanes a, dt_lanes b)
{
    dt_lanes s = a + b, b_part = s - a, a_part = s - b_part;
    return (struct dt_lanes2){s, (a - a_part) + (b - b_part)};
}

/* The same if a = 0 or |a| >= |b|. */
static inline struct dt_lanes2 dt_lanes2_fast_sum(dt_lanes a, dt_lanes b)
{
    dt_lanes s = a + b;
    return (struct dt_lanes2){s, b - (s - a)};
}

/* a = hi + lo, each of at most 26 bits. */
static inline struct dt_lanes2 dt_lanes2_split(dt_lanes a)
{
    dt_lanes c = a * dt_lanes_both(134217729.0);
    dt_lanes hi = c - (c - a);
    return (struct dt_lanes2){hi, a - hi};
}

/* a * b = hi + lo exactly; `as` and `bs` are a and b split. */
static inline struct dt_lanes2 dt_lanes2_product(dt_lanes a, struct dt_lanes2 as, dt_lanes b,
                                                 struct dt_lanes2 bs)
{
    dt_lanes p = a * b;
    return (struct dt_lanes2){p, as.lo * bs.lo -
                                     (((p - as.hi * bs.hi) - as.lo * bs.hi) - as.hi * bs.lo)};
}

/* dt_double2_add. */
static inline struct dt_lanes2 dt_lanes2_add(struct dt_lanes2 a, struct dt_lanes2 b)
{
    struct dt_lanes2 s = dt_lanes2_sum(a.hi, b.hi), t = dt_lanes2_sum(a.lo, b.lo);
    struct dt_lanes2 r = dt_lanes2_fast_sum(s.hi, s.lo + t.hi);
    return dt_lanes2_fast_sum(r.hi, t.lo + r.lo);
}

/* dt_double2_multiply; `as` and `bs` are a.hi and b.hi split. */
static inline struct dt_lanes2 dt_lanes2_multiply(struct dt_lanes2 a, struct dt_lanes2 as,
                                                  struct dt_lanes2 b, struct dt_lanes2 bs)
{
    struct dt_lanes2 p = dt_lanes2_product(a.hi, as, b.hi, bs);
    return dt_lanes2_fast_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
