/* faces.h - the parts that the constrained edges of a triangulation separate: faces, the largest parts without such an edge inside. */
#pragma once

#include "clients/meshes/model.h"

struct faces {
    uint32_t *face; /* owns: of each triangle */
    size_t n;
    /* owns n: no triangle of the face is at the hull without a constrained edge between */
    bool *enclosed;
};

/* The model has triangles and fixed edges; sides are sides of the model. False when out of memory; faces_free in any case. Cost:
 * O(triangles log edges). */
bool faces_init(struct faces *f, const struct model *m, const struct sides *sides);
void faces_free(struct faces *f);
