/* diagonal.h - the flip of an edge: the other diagonal of the quadrilateral of its two triangles.
 *
 *            c                         c
 *          /   \                     / | \
 *        /       \                 /   |   \        h:  a->b, its twin b->a. The records stay within
 *       a ------- b       ->      a    |    b       the quadrilateral: b->c and a->d keep their half
 *        \   h   /                 \   |   /        edges, d->b becomes h, c->a becomes the twin, and
 *          \   /                     \ | /          the diagonal c->d prev(h).
 *            d                         d
 */
#pragma once

#include "core/mesh/mesh.h"

/* Flips the edge of h, which is not fixed. */
void dt_flip(struct dt_mesh *m, uint32_t h);

/* The inverse of dt_flip(m, h). */
void dt_flip_back(struct dt_mesh *m, uint32_t h);
