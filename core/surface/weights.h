/* weights.h - the weights of the values at points for a place q between them.
 *
 * Inside the hull they are computed from a tour around q. It shows how the Voronoi cell that q would have lies over the
 * existing cells. The triangles whose circumcircles have q strictly inside form a disc without inner vertices. Its
 * rim are the natural neighbours v0, v1, ... of q, counterclockwise.
 *
 * The tour visits the disc from its first triangle, depth first and counterclockwise. So it turns about one rim vertex after
 * the other: between the rim edges v(i-1) v(i) and v(i) v(i+1) it passes the triangles at v(i), in order. The circumcentres
 * on the way are the corners of the part of v(i)'s old cell that q takes.
 *
 *          v2 ------ v1            ENTER v0 v1 v3
 *          | \       |             RIM v0 v1
 *          |   \  q  |             ENTER v1 v2 v3, RIM v1 v2, RIM v2 v3, LEAVE
 *          |     \   |             RIM v3 v0
 *          v3 ------ v0
 *
 * Strictly: corners of a cocircular polygon are all in the disc or only its rim, so the tour does not depend on
 * how ties were broken. It copies the places that it meets, so that weights are computed without the mesh. */
#pragma once

#include "core/delaunay_surface.h"
#include "core/set/set.h"

enum dt_tour_kind {
    DT_TOUR_ENTER, /* the triangle p, adjacent to the one before */
    DT_TOUR_RIM,   /* the rim edge from p[0] to p[1] */
    DT_TOUR_LEAVE  /* back to a triangle that was entered */
};

struct dt_tour_step {
    enum dt_tour_kind kind;
    uint32_t triangle; /* that is entered, or returned to: by its number in the tour, from 0 on */
    struct dt_point p[3];
};

struct dt_tour_turn {
    uint32_t half;     /* to be crossed; DT_NONE: leave */
    uint32_t triangle; /* on this side */
};

/* The work space for one place after the other. It grows to the size of the largest one. Start with {0}. */
struct dt_weigher {
    uint32_t *id;   /* owns cap: the n points that count, counterclockwise; those of the rim */
    double *weight; /* owns cap: their weights, at least 0, with the sum 1 */
    uint32_t n;
    bool long_doubles; /* doubles were not exact enough for them */
    /* private */
    enum dt_interpolation how;
    struct dt_point place;
    struct dt_tour_step *step; /* owns cap; none: weights are there already; linear: a triangle */
    struct dt_tour_turn *turn; /* owns 2 cap + 3; a stack */
    uint32_t steps, turns, triangles, cap;
};

/* Frees what it owns. */
void dt_weigher_clear(struct dt_weigher *w);

/* Reads from the set the data of the weights at q, and the points that count: none if q is outside the hull. The caller got
 * `where` and `half` from dt_find (half: DT_NONE for a set of one point). The work may be NULL. Cost: the number of
 * natural neighbours. */
enum dt_status dt_weigh_begin(const struct dt *t, struct dt_point q, enum dt_where where,
                              uint32_t half, enum dt_interpolation how, struct dt_stop *work,
                              struct dt_weigher *w);

/* Whether only the ends of the edge count on which the place is: linear along it. */
static inline bool dt_weigh_along_edge(const struct dt *t, enum dt_where where, uint32_t half,
                                       enum dt_interpolation how)
{
    return where == DT_ON_EDGE && (how == DT_LINEAR || dt_is_ghost(&t->mesh, half) ||
                                   dt_is_ghost(&t->mesh, dt_twin(&t->mesh, half)));
}

/* The weights of the ends of the hull's edge of the ghost at the place inside of it that is nearest to q: linear along the edge. Each
 * errs by less than DT_WEIGHTS_ERROR / 4. DT_NOMEM. Cost: constant; larger if q is far away. */
#define DT_FOOT_NEAR 0x1p6 /* how far q may be for doubles, see weights_formula.h */
#define DT_FOOT_ERROR (DT_WEIGHTS_ERROR / 8)
enum dt_status dt_weigh_foot(const struct dt *t, struct dt_point q, uint32_t ghost,
                             struct dt_weigher *w);

/* The half edge at which rounding begins, so that the same set gives the same bytes. It leaves the corner with the smallest id
 * in the triangle around the place, or in the first of the two triangles at its edge. */
uint32_t dt_weigh_start(const struct dt *t, enum dt_where where, uint32_t half);

/* Computes the weights. DT_CANCELLED, DT_NOMEM; if the work is limited, DT_TOOLONG if double words are not exact
 * enough. It takes no steps. Cost: the same; some ten times more if doubles are not enough, and some thousand times
 * more if double words are not. The flag is polled. */
enum dt_status dt_weigh_end(struct dt_weigher *w, const struct dt_stop *work);
