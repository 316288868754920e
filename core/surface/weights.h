/* weights.h - the weights of the values at points for a place between them. */
#ifndef DT_WEIGHTS_H
#define DT_WEIGHTS_H

#include "core/delaunay_surface.h"
#include "core/set/set.h"
#include "core/surface/tour.h"

/* What one place after the other is computed in. It grows to what the largest one needed. Start with {0}. */
struct dt_weigher {
    uint32_t *id;   /* owns: the n points that count, counterclockwise around the place */
    double *weight; /* owns: their weights, at least 0, with the sum 1 */
    size_t n, cap;
    /* private */
    enum dt_interpolation how;
    struct dt_point place;
    bool by_cells, in_triangle; /* what is still to be computed */
    struct dt_point corner[3];  /* of the triangle */
    struct dt_tour tour;
    void *room; /* owns */
    size_t room_cap;
};

/* Frees what it owns. */
void dt_weigher_clear(struct dt_weigher *w);

/* Reads from the set what the weights at q take, and which points count: none if q is outside the hull. where
 * and half: as dt_find has found (half: DT_NONE for a set of one point). work may be NULL. Cost: the number of
 * natural neighbours. */
enum dt_status dt_weigh_begin(const struct dt *t, struct dt_point q, enum dt_where where,
                              uint32_t half, enum dt_interpolation how, struct dt_stop *work,
                              struct dt_weigher *w);

/* Where rounding begins, so that the same set gives the same bytes: the half edge of the triangle around the place, or
 * of the first of the two at its edge, that leaves the corner with the smallest id. */
uint32_t dt_weigh_start(const struct dt *t, enum dt_where where, uint32_t half);

/* Computes the weights. DT_CANCELLED, DT_NOMEM; with `quick` DT_TOOLONG where double words are not exact enough.
 * cancel may be NULL. Cost: the same; some ten times as much where doubles are not enough, and some thousand
 * times where double words are not. */
enum dt_status dt_weigh_end(struct dt_weigher *w, bool quick, const atomic_bool *cancel);

#endif
