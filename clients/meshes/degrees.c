/* degrees.c - see degrees.h. */
#include "clients/meshes/degrees.h"

#include <math.h>

#define KILOMETRES (6371.0088 * M_PI / 180) /* per degree on a sphere of the earth's mean radius */

bool degrees_choose(struct degrees *d, const double *xy, size_t n)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        low = fmin(low, xy[2 * i + 1]);
        high = fmax(high, xy[2 * i + 1]);
    }
    if (n == 0 || low < -90 || high > 90)
        return false;
    d->middle = (low + high) / 2;
    d->x = KILOMETRES *
           fmax(cos(d->middle * M_PI / 180), 0.01); /* near a pole nothing would be wide */
    d->y = KILOMETRES;
    return true;
}

void degrees_project(const struct degrees *d, double *xy, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        xy[2 * i] *= d->x;
        xy[2 * i + 1] *= d->y;
    }
}
