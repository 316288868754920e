/* pocket.h - fills a polygon with triangles, ear by ear.
 *
 *         P3 ------ P2              A polygon P[0], ..., P[n - 1], counterclockwise, without vertices inside. The edge from the
 *        /  '.        \             last corner to the first is only made by the filling. Corners may be the same vertex, where
 *      P4     '.       P1           an edge sticks out into the polygon and has it on both sides.
 *        \      '.    /
 *         P5 ..... P0               An ear is a corner that turns left and from whose triangle the rest of the polygon stays
 * away. Here every corner is visible from the closing edge, so nothing can lie between a corner and there: a corner that
 * turns left is an ear. There is one as long as the polygon is no triangle, since every triangulation of it has two. */
#pragma once

#include "core/constraints/mend.h"
#include "core/mesh/mesh.h"

/* The edge from this corner to the next one. */
struct dt_side {
    uint32_t origin; /* the corner */
    /* the half edge beyond; with DT_SIDE_INNER: a half edge on the inside, of a triangle that is going to be
     * replaced: what is beyond is its twin, when the triangle here is made */
    uint32_t half;
    uint32_t prev, next;
};

#define DT_SIDE_INNER 4u

/* Start with {0}. */
struct dt_pocket {
    struct dt_side *side; /* owns `cap` */
    uint32_t n;
    size_t cap;
    uint32_t face; /* of its triangles (core/mesh/fixed.h) */
};

void dt_pocket_clear(struct dt_pocket *p);

/* Makes room for n sides. */
enum dt_status dt_pocket_reserve(struct dt_pocket *p, size_t n);

/* Adds a side; there must be room. */
static inline void dt_pocket_add(struct dt_pocket *p, uint32_t origin, uint32_t half)
{
    p->side[p->n++] = (struct dt_side){.origin = origin, .half = half};
}

/* Fills the polygon with triangles in the records spare[], of which it takes n - 2 from the end; *spares is how many
 * are left. Fixed edges stay fixed; the new ones are not, and are suspect. Vertices leave by the new triangles
 * (leaving[], hull.h). Returns the half edge from the last corner to the first that the filling has made. A polygon of
 * two corners has no triangle: then it returns what is beyond its only side. Cost: linear where few corners must be
 * tried again. */
uint32_t dt_pocket_fill(struct dt_pocket *p, struct dt_mesh *m, const struct dt_point *xy,
                        const uint32_t *spare, uint32_t *spares, struct dt_suspects *suspects);
