/* mend.h - flips that make a triangulation constrained Delaunay: every edge that is not fixed becomes locally Delaunay
 * under the perturbation, which determines the triangulation (PROTOCOL.md; flip.c says why flips end). */
#pragma once

#include "core/mesh/mesh.h"
#include "core/points/changes.h"

/* Half edges of edges that may not be Delaunay. Start with {0}. */
struct dt_suspects {
    struct dt_ids half; /* owns */
    bool lost;          /* out of memory: one is missing */
};

void dt_suspects_clear(struct dt_suspects *s);

/* Adds one; out of memory, *s is lost. */
void dt_suspect(struct dt_suspects *s, uint32_t h);

/* Whether the edge of h must be flipped: it is neither fixed nor at the hull, and not locally Delaunay. */
bool dt_must_flip(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h);

/* Flips the edge of h, and notifies changes, which may be NULL, of the stars that change. */
void dt_flip_noting(struct dt_mesh *m, uint32_t h, const struct dt_changes *changes);

/* Flips what is not Delaunay among the suspects, and what that makes suspect; none is left then, and *s is not lost.
 * changes, which may be NULL, is notified of the stars that change. Out of memory, it looks at all edges instead. */
void dt_mend(struct dt_mesh *m, const struct dt_point *xy, struct dt_suspects *s,
             const struct dt_changes *changes);
