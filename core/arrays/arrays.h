/* arrays.h - the definition of struct dt_arrays; for the files of this room only. */
#pragma once

#include "core/delaunay_arrays.h"
#include "core/set/set.h"

struct dt_arrays {
    struct dt *t;       /* owns */
    uint32_t *place_of; /* owns; by record of the mesh, as in dt_flat_rows; NULL: no mesh */
    uint32_t *heirs;    /* owns; aliases, by representative and then by id; NULL: there are none */
    uint32_t *first_heir; /* owns n + 1; by id: where the aliases of that representative begin */
    double size;          /* the sum of the sides of the box of all points */
};

/* The row of a half edge's triangle in DT_TRIANGLES, DT_NONE for a ghost. */
static inline uint32_t dt_row_of(const struct dt_arrays *a, uint32_t half)
{
    uint32_t place = a->place_of[half >> 3];
    return place == DT_NONE ? DT_NONE : place / 4;
}

/* A place that predicates can take, from one of which each coordinate is at most 2^201; false: it is not. */
static inline bool dt_place_ok(struct dt_point *q)
{
    if (!(fabs(q->x) <= 0x1p201 && fabs(q->y) <= 0x1p201))
        return false;
    q->x = fabs(q->x) < 0x1p-142 ? 0 : q->x;
    q->y = fabs(q->y) < 0x1p-142 ? 0 : q->y;
    return true;
}

/* For a place that the caller found outside the hull, beyond the edge of the ghost at `half`. Returns the half edge, within
 * the hull, of the edge that the place would be on without rounding (delaunay_arrays.h). DT_NONE: it is outside. *along:
 * its position on that edge, from 0 at the origin to 1. */
uint32_t dt_beside_hull(const struct dt_arrays *a, struct dt_point q, uint32_t half, double tol,
                        double *along);
