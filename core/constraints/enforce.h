/* enforce.h - makes a segment between two vertices a chain of fixed edges, and releases it again.
 *
 *          w1 --- w2                      w1 --- w2          The triangles that the segment crosses become two polygons, one
 *         / \    /  \                    / \     . \         on either side of it. Their corners are visible from the
 *        a - -\-/- - b         ->       a ---------- b       segment, so they can be filled (pocket.h), and flips make them
 *         \    u    /                    \  '-u-'   /        Delaunay (mend.h) [Anglada 1997; Shewchuk & Brown 2015].
 *          '-------'                      '-------'
 *
 * Vertices exactly on the segment divide it into parts. */
#pragma once

#include "core/constraints/pocket.h"
#include "core/control/stop.h"

/* Scratch memory that successive calls reuse. Start with {0}. */
struct dt_enforcer {
    struct dt_mesh *mesh; /* borrows, as the next two */
    const struct dt_point *xy;
    const struct dt_changes *changes; /* NULL: not needed */
    struct dt_ids step;               /* owns: the way, as half edges; see enforce.c */
    struct dt_ids crossed;            /* owns: the fixed edges that it crosses */
    struct dt_ids spare;              /* owns: records for new triangles */
    struct dt_pocket pocket;
    struct dt_suspects suspects;
};

void dt_enforcer_clear(struct dt_enforcer *e);
size_t dt_enforcer_memory(const struct dt_enforcer *e);

/* Adds one to the times that the edge between two vertices is fixed, if there is such an edge; *done. Cost: the smaller degree. */
enum dt_status dt_enforce_edge(struct dt_enforcer *e, uint32_t a, uint32_t b, struct dt_stop *work,
                               bool *done);

/* Finds the way from vertex a to vertex b, a != b, in the mesh, which has two vertices at least; nothing is changed.
 * The fixed edges that it crosses are in e->crossed then; only if there are none, it can be fixed. */
enum dt_status dt_enforce_look(struct dt_enforcer *e, uint32_t a, uint32_t b, struct dt_stop *work);

/* Adds one to the times that the way just found is fixed. DT_NOMEM from dt_enforce: nothing is changed. Afterwards dt_enforce_mend is
 * due, which may follow several ways. The mesh has dt_fixed_begin behind it. */
enum dt_status dt_enforce(struct dt_enforcer *e);

/* Fixes the chain of edges from a to b, all of which are fixed, once less. Then dt_enforce_mend is due. */
void dt_enforce_release(struct dt_enforcer *e, uint32_t a, uint32_t b);

/* Makes the mesh constrained Delaunay again. */
void dt_enforce_mend(struct dt_enforcer *e);

/* All of this for the segment between two vertices, which may be the same. DT_CROSSES: it would cross fixed edges; e->crossed has them. */
enum dt_status dt_enforce_segment(struct dt_enforcer *e, uint32_t a, uint32_t b,
                                  struct dt_stop *work);

/* Adds a flag to the faces of the triangles on both sides of every edge of the way just found: of all triangles that it meets, except at
 * their corners. */
void dt_enforce_flag(struct dt_enforcer *e, uint32_t flag);

/* Of a chain of fixed edges, from the vertex that half leaves: the fixed half edge from there to the next vertex in
 * the direction of q; DT_NONE: there is none. Cost: the degree. */
uint32_t dt_chain_next(const struct dt_mesh *m, const struct dt_point *xy, uint32_t near,
                       struct dt_point q);
