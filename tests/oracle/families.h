/* families.h - named families of point sets, easy and hostile, for tests, interop and bench.
 *
 * A family fills an array of any length, 0 included, from a seed; the same (name, n, seed) gives
 * the same points. All coordinates pass dt_coordinate_ok. Lattices and circles are exact: their
 * ties are real ties. */
#pragma once

#include "core/delaunay.h"

struct family {
    const char *name;
    const char *what; /* a short description */
    bool hostile; /* defeats a uniform grid: engines that rely on one may be slow, so keep n modest
                   */
    void (*fill)(struct dt_point *p, size_t n, uint64_t *random);
};

/* All families; the row after the last one has the name NULL. */
extern const struct family families[];

/* The family of this name, NULL if there is none. */
const struct family *family_find(const char *name);

/* Writes n points to p. */
void family_points(const struct family *f, struct dt_point *p, size_t n, uint64_t seed);
