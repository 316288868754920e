/* hints.c - the grid's memory, and hints while the mesh changes; see hints.h. */
#include "core/hints/hints.h"

void dt_hints_clear(struct dt_hints *g)
{
    dt_array_free(g->grid);
    dt_array_free(g->cell);
    *g = (struct dt_hints){0};
}

size_t dt_hints_memory(const struct dt_hints *g)
{
    return g->grid_cap * sizeof *g->grid + g->cell_cap * sizeof *g->cell;
}

/* ---- the cell of a place ---- */

/* A cell that holds no grid. */
struct leaf {
    const struct dt_hint_grid *grid;
    uint32_t column, row;
};

static uint32_t content(const struct dt_hints *g, struct leaf l)
{
    return g->cell[l.grid->first + (size_t)l.row * l.grid->nx + l.column];
}

static struct leaf leaf_in(const struct dt_hint_grid *grid, struct dt_point q)
{
    return (struct leaf){grid, dt_hint_column(grid, q.x), dt_hint_row(grid, q.y)};
}

/* The cell that q's hint comes from. */
static struct leaf leaf_of(const struct dt_hints *g, struct dt_point q)
{
    struct leaf l = leaf_in(g->grid, q);
    uint32_t h;
    while ((h = content(g, l)) & DT_HINT_GRID)
        l = leaf_in(g->grid + (h >> 3), q);
    return l;
}

/* The cell that q's hint comes from; prefetches as dt_hint_fetching does. The cells around it are prefetched while its own
 * content, which decides where to look, is still on its way. */
static struct leaf fetch_around(const struct dt_hints *g, const struct dt_mesh *m,
                                const struct dt_point *xy, struct dt_point q)
{
    enum { OWN = 2, OTHERS = 0 }; /* cache lines on either side */
    dt_hint_fetch_cells(g, q);
    struct leaf l = leaf_of(g, q);
    size_t nx = l.grid->nx, left = l.column > 0, right = l.column + 1 < nx;
    const uint32_t *cell = g->cell + l.grid->first + l.row * nx + l.column,
                   *below = cell - (l.row > 0 ? nx : 0),
                   *above = cell + (l.row + 1 < l.grid->ny ? nx : 0);
    dt_hint_fetch(m, xy, *cell, OWN);
    dt_hint_fetch(m, xy, *(cell - left), OTHERS);
    dt_hint_fetch(m, xy, *(cell + right), OTHERS);
    dt_hint_fetch(m, xy, *(below - left), OTHERS);
    dt_hint_fetch(m, xy, *below, OTHERS);
    dt_hint_fetch(m, xy, *(below + right), OTHERS);
    dt_hint_fetch(m, xy, *(above - left), OTHERS);
    dt_hint_fetch(m, xy, *above, OTHERS);
    dt_hint_fetch(m, xy, *(above + right), OTHERS);
    return l;
}

uint32_t dt_hint_fetching(const struct dt_hints *g, const struct dt_mesh *m,
                          const struct dt_point *xy, struct dt_point q)
{
    return dt_base(content(g, fetch_around(g, m, xy, q)));
}

/* ---- while the mesh changes ---- */

#define FAR 6 /* cells */

static bool within_few(uint32_t a, uint32_t b)
{
    return a - b + FAR <= 2 * FAR;
}

/* Whether the triangle with base half edge h has a corner in a cell near l. */
static bool is_near(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h, struct leaf l)
{
    struct leaf p = leaf_in(l.grid, xy[m->half[h]]);
    return within_few(p.column, l.column) && within_few(p.row, l.row);
}

/* The good hint of a cell around l, or at least a live one: its own if that is. */
static uint32_t look_around(const struct dt_hints *g, const struct dt_mesh *m,
                            const struct dt_point *xy, struct leaf l)
{
    static const int steps[][2] = {{1, 0},  {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1},
                                   {1, -1}, {-1, 1}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}};
    uint32_t own = dt_base(content(g, l)), alive = m->hull;
    for (unsigned i = 0; i < sizeof steps / sizeof *steps; i++) {
        struct leaf k = {l.grid, l.column + (uint32_t)steps[i][0], l.row + (uint32_t)steps[i][1]};
        if (k.column >= l.grid->nx || k.row >= l.grid->ny) /* below 0, too */
            continue;
        uint32_t h = content(g, k);
        if (h & DT_HINT_GRID)
            continue;
        h = dt_base(h);
        if (dt_is_dead(m, h))
            continue;
        if (is_near(m, xy, h, l))
            return h;
        alive = h;
    }
    return dt_is_dead(m, own) ? alive : own;
}

uint32_t dt_hint_live(const struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                      struct dt_point q)
{
    struct leaf l = fetch_around(g, m, xy, q);
    uint32_t h = dt_base(content(g, l));
    return !dt_is_dead(m, h) && is_near(m, xy, h, l) ? h : look_around(g, m, xy, l);
}

void dt_hint_put(struct dt_hints *g, struct dt_point q, uint32_t h)
{
    if (g->grids == 0)
        return;
    struct leaf l = leaf_of(g, q);
    g->cell[l.grid->first + (size_t)l.row * l.grid->nx + l.column] = dt_base(h);
}
