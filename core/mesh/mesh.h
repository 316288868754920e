/* mesh.h - the triangulation as half edges of triangles: topology only, no coordinates.
 *
 * A triangle t is a record of eight words, half a cache line. Its half edge h = 8t + k (k = 0, 1,
 * 2) runs counterclockwise from corner k to corner k + 1 with the triangle on its left:
 *
 *      half[8t + 0..2]   the three corners (vertices), the origins of the half edges
 *      half[8t + 3]      which of the half edges are fixed, and a number (fixed.h)
 *      half[8t + 4..6]   the twins of the half edges: the same edges seen from the triangles beyond
 *
 *                  v2
 *                 /  \            h      = 8t:  v0 -> v1
 *           8t+2 /    \ 8t+1      next(h) = 8t+1, prev(h) = 8t+2
 *               /  t   \          twin(h): v1 -> v0, in the triangle below
 *             v0 ------ v1
 *                 8t
 *
 * Ghosts close the plane to a sphere: beyond each hull edge b->a (interior on its left) lies the
 * ghost triangle (a, b, DT_NONE); the point at infinity is always corner 2. So every half edge has a twin, and
 * hull vertices need no special case. There are always 2n - 2 triangles, ghosts included, on n >= 2 vertices, and 3n - 3
 * edges, those to infinity included. Points on one line have ghosts only, two for each edge. One vertex has no
 * triangle at all.
 *
 * Every mesh that queries see is settled (core/mesh/hull.h): the half edge leaving[v] of a hull vertex v is
 * the one to infinity, so that one read distinguishes hull vertices from interior ones.
 *
 * A dead record (a hole to be used again) has DT_DEAD in corner 2. */
#pragma once

#include "core/delaunay.h"
#include "core/memory/memory.h"

#define DT_DEAD (UINT32_MAX - 1)

struct dt_more {
    uint32_t a, b; /* vertices, a < b; a == DT_NONE: free */
    uint32_t more; /* constraints that cover the edge beside the first one */
};

/* The edges that several constraints cover (fixed.h): a hash table with linear probing. */
struct dt_fixed {
    struct dt_more *more; /* owns `cap`, a power of two or 0 */
    uint32_t n, cap;
};

struct dt_mesh {
    struct dt_pages *pages; /* borrows; where its arrays come from; NULL: the system */
    uint32_t *half;         /* owns 8 * tri_cap words */
    uint32_t *leaving; /* owns vert_cap words: a half edge that leaves the vertex; DT_NONE if there
                          is none */
    uint32_t tri_cap, vert_cap;
    uint32_t tri_end;   /* records 0 .. tri_end - 1 are live or dead */
    uint32_t dead;      /* how many of them are dead */
    uint32_t free_list; /* a dead record, DT_NONE if none; corner 0 of a dead record holds the next
                           one */
    uint32_t ghosts;    /* how many of the live ones are ghosts */
    uint32_t vertices;  /* vertices that the triangulation has */
    bool recycled;  /* dead records have been reused elsewhere since the grid (hints.h) was built */
    uint32_t hull;  /* a ghost, if there is one: see dt_hull_settle */
    uint32_t alone; /* the vertex, if there is just one */
    struct dt_fixed *fixed; /* owns; NULL: no edge is constrained (fixed.h) */
};

/* *m must be zeroed or cleared; `pages` stays. */
void dt_mesh_clear(struct dt_mesh *m);

size_t dt_mesh_memory(const struct dt_mesh *m); /* bytes */

/* No edge is fixed any more. */
void dt_fixed_end(struct dt_mesh *m);

/* Makes room for vertices numbered below verts and for tris records in all. DT_NOMEM leaves *m
 * valid and unchanged. */
enum dt_status dt_mesh_reserve(struct dt_mesh *m, uint32_t verts, uint32_t tris);

/* Makes room for vertex v and for `tris` calls of dt_mesh_take; arrays grow by half, so that many
 * calls cost amortised constant time. DT_NOMEM: as above. */
enum dt_status dt_mesh_make_room(struct dt_mesh *m, uint32_t v, uint32_t tris);

static inline uint32_t dt_origin(const struct dt_mesh *m, uint32_t h)
{
    return m->half[h];
}

static inline uint32_t dt_twin(const struct dt_mesh *m, uint32_t h)
{
    return m->half[h + 4];
}

/* The next half edge of the triangle, and the one before: by arithmetic, since a branch on the corner of h
 * would be unpredictable. */
static inline uint32_t dt_next(uint32_t h)
{
    return h + 1 - 3 * (h >> 1 & 1);
}

static inline uint32_t dt_prev(uint32_t h)
{
    return h + 2 - 3 * ((h | h >> 1) & 1);
}

static inline uint32_t dt_dest(const struct dt_mesh *m, uint32_t h)
{
    return m->half[dt_next(h)];
}

/* The corner opposite to h: the third point of its triangle. */
static inline uint32_t dt_apex_of(const struct dt_mesh *m, uint32_t h)
{
    return m->half[dt_prev(h)];
}

/* The first half edge of the triangle that h belongs to. */
static inline uint32_t dt_base(uint32_t h)
{
    return h & ~(uint32_t)7;
}

static inline bool dt_is_ghost(const struct dt_mesh *m, uint32_t h)
{
    return m->half[dt_base(h) + 2] == DT_NONE;
}

static inline bool dt_is_dead(const struct dt_mesh *m, uint32_t h)
{
    return m->half[dt_base(h) + 2] == DT_DEAD;
}

/* The next half edge counterclockwise around the origin of h. */
static inline uint32_t dt_turn_ccw(const struct dt_mesh *m, uint32_t h)
{
    return dt_twin(m, dt_prev(h));
}

/* The next half edge clockwise around the origin of h. */
static inline uint32_t dt_turn_cw(const struct dt_mesh *m, uint32_t h)
{
    return dt_next(dt_twin(m, h));
}

static inline void dt_link(struct dt_mesh *m, uint32_t h, uint32_t twin)
{
    m->half[h + 4] = twin;
    m->half[twin + 4] = h;
}

static inline void dt_set_corners(struct dt_mesh *m, uint32_t h, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *v = m->half + h;
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

/* Allocates a dead record, or a new one, for which there must be room; returns its first half edge. */
static inline uint32_t dt_mesh_take(struct dt_mesh *m)
{
    uint32_t h = m->free_list;
    if (h == DT_NONE)
        return 8 * m->tri_end++;
    m->free_list = m->half[h];
    if (m->free_list != DT_NONE)
        dt_fetch(&m->half[m->free_list]); /* for the next one */
    m->dead--;
    m->recycled = true;
    return h;
}

/* Frees the record with first half edge h. */
static inline void dt_mesh_drop(struct dt_mesh *m, uint32_t h)
{
    m->half[h] = m->free_list;
    m->half[h + 2] = DT_DEAD;
    m->free_list = h;
    m->dead++;
}

/* Counts that follow from Euler's formula; for n vertices, all on one line iff ghosts == 2n - 2. */
uint32_t dt_mesh_triangles(const struct dt_mesh *m);
uint32_t dt_mesh_edges(const struct dt_mesh *m);
uint32_t dt_mesh_hull(const struct dt_mesh *m);
bool dt_mesh_is_line(const struct dt_mesh *m); /* true also for 0 and 1 vertices */
