/* refiner.h - adds points to a triangulation until its triangles are as wanted: Delaunay refinement.
 *
 *        r                 A triangle with too small an angle gets a point at the centre of its circle, or nearer to its
 *       / \                shortest edge p-q: at the off-centre c, where p, q and c have just the wanted angle [Uengoer 2004]. If
 *      / . \  <- c         the point is in the circle around a fixed edge (encroaches upon it), or the way to it crosses a fixed edge,
 *     / . . \              that edge is divided instead [Ruppert 1995].
 *    p-------q
 *
 * An edge is divided in the middle; but near a vertex where fixed edges make a small angle, at a distance from it that is
 * a power of two: so points there lie on circles around it (concentric shells), and do not encroach upon each other's
 * edges. A triangle between two such points across the small angle stays as it is.
 *
 * A triangle with an edge that is too long gets its point nearer, too: where the sides over its shortest edge are 0.96 of the limit.
 *
 * Triangles with the shortest edges come first [Shewchuk, Triangle 1.6]; if no angle is small and no edge is much longer than another,
 * the largest.
 *
 * The refiner works on a set of its own, which has been built in one way, and where vertices are numbered by arrival. So all that it
 * does depends on what that was built from alone. */
#pragma once

#include "core/constraints/mend.h"
#include "core/refining/quality.h"
#include "core/refining/queue.h"
#include "core/set/set.h"

/* A half edge, as long as it leads from a to b. */
struct dt_part {
    uint32_t h, a, b;
};

/* An edge from a to b that has been divided at the vertex `middle`; a < b. */
struct dt_halved {
    uint32_t a, b, middle;
};

struct dt_part_list {
    struct dt_part *v;    /* owns */
    size_t n, cap, taken; /* the first `taken` are done */
};

struct dt_refiner {
    struct dt *t; /* owns */
    struct dt_enclosure in;
    struct dt_wanted wanted;
    struct dt_stop *work; /* borrows */
    bool keep;            /* edges are not divided */
    uint32_t given;       /* vertices that there were */
    uint32_t most;        /* that may be added, */
    uint32_t granted;     /* and for which there is memory; `grant` asks for more */
    enum dt_status (*grant)(void *ctx, uint32_t n);
    void *ctx;
    struct dt_halved *halved; /* owns */
    size_t n_halved, halved_cap;
    /* owns; of each new vertex, the first edge that it divides: a and b; a == DT_NONE: none */
    struct dt_part *edge;
    size_t edge_cap;
    struct dt_queue queue;
    struct dt_part_list encroached; /* edges to be divided */
    struct dt_suspects suspects;
    struct dt_ids changed; /* owns: vertices whose stars flips have changed */
};

/* Adds points to r->t, which has been surveyed, until it is as wanted or has r->most more. */
enum dt_status dt_refiner_run(struct dt_refiner *r);

void dt_refiner_clear(struct dt_refiner *r);
