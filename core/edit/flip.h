/* flip.h - a vertex moves within its star: the edges stay at first, then flips repair those that are no
 * longer Delaunay.
 *
 *      O ------- P              The star of v allows a place if every triangle (v, P, Q) still turns
 *       \  .   . / \            left there. Then the triangles are a triangulation as before, and only
 *        \   v  /   W           the spokes v-P and the rim edges P-Q may have a neighbour inside their
 *         \  . /   /            circles. Flips end in the canonical triangulation [Lawson 1977]: core/edit/flip.c.
 *          \  Q --'
 */
#pragma once

#include "core/mesh/cavity.h"

enum { DT_FLIPS = 256 }; /* a move that needs more is left to dt_remove and dt_insert */

/* Edges to be looked at, and those that have been flipped. */
struct dt_flips {
    uint32_t suspects, flipped;
    uint32_t suspect[4 * DT_FLIPS], flip[DT_FLIPS]; /* half edges */
};

/* *allowed: whether the star of vertex v allows it to move from xy[v] to `to`. False for vertices on the hull, and if very
 * many edges would have to be flipped. False for vertices with fixed edges, unless these are `bound` to the vertex and
 * move along. *f gets the edges of the star that are not Delaunay after the move. Nothing is changed. Cost: the degree
 * of v, taken off the work. */
enum dt_status dt_star_allows(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                              struct dt_point to, bool bound, struct dt_stop *work,
                              struct dt_flips *f, bool *allowed);

/* v has moved, as its star allowed: flips the edges that are not Delaunay. scratch: has the work, and the
 * callback for changed stars. A failure (the end of the work; DT_TOOBIG: too many flips) leaves the mesh with
 * the edges that it had. */
enum dt_status dt_flip_all(struct dt_mesh *m, const struct dt_point *xy, struct dt_flips *f,
                           const struct dt_cavity *scratch);
