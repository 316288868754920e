/* surface_plan.h - the work of the bench of surfaces, the same for us and for the peer. */
#pragma once

#include <math.h>

enum surface_kind {
    SURFACE_LINEAR, /* at the cells of a raster of the unit square, from the north, in rows */
    SURFACE_LINEAR_TWO_THREADS,
    SURFACE_NATURAL,
    SURFACE_LAPLACE,
    SURFACE_LINEAR_ANYWHERE, /* at random places */
    SURFACE_NATURAL_ANYWHERE,
    SURFACE_CELLS, /* Voronoi cells, clipped */
    SURFACE_CELLS_FRESH,
    SURFACE_AREAS, /* and their areas */
    SURFACE_CONTOURS,
    SURFACE_BANDS,
    SURFACE_VOLUME,
    SURFACE_VOLUME_BOX,    /* of the middle quarter */
    SURFACE_VOLUME_INSIDE, /* a border around about that */
    SURFACE_ANGLES,        /* how many triangles have which least angle */
    SURFACE_PROFILE,       /* from side to side of the unit square */
    SURFACE_KINDS
};

enum { SURFACE_LEVELS = 20, SURFACE_PROFILES = 20 };

/* The height at which profile i begins; it ends at 1 less that. */
static inline double surface_begin(int i)
{
    return (i + 0.3) / SURFACE_PROFILES;
}

/* A smooth field over the unit square, from -1 to 1. */
static inline double surface_height(double x, double y)
{
    return sin(7 * x) * cos(5 * y);
}
