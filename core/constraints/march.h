/* march.h - the straight way through a mesh from a vertex: the edges that it crosses, the vertices that it runs through.
 *
 *            w
 *          / | \
 *    from ---|---> x --> q
 *          \ | /
 *            u
 *
 * A way goes from the vertex `from` to the place q, whose triangle is unknown. It crosses half edges u->w, whose triangles are
 * on the side of `from`: u is to the right of the way, w to the left. If a vertex lies exactly on the way, the next part
 * begins. All signs are exact, and each step comes nearer to q, so it ends in any triangulation.
 */
#pragma once

#include "core/exact/predicates.h"
#include "core/mesh/mesh.h"

enum dt_march_step {
    DT_MARCH_ALONG, /* `half` is an edge from `from` to a vertex on the way */
    DT_MARCH_CROSS, /* the way crosses `half` */
    DT_MARCH_OUT    /* it leaves the hull at `from`: `half` is a ghost beyond whose edge q lies */
};

/* The step by which the way from the vertex begins, ALONG, CROSS or OUT; *half as above. near: a half edge that leaves
 * the vertex. Cost: its degree. */
enum dt_march_step dt_march_begin(const struct dt_mesh *m, const struct dt_point *xy, uint32_t near,
                                  struct dt_point q, uint32_t *half);

/* The same from either end of a segment between two vertices, whichever has the smaller degree: *swapped says that the
 * way is from b to a. Never OUT. Cost: the smaller degree. */
enum dt_march_step dt_march_between(const struct dt_mesh *m, const struct dt_point *xy, uint32_t a,
                                    uint32_t b, uint32_t *half, bool *swapped);

/* Locates q in a mesh whose points are not all on one line, as dt_walk does (core/query/locate.h), by the
 * straight way from a corner of the triangle of h. Cost: the triangles between. */
enum dt_where dt_march_to(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                          struct dt_point q, uint32_t *half);

/* The edge crossed after `half`, where the apex of its twin does not lie on the way from p to q. */
static inline uint32_t dt_march_next(const struct dt_mesh *m, uint32_t half, int side_of_apex)
{
    uint32_t g = dt_twin(m, half);
    return side_of_apex > 0 ? dt_next(g) : dt_prev(g);
}
