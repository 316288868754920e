/* pivots.c - simulates the selection that it defeats and assigns ranks as that picks pivots.
 *
 *      share of n    0.3         0.21        0.147      0.343
 *      x about       2^130       2^65        1          2^-65 and 2^-130: the crowd, which is cut at its
 *                    far out, in a grid of the others                     median */
#include "tests/bench/pivots.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory/sort.h"

#define SHARE 0.3 /* of the points of a grid lies far out */

/* Point i of n of this magnitude: along a line, but not on it. */
static struct dt_point point(int exponent, uint32_t i, uint32_t n)
{
    double x = 1 + (double)i / n;
    return (struct dt_point){ldexp(x, exponent), ldexp(x * x, exponent - 8)};
}

/* The n points of the crowd, by x. */
static struct dt_point crowded(uint32_t i, uint32_t n)
{
    uint32_t small = n - (uint32_t)(SHARE * n);
    return i < small ? point(-130, i, small) : point(-65, i - small, n - small);
}

static void fill_crowd(struct dt_point *p, uint32_t n)
{
    uint32_t *place = malloc((n + 1) * sizeof *place);
    uint64_t random = n;
    if (place == NULL)
        return;
    for (uint32_t i = 0; i < n; i++)
        place[i] = i;
    for (uint32_t lo = 0; lo < n;
         lo++) { /* the pivot goes to lo, and is the smallest from there on */
        uint32_t at = lo + dt_random_below(&random, n - lo), pivot = place[at];
        place[at] = place[lo];
        p[pivot] = crowded(lo, n);
    }
    free(place);
}

void pivots_fill(struct dt_point *p, uint32_t n)
{
    for (int exponent = 130; exponent >= 0; exponent -= 65) {
        uint32_t far = (uint32_t)(SHARE * n);
        for (uint32_t i = 0; i < far; i++)
            p[--n] = point(exponent, i, far);
    }
    fill_crowd(p, n);
}
