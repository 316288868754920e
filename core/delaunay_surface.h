/* delaunay_surface.h - the second part of the core's public header: what is computed from a triangulation when
 * its points carry values or cells. */
#ifndef DT_DELAUNAY_SURFACE_H
#define DT_DELAUNAY_SURFACE_H

#include "core/delaunay.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- weights: with which weights the values at points count at a place between them ---- */

enum dt_interpolation {
    DT_LINEAR,  /* in the triangle around the place; canonical, like the triangulation */
    DT_NATURAL, /* Sibson's, of natural neighbours: smooth except at the points */
    DT_LAPLACE  /* of natural neighbours, by the edges of Voronoi cells: continuous */
};

/* The errors of the weights at a place add up to less than this. So the weighted mean of the points is the
 * place, within this times the distance of the farthest of them. */
#define DT_WEIGHTS_ERROR 0x1p-40

struct dt_weight {
    uint32_t id;
    double weight; /* at least 0 */
};

/* Reads what the weights at q are computed from into *out, which the caller frees. opt may be NULL: its flag and
 * its steps. Cost: that of dt_locate and the number of natural neighbours. */
struct dt_weigher;
enum dt_status dt_weights_begin(const struct dt *t, struct dt_point q, enum dt_interpolation how,
                                const struct dt_options *opt, struct dt_weigher **out);

/* The bytes that it holds, and those that dt_weights_end takes at most: limited as below, or `exact`, not so. */
size_t dt_weights_memory(const struct dt_weigher *w, bool exact);

/* The *n weights, by ascending ids, in *out, which the caller frees; none outside the hull; at a point 1; on an
 * edge of the hull linear along the edge. Does not read the set. opt may be NULL: its flag is polled. Cost: the
 * number of natural neighbours; some thousand times as much where double words are not exact enough: DT_TOOLONG
 * then if opt limits the steps, and it may be called again. */
enum dt_status dt_weights_end(struct dt_weigher *w, const struct dt_options *opt,
                              struct dt_weight **out, size_t *n);

void dt_weights_free(struct dt_weigher *w); /* NULL: nothing */

#ifdef __cplusplus
}
#endif

#endif
