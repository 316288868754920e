/* fixed.h - the edges of a mesh that must stay: those that constraints cover.
 *
 * The fourth word of a triangle's record (mesh.h) has a bit for each of its half edges: bit k is set if half edge 8t + k
 * is fixed. Then its twin is fixed, too. A mesh without fixed edges has m->fixed == NULL. These words then mean nothing,
 * so that builds and edits need not write them.
 *
 * The other 29 bits of the word are the number of a face: the same for all triangles that are connected without a fixed
 * edge in between (core/constraints/regions.h). They may mean nothing, but edits carry them from triangles to the triangles
 * that replace them.
 *
 * Several constraints may cover an edge. An edge that is fixed is covered once, unless the table says how many times
 * more. */
#pragma once

#include "core/mesh/mesh.h"

/* Prepares for fixed edges: clears the bits of all triangles. Does nothing if m->fixed exists. Cost: linear. */
enum dt_status dt_fixed_begin(struct dt_mesh *m);

/* Whether the edge of h is fixed. */
static inline bool dt_is_fixed(const struct dt_mesh *m, uint32_t h)
{
    return m->fixed != NULL && (m->half[h | 3] >> (h & 3) & 1) != 0;
}

/* Whether some edge of the triangle of h is fixed; m->fixed exists. */
static inline bool dt_has_fixed(const struct dt_mesh *m, uint32_t h)
{
    return (m->half[h | 3] & 7) != 0;
}

/* Sets or clears the bit of h alone. */
static inline void dt_fixed_mark(struct dt_mesh *m, uint32_t h, bool fixed)
{
    uint32_t bit = 1u << (h & 3), *word = &m->half[h | 3];
    *word = fixed ? *word | bit : *word & ~bit;
}

/* The face of the triangle of h. */
static inline uint32_t dt_face(const struct dt_mesh *m, uint32_t h)
{
    return m->half[h | 3] >> 3;
}

/* The triangle of h belongs to the face; none of its edges is fixed. */
static inline void dt_face_begin(struct dt_mesh *m, uint32_t h, uint32_t face)
{
    m->half[h | 3] = face << 3;
}

/* The same, and its edges are fixed as they are. */
static inline void dt_face_set(struct dt_mesh *m, uint32_t h, uint32_t face)
{
    m->half[h | 3] = (m->half[h | 3] & 7) | face << 3;
}

/* Returns how many constraints cover the edge of h. */
uint32_t dt_fixed_count(const struct dt_mesh *m, uint32_t h);

/* Makes room so that n calls of dt_fix cannot fail. */
enum dt_status dt_fixed_reserve(struct dt_mesh *m, size_t n);

/* n constraints more, or fewer, cover the edge of h, both sides; n > 0. For more there must be room. */
void dt_fix(struct dt_mesh *m, uint32_t h, uint32_t n);
void dt_unfix(struct dt_mesh *m, uint32_t h, uint32_t n);
