/* rings.h - polygons with holes, from the loops of an alpha shape. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/surfaces/shapes.h"

struct ring {
    bool hole;
    size_t first, n; /* its corners: first .. first + n of the ids and places */
    size_t outer;    /* of a hole: the ring that it is in; of an outer ring: itself */
    size_t next; /* of an outer ring: its first hole; of a hole: the next one; at the end rings.n */
};

struct rings {
    struct ring *ring; /* owns n, room for cap */
    size_t n, cap;
    uint32_t *id; /* owns: of the corners */
    double *xy;   /* owns 2 * corners, to be filled in by the caller before rings_place */
    size_t corners, corners_cap;
    const char *fault; /* why a function returned false: a static sentence */
};

/* Takes a row `outer k id1 ... idk` or `hole k id1 ... idk` of ALPHA. *r must be zeroed. */
bool rings_take(struct rings *r, const char *row, size_t len);
void rings_free(struct rings *r);

/* Finds the outer ring around each hole, which fills in `outer` and `next`. False: see r->fault. Cost:
 * about O(corners), and for each hole O(sqrt(corners)). */
bool rings_place(struct rings *r);

/* After rings_place, appends to *s, whose kind is SHAPE_RING, each outer ring and after it its holes. False: see r->fault. */
bool rings_to_shapes(struct rings *r, double radius, struct shapes *s);
