/* hull.h - the convex hull as the mesh has it: a cycle of ghosts.
 *
 * The ghost of a hull vertex v lies beyond the hull edge from v to its counterclockwise successor
 * s:
 *
 *          s <------- g: s -> v, its twin v -> s is the hull edge, the hull on its left
 *         /    ghost  g + 1: v -> infinity
 *        v            g + 2: infinity -> s
 *
 * All points on one line: the cycle runs along one side of the line and back along the other. So a
 * vertex between the ends has two ghosts, one for each direction. */
#pragma once

#include "core/control/stop.h"
#include "core/mesh/mesh.h"

/* Settles a mesh that was just built, of which `ghost` is some ghost: leaving[] of every hull vertex becomes its half edge
 * to infinity, and m->hull this ghost. stop may be NULL. Returns the number of ghosts. Cost: O(hull). */
uint32_t dt_hull_settle(struct dt_mesh *m, uint32_t ghost, struct dt_stop *stop);

/* Whether the vertex v of a settled mesh lies on the hull. */
static inline bool dt_on_hull(const struct dt_mesh *m, uint32_t v)
{
    uint32_t h = m->leaving[v];
    return h == DT_NONE || dt_is_ghost(m, h);
}

/* For edits: vertex u may leave by the half edge h; leaving[u] is kept if it still goes to
 * infinity. (If h does, it is the same one.) Half edges to infinity are the second ones of their
 * triangles, so most of the others need not be looked at. */
static inline void dt_hull_keep(struct dt_mesh *m, uint32_t u, uint32_t h)
{
    uint32_t old = m->leaving[u];
    if ((old & 3) != 1 || m->half[old] != u || m->half[old + 1] != DT_NONE)
        m->leaving[u] = h;
}

/* The ghost of a hull vertex of a settled mesh that has an edge. */
static inline uint32_t dt_hull_ghost(const struct dt_mesh *m, uint32_t v)
{
    return dt_base(m->leaving[v]);
}

/* The vertex whose ghost g is, and its successor. */
static inline uint32_t dt_hull_vertex(const struct dt_mesh *m, uint32_t g)
{
    return m->half[g + 1];
}

static inline uint32_t dt_hull_successor(const struct dt_mesh *m, uint32_t g)
{
    return m->half[g];
}

/* The next ghost along the hull, counterclockwise or clockwise. */
static inline uint32_t dt_hull_step(const struct dt_mesh *m, uint32_t g, bool cw)
{
    return dt_base(dt_twin(m, cw ? g + 1 : g + 2));
}

/* All points on one line: whether the walk turns back after g, that is, g's successor is an end of the line. */
static inline bool dt_hull_turns(const struct dt_mesh *m, uint32_t g)
{
    return dt_twin(m, g) == dt_hull_step(m, g, false);
}

/* The ghost at which the hull begins in canonical order: the ghost of the smallest id. On a line it is the ghost of
 * the end with the smaller id or, clockwise, of the other end. DT_NONE if there is no edge. Cost: O(hull). */
uint32_t dt_hull_first(const struct dt_mesh *m, const uint32_t *id, bool cw);
