/* tour.h - the natural neighbours of a place q inside the hull, and how the Voronoi cell that q would have lies
 * over the cells that are there.
 *
 * The triangles whose circumcircles have q strictly inside form a disc without inner vertices. Its rim are the
 * natural neighbours v0, v1, ... of q, counterclockwise. The tour visits the disc from its first triangle, depth
 * first and counterclockwise, and so turns about one rim vertex after the other: between the rim edges
 * v(i-1) v(i) and v(i) v(i+1) it passes the triangles at v(i), in order. The circumcentres on the way are the
 * corners of the part of v(i)'s old cell that q takes.
 *
 *          v2 ------ v1            ENTER v0 v1 v3
 *          | \       |             RIM v0 v1
 *          |   \  q  |             ENTER v1 v2 v3, RIM v1 v2, RIM v2 v3, LEAVE
 *          |     \   |             RIM v3 v0
 *          v3 ------ v0
 *
 * Strictly: corners of a cocircular polygon are all in the disc or only its rim, so the tour does not depend on
 * how ties were broken. It copies the places that it meets, so computations from it do not need the mesh. */
#ifndef DT_TOUR_H
#define DT_TOUR_H

#include "core/set/set.h"

enum dt_tour_kind {
    DT_TOUR_ENTER, /* the triangle p, adjacent to the one before */
    DT_TOUR_RIM,   /* the rim edge from p[0], the point `id`, to p[1] */
    DT_TOUR_LEAVE  /* back to the triangle that was entered as number `id`, counted from 0 */
};

struct dt_tour_step {
    enum dt_tour_kind kind;
    uint32_t id;
    struct dt_point p[3];
};

struct dt_tour_turn {
    uint32_t half;     /* to be crossed; DT_NONE: leave */
    uint32_t triangle; /* on this side, by its number in the tour */
};

/* Grows to what the largest tour needed. Start with {0}. */
struct dt_tour {
    struct dt_tour_step *step; /* owns */
    struct dt_tour_turn *turn; /* owns; a stack */
    uint32_t steps, turns, step_cap, turn_cap;
    uint32_t rims, triangles; /* steps of these kinds */
};

void dt_tour_clear(struct dt_tour *tour);

/* The tour from the triangle of the half edge `first`, in which q lies, strictly inside the hull; the first rim
 * edge begins at the origin of `first`. work may be NULL. Cost: the number of natural neighbours. */
enum dt_status dt_tour_make(const struct dt *t, struct dt_point q, uint32_t first,
                            struct dt_stop *work, struct dt_tour *tour);

#endif
