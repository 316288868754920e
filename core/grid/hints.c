/* hints.c - the grid's memory, and the way to cells that are not empty; see hints.h. */
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
