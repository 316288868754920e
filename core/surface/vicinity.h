/* vicinity.h - prefetches by blocks what a scan of a surface will read.
 *
 * Vertices and triangles are numbered in Morton order by a build, so those of a block of numbers lie together in the
 * plane: where a row of a raster needs one of them, that row and the next ones need most of the others. Values are
 * found by id, which may be in any order. Without that, the scan would wait for each of them. */
#ifndef DT_VICINITY_H
#define DT_VICINITY_H

#include "core/delaunay_surface.h"
#include "core/set/set.h"

enum {
    DT_BLOCKS = 4096,       /* that are remembered as fetched: of vertices, and of triangles */
    DT_BLOCK_VERTICES = 32, /* 8 cache lines of places, up to 32 of values */
    DT_BLOCK_TRIANGLES = 16 /* 8 cache lines */
};

struct dt_vicinity {
    uint32_t *vertices, *triangles; /* owns DT_BLOCKS numbers each; NULL: nothing is fetched */
    const struct dt_surface *s;     /* borrows */
};

/* Where the value of a surface at a point is. */
static inline const double *dt_value_place(const struct dt_surface *s, uint32_t id)
{
    uint32_t page = id / DT_FIELD_PAGE;
    return &s->page[page < s->pages ? page : s->pages][id % DT_FIELD_PAGE];
}

/* DT_NOMEM; to be cleared in any case. */
enum dt_status dt_vicinity_init(struct dt_vicinity *w, const struct dt_surface *s);
void dt_vicinity_clear(struct dt_vicinity *w);

void dt_vicinity_fetch_triangles(struct dt_vicinity *w, const struct dt *t, uint32_t block);
void dt_vicinity_fetch_vertices(struct dt_vicinity *w, const struct dt *t, uint32_t block);

/* Fetches what is near the triangle of the half edge, or the vertex, unless that has been done lately. Reads neither. */
static inline void dt_vicinity_triangle(struct dt_vicinity *w, const struct dt *t, uint32_t half)
{
    uint32_t block = half / (8 * DT_BLOCK_TRIANGLES);
    if (w->triangles != NULL && w->triangles[block % DT_BLOCKS] != block)
        dt_vicinity_fetch_triangles(w, t, block);
}

static inline void dt_vicinity_vertex(struct dt_vicinity *w, const struct dt *t, uint32_t vertex)
{
    uint32_t block = vertex / DT_BLOCK_VERTICES;
    if (w->triangles != NULL && w->vertices[block % DT_BLOCKS] != block)
        dt_vicinity_fetch_vertices(w, t, block);
}

/* The triangle and its corners. */
static inline void dt_vicinity_enter(struct dt_vicinity *w, const struct dt *t, uint32_t half)
{
    const uint32_t *corner = t->mesh.half + dt_base(half);
    uint32_t block = half / (8 * DT_BLOCK_TRIANGLES);
    if (w->triangles == NULL || w->triangles[block % DT_BLOCKS] == block)
        return;
    dt_vicinity_fetch_triangles(w, t, block);
    for (uint32_t k = 0; k < 3; k++)
        if (corner[k] != DT_NONE)
            dt_vicinity_vertex(w, t, corner[k]);
}

#endif
