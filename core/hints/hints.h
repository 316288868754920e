/* hints.h - the uniform grid: maps every place of the plane to a half edge near it.
 *
 * The paper keeps points in its cells; a half edge serves the same search and leads straight into
 * the mesh. A crowded cell holds a grid of its own instead, fitted to the box of its points, and so on.
 * So a search costs the same on clusters, outliers and nested scales.
 *
 *      grid 0    +---+---+---+
 *                | h | h | h |     h: of the triangle at the centre of this cell, or of one near it
 *                +---+---+---+
 *                | h | G | h |     G: the cell's own grid (its number), marked by bit 2, which no
 *                +---+---+---+        half edge 8t + k has set
 *
 * When it is made: core/set/hints_rebuild.c.
 *
 * A cell in which no small triangle has its centroid, and which has no vertex, is empty. It borrows the content of the
 * nearest cell that is not empty, marked by 3 in the two lowest bits. Of a half edge only the triangle counts. */
#pragma once

#include "core/control/stop.h"
#include "core/exact/box.h"
#include "core/memory/memory.h"
#include "core/mesh/mesh.h"

struct dt_hint_grid {
    struct dt_point lo;  /* corner */
    double per_x, per_y; /* cells per unit; 0 in a direction without extent */
    uint32_t nx, ny;
    uint32_t first; /* its first cell */
};

struct dt_hints {
    struct dt_pages *pages;    /* borrows: those of the mesh */
    struct dt_hint_grid *grid; /* owns; grid 0 covers the set, each other one refines a cell */
    uint32_t *cell;            /* owns the cells of all grids, row by row */
    uint32_t grids, grid_cap;
    uint32_t cells, cell_cap;
};

/* *g must be zeroed or cleared. */
void dt_hints_clear(struct dt_hints *g);

/* Bytes that the grid holds. */
size_t dt_hints_memory(const struct dt_hints *g);

/* Builds the grid for a settled mesh of which every vertex v has coordinates xy[v]. *g is cleared first, and left so unless DT_OK.
 * Vertices that are in no triangle must have DT_NONE in leaving[]. opt may be NULL. Its flag is polled, and its pool shares the work;
 * then another of a cell's half edges may be its hint each time. A caller that takes the grid for this mesh sets m->recycled to false.
 * Cost: linear. */
enum dt_status dt_hints_build(struct dt_hints *g, const struct dt_mesh *m,
                              const struct dt_point *xy, const struct dt_options *opt);

/* Its first part: gives *g, which is clear, the grids for a settled mesh of at least two vertices. Each cell holds a
 * grid or is empty (DT_HINT_LENT); to each grid go a few vertices at least. If it is stopped, for lack
 * of memory or by the caller, *g is to be cleared. Cost: a fraction of a pass over the vertices. */
void dt_hints_plan(struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                   struct dt_stop *stop);

static inline uint32_t dt_hint_column(const struct dt_hint_grid *g, double x)
{
    return dt_cell((x - g->lo.x) * g->per_x, g->nx);
}

static inline uint32_t dt_hint_row(const struct dt_hint_grid *g, double y)
{
    return dt_cell((y - g->lo.y) * g->per_y, g->ny);
}

static inline uint32_t dt_hint_cell(const struct dt_hint_grid *g, struct dt_point q)
{
    return g->first + dt_hint_row(g, q.y) * g->nx + dt_hint_column(g, q.x);
}

#define DT_HINT_GRID 4u /* the cell holds a grid, whose number is in the other bits */
#define DT_HINT_LENT 3u /* the cell is empty and has borrowed what the nearest one has */

/* Descends from a cell's content to its half edge for q. */
static inline uint32_t dt_hint_in(const struct dt_hints *g, uint32_t h, struct dt_point q)
{
    while (h & DT_HINT_GRID)
        h = g->cell[dt_hint_cell(g->grid + (h >> 3), q)];
    return dt_base(h);
}

/* The first half edge of a triangle near q; the mesh must have at least two vertices. */
static inline uint32_t dt_hint(const struct dt_hints *g, struct dt_point q)
{
    return dt_hint_in(g, g->cell[dt_hint_cell(g->grid, q)], q);
}

/* Prefetches the triangles and vertices in `lines` cache lines on either side of those at h, a half edge or the content of
 * a cell, whose two lowest bits do not matter. After a build, vertices
 * and triangles, two for each vertex, are in the same spatial order. So neighbours in the plane are probably near in memory,
 * too: of the triangles that a search reads, 71 % are within 12 of the first one. */
static inline void dt_hint_fetch(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                                 int lines)
{
    enum { LINE = 64 };
    uintptr_t triangle = (uintptr_t)m->half + sizeof *m->half * (size_t)h,
              vertex = (uintptr_t)xy + sizeof *xy * (size_t)(h >> 4);
    for (int k = -lines; k <= lines; k++) {
        dt_fetch((const void *)(triangle + (uintptr_t)(LINE * k)));
        dt_fetch((const void *)(vertex + (uintptr_t)(LINE * k)));
    }
}

/* The same for the ids of the vertices. */
static inline void dt_hint_fetch_ids(const uint32_t *id, uint32_t h)
{
    enum { FEW = 24 }; /* bytes: six vertices on either side */
    uintptr_t at = (uintptr_t)id + sizeof *id * (size_t)(h >> 4);
    dt_fetch((const void *)(at - FEW));
    dt_fetch((const void *)(at + FEW));
}

/* dt_hint. Also prefetches the data that a walk from the hint to q will probably read: the memory near the hints of q's cell
 * and of the eight cells around it. */
uint32_t dt_hint_fetching(const struct dt_hints *g, const struct dt_mesh *m,
                          const struct dt_point *xy, struct dt_point q);

/* Prefetches the cells of the set's own grid whose hints dt_hint_fetching reads for q. */
static inline void dt_hint_fetch_cells(const struct dt_hints *g, struct dt_point q)
{
    if (g->grids == 0)
        return;
    uintptr_t row = sizeof *g->cell * (size_t)g->grid->nx,
              at = (uintptr_t)g->cell + sizeof *g->cell * (size_t)dt_hint_cell(g->grid, q);
    dt_fetch((const void *)at);
    dt_fetch((const void *)(at - row));
    dt_fetch((const void *)(at + row));
}

/* ---- while the mesh changes ----
 *
 * Edits update only the cell at their place, so any other cell may point to a record that is dead or reused
 * elsewhere. A reader of a hint therefore checks whether it is good; if it is not, a cell nearby has a better
 * one. When walks have grown long, or the set has grown, the grid is rebuilt: amortised constant cost. */

/* The base half edge of a live triangle for q: the hint of the grid if it is good, else the hint of a cell
 * nearby. The mesh must have at least two vertices. */
uint32_t dt_hint_live(const struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                      struct dt_point q);

/* Enters the triangle of half edge h, which is near q, in the cell of q. */
void dt_hint_put(struct dt_hints *g, struct dt_point q, uint32_t h);
