/* degrees.h - longitudes and latitudes as places on a map: the equirectangular projection, in kilometres, whose lengths are true along
 * meridians and along the middle latitude. For pictures only; the degrees are triangulated as plane coordinates. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct degrees {
    double middle; /* latitude */
    double x, y;   /* kilometres per degree */
};

/* Chooses the middle latitude of the places xy[2n]. False if one is beyond 90 degrees. */
bool degrees_choose(struct degrees *d, const double *xy, size_t n);

/* Changes places to kilometres. */
void degrees_project(const struct degrees *d, double *xy, size_t n);
