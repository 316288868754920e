/* nearest.h - the common parts of searches by distance: a nearest vertex, and the comparison of distances.
 *
 * They rely on two facts about Delaunay triangulations, which do not hold with constraints (nearest_fixed.c). Let q be
 * any place.
 *
 * 1. A vertex none of whose neighbours is nearer to q is a nearest vertex: q lies in its Voronoi cell, whose sides all
 *    belong to neighbours. So going to a nearer neighbour as long as one exists finds a nearest vertex.
 * 2. Every vertex p that is not a nearest one has a neighbour strictly nearer to q. Let a disc grow from p, its centre
 *    moving from p to q, until its circle meets another vertex. This vertex is a neighbour, and lies in the disc around
 *    q through p. So the nearest k vertices, and all within a radius, are connected by edges.
 *
 * If several vertices tie as nearest, they are the corners of one empty circle around q, which its triangulation connects. */
#pragma once

#include "core/exact/predicates.h"
#include "core/set/set.h"

#include <math.h>

/* A vertex, and the rounded square of its distance from the place of the search. */
struct dt_candidate {
    double d;
    uint32_t v;
};

static inline struct dt_candidate dt_candidate(const struct dt *t, struct dt_point q, uint32_t v)
{
    return (struct dt_candidate){dt_square_distance(t->points.xy[v], q), v};
}

/* < 0 if a is nearer to q than b, exactly. */
static inline int dt_compare_candidates(const struct dt *t, struct dt_point q,
                                        struct dt_candidate a, struct dt_candidate b)
{
    if (dt_squares_decide(a.d, b.d))
        return a.d < b.d ? -1 : 1;
    return dt_compare_distance(q, t->points.xy[a.v], t->points.xy[b.v]);
}

/* A lower bound of the square of the distance of q from the edge p-r. The place on the edge that is computed errs by a
 * few roundings of the distances of p and r from q. */
static inline double dt_edge_least(struct dt_point q, struct dt_point p, struct dt_point r)
{
    double px = p.x - q.x, py = p.y - q.y, dx = r.x - p.x, dy = r.y - p.y;
    double along = -(px * dx + py * dy) / (dx * dx + dy * dy);
    along = along > 0 ? (along < 1 ? along : 1) : 0;
    double x = px + along * dx, y = py + along * dy;
    double error = 0x1p-46 * (fabs(px) + fabs(py) + fabs(dx) + fabs(dy));
    double least = sqrt(x * x + y * y) - error;
    return least > 0 ? least * least * (1 - 0x1p-46) : 0;
}

/* *nearest: a vertex such that no other is nearer to the place; *tie: other vertices are as near. At least one vertex
 * must exist. Exact. The cost of the search is taken off the work. Cost: constant expected; at a vertex of high degree,
 * the root of the number of triangles. */
enum dt_status dt_nearest_vertex(const struct dt *t, const struct dt_place *q, struct dt_stop *work,
                                 uint32_t *nearest, bool *tie);

/* dt_nearest_place, whose steps are taken off the work. */
enum dt_status dt_nearest_within_work(const struct dt *t, const struct dt_place *q, uint32_t k,
                                      struct dt_stop *work, struct dt_ids *out);

/* The nearest k vertices in a mesh with fixed edges, whose points are not all on one line. Appends vertices. */
enum dt_status dt_nearest_fixed(const struct dt *t, const struct dt_place *q, uint32_t k,
                                struct dt_stop *work, struct dt_ids *out);

/* Appends the neighbours of v, a vertex nearest to q, that are as near, possibly some of them twice. */
enum dt_status dt_nearest_ties(const struct dt *t, struct dt_point q, uint32_t v,
                               struct dt_stop *work, struct dt_ids *ties);
