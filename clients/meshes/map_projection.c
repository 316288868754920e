/* map_projection.c - see map_projection.h. */
#include "clients/meshes/map_projection.h"

#include <math.h>

#include "clients/meshes/bounds.h"

#define KILOMETRES (6371.0088 * M_PI / 180) /* per degree on a sphere of the earth's mean radius */

bool map_projection_choose(struct map_projection *d, const double *xy, size_t n)
{
    double box[4];
    if (!bounds_of(xy, n, box) || box[1] < -90 || box[3] > 90)
        return false;
    d->middle = (box[1] + box[3]) / 2;
    d->x = KILOMETRES *
           fmax(cos(d->middle * M_PI / 180), 0.01); /* near a pole nothing would be wide */
    d->y = KILOMETRES;
    return true;
}

void map_projection_project(const struct map_projection *d, double *xy, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        xy[2 * i] *= d->x;
        xy[2 * i + 1] *= d->y;
    }
}
