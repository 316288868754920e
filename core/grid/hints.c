/* hints.c - the grid's memory, the way to cells that are not empty, and hints while the mesh changes; see hints.h. */
#include "core/grid/hints.h"

#include <string.h>

void dt_hints_clear(struct dt_hints *g)
{
    dt_array_free(g->grid);
    dt_array_free(g->cell);
    *g = (struct dt_hints){0};
}

enum dt_status dt_hints_copy(const struct dt_hints *g, struct dt_hints *copy)
{
    *copy = (struct dt_hints){0};
    if (g->grids == 0)
        return DT_OK;
    copy->pages = g->pages;
    copy->grid = dt_array_new_in(g->pages, g->grids, sizeof *copy->grid);
    copy->cell = dt_array_new_in(g->pages, g->cells, sizeof *copy->cell);
    if (copy->grid == NULL || copy->cell == NULL) {
        dt_hints_clear(copy);
        return DT_NOMEM;
    }
    memcpy(copy->grid, g->grid, g->grids * sizeof *copy->grid);
    memcpy(copy->cell, g->cell, g->cells * sizeof *copy->cell);
    copy->grids = copy->grid_cap = g->grids;
    copy->cells = copy->cell_cap = g->cells;
    return DT_OK;
}

size_t dt_hints_memory(const struct dt_hints *g)
{
    return g->grid_cap * sizeof *g->grid + g->cell_cap * sizeof *g->cell;
}

uint32_t dt_hint_beyond(const struct dt_hints *g, struct dt_point q, unsigned direction)
{
    const struct dt_hint_grid *top = g->grid;
    uint32_t at = dt_hint_cell(top, q), column = at % top->nx, row = at / top->nx;
    uint32_t cells[4] = {top->ny - 1 - row, row, column, top->nx - 1 - column};
    uint32_t step[4] = {top->nx, 0 - top->nx, 0 - 1u, 1};
    for (uint32_t n = cells[direction & 3]; n > 0; n--) {
        at += step[direction & 3];
        if ((g->cell[at] & DT_HINT_LENT) != DT_HINT_LENT)
            return dt_hint_in(g, g->cell[at], q);
    }
    return DT_NONE;
}

/* ---- while the mesh changes ---- */

#define FAR 6 /* cells */

/* The grid and the cell that q's hint comes from. */
static const struct dt_hint_grid *leaf(const struct dt_hints *g, struct dt_point q, uint32_t *cell)
{
    const struct dt_hint_grid *at = g->grid;
    *cell = dt_hint_cell(at, q);
    while (g->cell[*cell] & DT_HINT_GRID) {
        at = g->grid + (g->cell[*cell] >> 3);
        *cell = dt_hint_cell(at, q);
    }
    return at;
}

static bool within_few(uint32_t a, uint32_t b)
{
    return a - b + FAR <= 2 * FAR;
}

/* Whether the triangle with base half edge h has a corner in a cell near q's. */
static bool is_near(const struct dt_hint_grid *at, const struct dt_mesh *m,
                    const struct dt_point *xy, uint32_t h, struct dt_point q)
{
    struct dt_point p = xy[m->half[h]];
    return within_few(dt_hint_column(at, p.x), dt_hint_column(at, q.x)) &&
           within_few(dt_hint_row(at, p.y), dt_hint_row(at, q.y));
}

/* The good hint of a cell around q's, or at least a live one: its own if that is. */
static uint32_t look_around(const struct dt_hints *g, const struct dt_mesh *m,
                            const struct dt_point *xy, const struct dt_hint_grid *at, uint32_t cell,
                            struct dt_point q)
{
    static const int steps[][2] = {{1, 0},  {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1},
                                   {1, -1}, {-1, 1}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}};
    uint32_t own = dt_base(g->cell[cell]), alive = m->hull;
    int column = (int)((cell - at->first) % at->nx), row = (int)((cell - at->first) / at->nx);
    for (unsigned i = 0; i < sizeof steps / sizeof *steps; i++) {
        int c = column + steps[i][0], r = row + steps[i][1];
        if (c < 0 || r < 0 || c >= (int)at->nx || r >= (int)at->ny)
            continue;
        uint32_t h = g->cell[at->first + (uint32_t)r * at->nx + (uint32_t)c];
        if (h & DT_HINT_GRID)
            continue;
        h = dt_base(h);
        if (dt_is_dead(m, h))
            continue;
        if (is_near(at, m, xy, h, q))
            return h;
        alive = h;
    }
    return dt_is_dead(m, own) ? alive : own;
}

uint32_t dt_hint_live(const struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                      struct dt_point q)
{
    uint32_t cell;
    const struct dt_hint_grid *at = leaf(g, q, &cell);
    uint32_t h = dt_base(g->cell[cell]);
    dt_hint_fetch(m, xy, NULL, h);
    if (!dt_is_dead(m, h) && is_near(at, m, xy, h, q))
        return h;
    return look_around(g, m, xy, at, cell, q);
}

void dt_hint_put(struct dt_hints *g, struct dt_point q, uint32_t h)
{
    uint32_t cell;
    if (g->grids == 0)
        return;
    leaf(g, q, &cell);
    g->cell[cell] = dt_base(h);
}
