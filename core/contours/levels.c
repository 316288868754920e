/* levels.c - the levels of contours at equal steps.
 *
 * base + k step is computed exactly and rounded once; the rounded level is compared with the values. So
 * 0.1 + 119 * 0.01 is the level 1.29 of a surface whose greatest value is 1.29.
 *
 * No quotient is rounded. fmod computes exactly the remainders r of the base and s of the least value, divided by the step.
 * Then (least - s) + r is one of the exact levels, and less than two steps from the least value, however large k is. */
#include "core/exact/bignum.h"

#include "core/delaunay_surface.h"

#include <math.h>

struct levels {
    struct dt_big least, most, step;
    struct dt_big at; /* the exact level that is next */
};

/* The level before; true: it is not below the least value. */
static bool step_back(struct levels *l)
{
    struct dt_big before = dt_big_subtract(l->at, l->step);
    if (dt_big_compare(before, l->least) < 0)
        return false;
    l->at = before;
    return true;
}

/* Goes to the first exact level that is not below the least value. */
static void begin(struct levels *l, double least, double most, double step, double base)
{
    l->least = dt_big_of(least);
    l->most = dt_big_of(most);
    l->step = dt_big_of(step);
    l->at = dt_big_subtract(dt_big_add(l->least, dt_big_of(fmod(base, step))),
                            dt_big_of(fmod(least, step)));
    while (dt_big_compare(l->at, l->least) < 0)
        l->at = dt_big_add(l->at, l->step);
    while (step_back(l))
        ;
}

/* Whether more than `most` exact levels are between the least and the greatest value. */
static bool are_more(const struct levels *l, size_t most)
{
    struct dt_big steps = dt_big_multiply(dt_big_of((double)most), l->step);
    return dt_big_compare(dt_big_add(l->at, steps), l->most) <= 0;
}

/* Lists the rounded levels from the least value to the greatest one, each once; with `around`, also the ones before and after. Returns
 * their number, cap + 1 if they are more than `cap`. */
static size_t list(struct levels *l, double least, double most, bool around, double *level,
                   size_t cap)
{
    size_t n = 0;
    bool above = false; /* the exact level before is above the greatest value */
    if (are_more(l, cap))
        return cap + 1;
    /* The one before may be rounded to the least value. */
    l->at = dt_big_subtract(l->at, l->step);
    for (;;) {
        double z = dt_big_nearest(l->at);
        if (above &&
            z <= most) /* the steps are so small that all that follow are rounded to the same */
            z = nextafter(most, HUGE_VAL);
        if (z > most && !around)
            return n;
        if (n == 1 && z <= least) /* the one before is not needed */
            n = 0;
        if ((around || z >= least) && (n == 0 || z > level[n - 1])) {
            if (n == cap)
                return cap + 1;
            level[n++] = z;
        }
        if (z > most)
            return n;
        above = dt_big_compare(l->at, l->most) > 0;
        l->at = dt_big_add(l->at, l->step);
    }
}

static size_t levels(double least, double most, double step, double base, bool around,
                     double *level, size_t cap)
{
    struct levels l;
    if (!(least <= most))
        return 0;
    begin(&l, least, most, step, base);
    return list(&l, least, most, around, level, cap);
}

size_t dt_levels_every(double least, double most, double step, double base, double *level,
                       size_t cap)
{
    return levels(least, most, step, base, false, level, cap);
}

size_t dt_levels_around(double least, double most, double step, double base, double *level,
                        size_t cap)
{
    return levels(least, most, step, base, true, level, cap);
}
