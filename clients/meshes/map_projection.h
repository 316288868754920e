/* map_projection.h - longitudes and latitudes as places on a map: the equirectangular projection, in kilometres, whose lengths are true
 * along meridians and along the middle latitude. For pictures only; the degrees are triangulated as plane coordinates. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct map_projection {
    double middle; /* latitude */
    double x, y;   /* kilometres per degree */
};

/* Chooses the middle latitude of the places xy[2n]. False if one is beyond 90 degrees. */
bool map_projection_choose(struct map_projection *d, const double *xy, size_t n);

/* Changes places to kilometres. */
void map_projection_project(const struct map_projection *d, double *xy, size_t n);
