/* rings.h - polygons with holes, from the loops of an alpha shape. */
#ifndef CLIENTS_RINGS_H
#define CLIENTS_RINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "clients/meshes/crs.h"

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
    const struct crs *crs; /* the caller's: of the coordinates; may be NULL */
    const char *fault;     /* why a function returned false: a static sentence */
};

/* Takes a row `outer k id1 ... idk` or `hole k id1 ... idk` of ALPHA. *r must be zeroed. */
bool rings_take(struct rings *r, const char *row, size_t len);
void rings_free(struct rings *r);

/* Finds the outer ring around each hole, which fills in `outer` and `next`. False: see r->fault. Cost:
 * about O(corners), and for each hole O(sqrt(corners)). */
bool rings_place(struct rings *r);

/* The number of outer rings. */
size_t rings_outer(const struct rings *r);

/* After rings_place, writes a FeatureCollection: for each outer ring a Polygon with its holes and the properties radius and holes. Or the
 * same as a table with a column WKT. ferror() shows whether writing failed. */
void rings_write_geojson(FILE *out, const struct rings *r, const char *radius);
void rings_write_wkt(FILE *out, const struct rings *r, const char *radius);

#endif
