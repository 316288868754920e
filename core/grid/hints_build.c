/* hints_build.c - builds the grid of hints.
 *
 *     plan (hints_plan.c)    which cells have grids of their own
 *     drop                   every vertex leaves its half edge in its cell
 *     fill                   empty cells borrow from others
 *     centre                 every cell goes on from there towards the triangle that its centre is in
 *
 * A search takes 2.1 steps on the average from any triangle at a vertex of the cell, 1.0 from there.
 *
 * The vertices are in spatial order in memory, so dropping runs through the cells nearly in order;
 * threads share the passes but the first. */
#include "core/grid/hints.h"

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"

#include <string.h>

#define NEAR 2       /* cells: a distance that need not be improved */
#define FARTHEST 254 /* cells: distances are cut off there */
#define BATCHES 8u   /* of grids, for each thread */
#define STEPS 3      /* to the centre of a cell, at most */
#define TILE 32u     /* cells of a side */

/* ---- dropping half edges ---- */

struct drop {
    struct dt_hints *hints;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    struct dt_stop *stop;
    unsigned slices;
};

/* A cell gets a vertex' half edge, or passes it on to the grid that it holds. Several threads may write to a
 * cell: which half edge it keeps does not matter. */
static void drop_one(const struct drop *d, uint32_t c, uint32_t v)
{
    uint32_t *cell = d->hints->cell, h;
    while ((h = __atomic_load_n(&cell[c], __ATOMIC_RELAXED)) & DT_HINT_GRID)
        c = dt_hint_cell(d->hints->grid + (h >> 3), d->xy[v]);
    __atomic_store_n(&cell[c], d->mesh->leaving[v], __ATOMIC_RELAXED);
}

/* After many edits the vertices are in no order, so the cells of some are fetched before the first
 * of them is dropped. */
static void drop_piece(const struct drop *d, struct dt_piece at)
{
    enum { AT_ONCE = 32 };
    const struct dt_hint_grid top = *d->hints->grid;
    uint32_t c[AT_ONCE];
    for (uint32_t v = at.a, k; v < at.b; v += k) {
        uint32_t n = at.b - v < AT_ONCE ? at.b - v : AT_ONCE;
        for (k = 0; k < n; k++) {
            c[k] = d->mesh->leaving[v + k] == DT_NONE ? 0 : dt_hint_cell(&top, d->xy[v + k]);
            dt_fetch(&d->hints->cell[c[k]]);
        }
        for (k = 0; k < n; k++)
            if (d->mesh->leaving[v + k] != DT_NONE)
                drop_one(d, c[k], v + k);
    }
}

static void drop_slice(void *arg, unsigned i)
{
    const struct drop *d = arg;
    struct dt_piece at = dt_slice_pieces(d->mesh->vert_cap, i, d->slices);
    while (dt_next_piece(d->stop, &at))
        drop_piece(d, at);
}

/* ---- filling empty cells ---- */

/* What a cell has, and how many cells away that comes from: 0 its own, FARTHEST + 1 nothing yet. */
struct content {
    uint32_t h;
    unsigned far;
};

/* The nearer one of a cell's content and its neighbour's. No branches: the outcome is unpredictable. */
static inline struct content nearer(struct content own, struct content next)
{
    unsigned far = next.far + (next.far < FARTHEST ? 1u : 0u);
    bool take = far < own.far;
    return (struct content){take ? next.h | DT_HINT_LENT : own.h, take ? far : own.far};
}

/* From left to right along a row of nx cells, at.a to at.b - 1, and from the row below. `left` is what the
 * cell before has. */
static struct content sweep_up(uint32_t *cell, uint8_t *far, size_t nx, bool has_below,
                               struct dt_piece at, struct content left)
{
    for (size_t i = at.a; i < at.b; i++) {
        struct content own = {cell[i], far[i]};
        if (has_below)
            own = nearer(own, (struct content){(cell - nx)[i], (far - nx)[i]});
        left = nearer(own, left);
        cell[i] = left.h;
        far[i] = (uint8_t)left.far;
    }
    return left;
}

/* From right to left and from the row above, only for cells whose content is not near already. at counts
 * from the right. */
static void sweep_down(uint32_t *cell, uint8_t *far, size_t nx, bool has_above, struct dt_piece at)
{
    for (size_t i = nx - at.a; i-- > nx - at.b;) {
        struct content own = {cell[i], far[i]};
        if (own.far <= NEAR)
            continue;
        if (has_above)
            own = nearer(own, (struct content){cell[i + nx], far[i + nx]});
        if (i + 1 < nx)
            own = nearer(own, (struct content){cell[i + 1], far[i + 1]});
        cell[i] = own.h;
        far[i] = (uint8_t)own.far;
    }
}

/* Grid 0 in bands of rows, then the others in batches. */
struct fill {
    const struct dt_hints *hints;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    struct dt_stop *stop;
    uint8_t *far; /* of every cell */
    unsigned bands, batches;
    bool (*rows)(const struct fill *f, const struct dt_hint_grid *g, uint32_t lo, uint32_t hi);
    atomic_bool bare; /* some band has no content at all */
};

/* Polls after each so many cells: rows may be long, or many and short. False: it is stopped. */
static bool next_part_of_row(const struct fill *f, struct dt_piece *at, uint32_t *cells)
{
    if (!dt_next_piece(NULL, at))
        return false;
    *cells += at->b - at->a;
    if (*cells < DT_POLL)
        return true;
    *cells = 0;
    return !dt_stopped(f->stop);
}

static void fill_row_up(const struct fill *f, const struct dt_hint_grid *g, size_t row,
                        bool has_below, uint32_t *cells)
{
    uint32_t *cell = f->hints->cell + g->first + row * g->nx;
    uint8_t *far = f->far + g->first + row * g->nx;
    struct content left = {0, FARTHEST + 1};
    for (struct dt_piece at = dt_pieces(0, g->nx); next_part_of_row(f, &at, cells);) {
        for (uint32_t i = at.a; i < at.b; i++)
            far[i] = (cell[i] & DT_HINT_LENT) == DT_HINT_LENT ? FARTHEST + 1 : 0;
        left = sweep_up(cell, far, g->nx, has_below, at, left);
    }
}

static void fill_row_down(const struct fill *f, const struct dt_hint_grid *g, size_t row,
                          bool has_above, uint32_t *cells)
{
    uint32_t *cell = f->hints->cell + g->first + row * g->nx;
    uint8_t *far = f->far + g->first + row * g->nx;
    for (struct dt_piece at = dt_pieces(0, g->nx); next_part_of_row(f, &at, cells);)
        sweep_down(cell, far, g->nx, has_above, at);
}

/* Fills the cells of rows lo .. hi - 1 of a grid among themselves. Returns whether any had content. */
static bool fill_rows(const struct fill *f, const struct dt_hint_grid *g, uint32_t lo, uint32_t hi)
{
    uint32_t cells = 0;
    for (uint32_t row = lo; row < hi && dt_stop_status(f->stop) == DT_OK; row++)
        fill_row_up(f, g, row, row > lo, &cells);
    for (uint32_t row = hi; row-- > lo && dt_stop_status(f->stop) == DT_OK;)
        fill_row_down(f, g, row, row + 1 < hi, &cells);
    return lo == hi || dt_stop_status(f->stop) != DT_OK ||
           f->far[g->first + (size_t)lo * g->nx] <= FARTHEST;
}

/* ---- to the centres ---- */

/* The triangle beyond the edge of the triangle at h, no ghost, that has q farthest on its outer side; h itself if q is
 * in it. No branches: the outcome is unpredictable. */
static inline uint32_t step_towards(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                                    struct dt_point q)
{
    struct dt_point a = xy[m->half[h]], b = xy[m->half[h + 1]], c = xy[m->half[h + 2]];
    double any, s[3]; /* a hint needs no bound */
    s[0] = dt_orient2d_rounded(a, b, q, &any);
    s[1] = dt_orient2d_rounded(b, c, q, &any);
    s[2] = dt_orient2d_rounded(c, a, q, &any);
    uint32_t k = s[1] < s[0];
    k += (2 - k) & -(uint32_t)(s[2] < s[k]);
    uint32_t beyond = dt_base(dt_twin(m, h + k));
    return h ^ ((h ^ beyond) & -(uint32_t)(s[k] < 0));
}

/* Walks from n <= TILE cells of a row, the first one in this column, to the triangles of their centres, side by side:
 * a single walk waits for each step. */
static void centre_cells(const struct fill *f, const struct dt_hint_grid *g, uint32_t row,
                         uint32_t column, uint32_t n)
{
    const struct dt_mesh *m = f->mesh;
    uint32_t *cell = f->hints->cell + g->first + (size_t)row * g->nx + column, at[TILE];
    double width = g->per_x == 0 ? 0 : 1 / g->per_x, height = g->per_y == 0 ? 0 : 1 / g->per_y;
    for (uint32_t i = 0; i < n; i++) {
        at[i] = cell[i] & DT_HINT_GRID ? m->hull : dt_base(cell[i]);
        at[i] = dt_is_ghost(m, at[i]) ? dt_base(dt_twin(m, at[i])) : at[i];
    }
    for (int step = 0; step < STEPS; step++)
        for (uint32_t i = 0; i < n; i++) {
            struct dt_point q = {g->lo.x + (column + i + 0.5) * width,
                                 g->lo.y + (row + 0.5) * height};
            uint32_t next = step_towards(m, f->xy, at[i], q);
            at[i] = dt_is_ghost(m, next) ? at[i] : next;
        }
    for (uint32_t i = 0; i < n; i++)
        if (!(cell[i] & DT_HINT_GRID))
            cell[i] = at[i] | ((cell[i] & DT_HINT_LENT) == DT_HINT_LENT ? DT_HINT_LENT : 0);
}

/* Gives the cells of rows lo .. hi - 1, all of which have content, the triangles of their centres. By tiles, whose
 * triangles are near one another in memory. */
static bool centre_rows(const struct fill *f, const struct dt_hint_grid *g, uint32_t lo,
                        uint32_t hi)
{
    for (uint32_t bottom = lo; bottom < hi; bottom += TILE)
        for (uint32_t left = 0; left < g->nx && !dt_stopped(f->stop); left += TILE) {
            uint32_t top = hi - bottom < TILE ? hi : bottom + TILE;
            uint32_t right = g->nx - left < TILE ? g->nx : left + TILE;
            for (uint32_t row = bottom; row < top; row++)
                centre_cells(f, g, row, left, right - left);
        }
    return true;
}

/* Does f->rows to a part of the rows of all grids. */
static void do_rows(void *arg, unsigned i)
{
    struct fill *f = arg;
    const struct dt_hint_grid *grid = f->hints->grid;
    if (i < f->bands) {
        uint32_t lo = dt_slice(grid->ny, i, f->bands), hi = dt_slice(grid->ny, i + 1, f->bands);
        if (!f->rows(f, grid, lo, hi))
            atomic_store_explicit(&f->bare, true, memory_order_relaxed);
        return;
    }
    uint32_t others = f->hints->grids - 1, end = dt_slice(others, i - f->bands + 1, f->batches);
    for (uint32_t k = dt_slice(others, i - f->bands, f->batches); k < end; k++)
        (void)f->rows(f, &grid[k + 1], 0, grid[k + 1].ny);
}

/* Every empty cell takes the content of one that is not, nearly of the nearest: a distance
 * transform in two sweeps [Rosenfeld & Pfaltz 1966]. If some band of grid 0 has no point, all of it
 * is filled again, in one piece. */
static void fill_empty(struct fill *f, const struct dt_pool *pool)
{
    const struct dt_hint_grid *g = f->hints->grid;
    f->far = dt_array_new_in(f->hints->pages, f->hints->cells, 1);
    if (f->far == NULL) {
        dt_stop_because(f->stop, DT_NOMEM);
        return;
    }
    f->rows = fill_rows;
    dt_run(pool, f->bands + f->batches, do_rows, f);
    if (atomic_load_explicit(&f->bare, memory_order_relaxed) && !dt_stopped(f->stop))
        (void)fill_rows(f, g, 0, g->ny);
    dt_array_free(f->far);
}

enum dt_status dt_hints_build(struct dt_hints *g, const struct dt_mesh *m,
                              const struct dt_point *xy, const struct dt_options *opt)
{
    const struct dt_pool *pool = opt == NULL ? NULL : opt->pool;
    struct dt_stop stop = dt_stop_of(opt);
    dt_hints_clear(g);
    g->pages = m->pages;
    if (m->vertices < 2)
        return DT_OK;
    unsigned threads = dt_threads_for(pool, m->vertices);
    dt_hints_plan(g, m, xy, &stop);
    if (!dt_stopped(&stop)) {
        struct drop d = {.hints = g, .mesh = m, .xy = xy, .stop = &stop, .slices = threads};
        dt_run(pool, threads, drop_slice, &d);
    }
    struct fill f = {.hints = g,
                     .mesh = m,
                     .xy = xy,
                     .stop = &stop,
                     .bands = threads,
                     .batches = threads * BATCHES};
    if (!dt_stopped(&stop))
        fill_empty(&f, threads > 1 ? pool : NULL);
    if (!dt_stopped(&stop) && !dt_mesh_is_line(m)) {
        f.rows = centre_rows;
        dt_run(threads > 1 ? pool : NULL, f.bands + f.batches, do_rows, &f);
    }
    if (dt_stop_status(&stop) != DT_OK)
        dt_hints_clear(g);
    return dt_stop_status(&stop);
}
