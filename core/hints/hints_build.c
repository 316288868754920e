/* hints_build.c - builds the grid of hints.
 *
 *     plan (hints_plan.c)    which cells have grids of their own
 *     claim                  every triangle claims the cell with its centroid, then every vertex its own cell
 *     fill                   empty cells borrow from others
 *
 * Several triangles may have their centroid in a cell. The triangle that contains the centre of the cell keeps it, if it is
 * one of them. A search from it takes 1.0 steps on the average; from any triangle at a vertex of the cell it would take 2.1.
 *
 * Triangles and vertices are in spatial order in memory, so claiming runs through the cells nearly in order;
 * threads share the passes but the first. */
#include "core/hints/hints.h"

#include "core/control/parallel.h"
#include "core/control/stop.h"
#include "core/exact/lanes.h"
#include "core/memory/memory.h"

#define NEAR 2       /* cells: a distance that need not be improved */
#define FARTHEST 254 /* cells: distances are cut off there */
#define BATCHES 8u   /* of grids, for each thread */
#define FAR 3.0      /* cells */
#define AHEAD 16u    /* triangles */

/* ---- claiming cells ---- */

/* One pass over the triangles or the vertices. */
struct claims {
    struct dt_hints *hints;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    struct dt_stop *stop;
    uint32_t n; /* how many there are */
    unsigned slices;
    void (*claim)(const struct claims *c, struct dt_piece at);
};

/* Several threads may write to a cell: which half edge it keeps does not matter. */
static inline uint32_t load(const uint32_t *cell)
{
    return __atomic_load_n(cell, __ATOMIC_RELAXED);
}

static inline void store(uint32_t *cell, uint32_t h)
{
    __atomic_store_n(cell, h, __ATOMIC_RELAXED);
}

/* A grid, with the map from places to its cells. */
struct frame {
    dt_lanes lo, per, last; /* corner; cells per unit; last column and row */
    uint32_t *cell;
    size_t nx;
};

static inline struct frame frame_of(const struct dt_hints *h, uint32_t k)
{
    const struct dt_hint_grid *g = h->grid + k;
    return (struct frame){.lo = {g->lo.x, g->lo.y},
                          .per = {g->per_x, g->per_y},
                          .last = {g->nx - 1.0, g->ny - 1.0},
                          .cell = h->cell + g->first,
                          .nx = g->nx};
}

typedef int32_t column_and_row __attribute__((vector_size(8)));

/* The cell of p: its column and row. */
static inline column_and_row place_in(const struct frame *f, dt_lanes p)
{
    dt_lanes at = (p - f->lo) * f->per, zero = {0, 0};
    return __builtin_convertvector(dt_lanes_least(dt_lanes_most(at, zero), f->last),
                                   column_and_row);
}

static inline uint32_t *cell_at(const struct frame *f, column_and_row at)
{
    return &f->cell[(size_t)at[1] * f->nx + (size_t)at[0]];
}

/* The cell has no grid and contains the centroid of the triangle a b c. It gets the triangle's half edge h if the triangle
 * contains the centre of the cell, or if the cell is empty; but not if a corner is far away. */
static inline void claim_cell(const struct frame *f, column_and_row at, uint32_t h, dt_lanes a,
                              dt_lanes b, dt_lanes c)
{
    const dt_lanes half = dt_lanes_both(0.5), zero = {0, 0};
    dt_lanes centre = __builtin_convertvector(at, dt_lanes) + half;
    a = (a - f->lo) * f->per - centre;
    b = (b - f->lo) * f->per - centre;
    c = (c - f->lo) * f->per - centre;
    dt_lanes ab_bc =
        dt_lanes_first(a, b) * dt_lanes_second(b, c) - dt_lanes_second(a, b) * dt_lanes_first(b, c);
    dt_lanes ca = c * dt_lanes_swap(a);
    bool out = (dt_lanes_bits(ab_bc < zero) | (ca[0] < ca[1])) != 0;
    dt_lanes reach =
        dt_lanes_most(dt_lanes_most(dt_lanes_abs(a), dt_lanes_abs(b)), dt_lanes_abs(c));
    bool far = dt_lanes_bits(reach > dt_lanes_both(FAR)) != 0;
    uint32_t *cell = cell_at(f, at), had = load(cell);
    bool take = (!out | (had == DT_HINT_LENT)) & !far; /* a branch would be unpredictable */
    store(cell, had ^ ((had ^ h) & (0u - (uint32_t)take)));
}

static void fetch_corners(const struct dt_point *xy, const uint32_t *v)
{
    for (int k = 0; k < 3; k++)
        dt_fetch(&xy[v[k]]);
}

/* After many edits the vertices are in no order, so they are fetched ahead. */
static void claim_by_triangles(const struct claims *d, struct dt_piece at)
{
    const struct frame top = frame_of(d->hints, 0);
    const struct dt_point *xy = d->xy;
    const uint32_t *v = d->mesh->half + 8 * (size_t)at.a;
    for (uint32_t t = at.a; t < at.b; t++, v += 8) {
        if (v[2] == DT_NONE || v[2] == DT_DEAD)
            continue;
        if (at.b - t > AHEAD)
            fetch_corners(xy, v + 8 * (size_t)AHEAD);
        dt_lanes a = dt_lanes_load(&xy[v[0]].x), b = dt_lanes_load(&xy[v[1]].x),
                 c = dt_lanes_load(&xy[v[2]].x);
        dt_lanes centroid = (a + b + c) * dt_lanes_both(1.0 / 3);
        struct frame f = top;
        column_and_row place = place_in(&f, centroid);
        for (uint32_t had; (had = load(cell_at(&f, place))) & DT_HINT_GRID;) {
            f = frame_of(d->hints, had >> 3);
            place = place_in(&f, centroid);
        }
        claim_cell(&f, place, 8 * t, a, b, c);
    }
}

/* The centroids of thin triangles may all be far from their vertices. With this pass every grid has a cell that is not
 * empty, too. */
static void claim_by_vertices(const struct claims *d, struct dt_piece at)
{
    const struct dt_hint_grid top = *d->hints->grid;
    for (uint32_t v = at.a; v < at.b; v++) {
        if (d->mesh->leaving[v] == DT_NONE)
            continue;
        uint32_t *cell = &d->hints->cell[dt_hint_cell(&top, d->xy[v])], had;
        while ((had = load(cell)) & DT_HINT_GRID)
            cell = &d->hints->cell[dt_hint_cell(d->hints->grid + (had >> 3), d->xy[v])];
        if (had == DT_HINT_LENT)
            store(cell, d->mesh->leaving[v]);
    }
}

static void claim_slice(void *arg, unsigned i)
{
    const struct claims *d = arg;
    struct dt_piece at = dt_slice_pieces(d->n, i, d->slices);
    while (dt_next_piece(d->stop, &at))
        d->claim(d, at);
}

/* ---- filling empty cells ---- */

/* A cell's content, and its distance in cells to the cell it comes from: 0 its own, FARTHEST + 1 no content yet. */
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
    struct dt_stop *stop;
    uint8_t *far; /* of every cell */
    unsigned bands, batches;
    atomic_bool bare; /* some band has no content at all */
};

/* Polls after every DT_POLL cells: rows may be long, or many and short. False: it is stopped. */
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

static void fill_part(void *arg, unsigned i)
{
    struct fill *f = arg;
    const struct dt_hint_grid *grid = f->hints->grid;
    if (i < f->bands) {
        uint32_t lo = dt_slice(grid->ny, i, f->bands), hi = dt_slice(grid->ny, i + 1, f->bands);
        if (!fill_rows(f, grid, lo, hi))
            atomic_store_explicit(&f->bare, true, memory_order_relaxed);
        return;
    }
    uint32_t others = f->hints->grids - 1, end = dt_slice(others, i - f->bands + 1, f->batches);
    for (uint32_t k = dt_slice(others, i - f->bands, f->batches); k < end; k++)
        (void)fill_rows(f, &grid[k + 1], 0, grid[k + 1].ny);
}

/* Every empty cell takes the content of a cell that is not empty and nearly the nearest: a distance
 * transform in two sweeps [Rosenfeld & Pfaltz 1966]. If some band of grid 0 has no point, all of grid 0
 * is filled again, in one piece. */
static void fill_empty(struct fill *f, const struct dt_pool *pool)
{
    const struct dt_hint_grid *g = f->hints->grid;
    f->far = dt_array_new_in(f->hints->pages, f->hints->cells, 1);
    if (f->far == NULL) {
        dt_stop_because(f->stop, DT_NOMEM);
        return;
    }
    dt_run(pool, f->bands + f->batches, fill_part, f);
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
    struct claims c = {.hints = g, .mesh = m, .xy = xy, .stop = &stop, .slices = threads};
    if (!dt_stopped(&stop)) {
        c.n = m->tri_end;
        c.claim = claim_by_triangles;
        dt_run(pool, threads, claim_slice, &c);
        c.n = m->vert_cap;
        c.claim = claim_by_vertices;
        dt_run(pool, threads, claim_slice, &c);
    }
    struct fill f = {.hints = g, .stop = &stop, .bands = threads, .batches = threads * BATCHES};
    if (!dt_stopped(&stop))
        fill_empty(&f, threads > 1 ? pool : NULL);
    if (dt_stop_status(&stop) != DT_OK)
        dt_hints_clear(g);
    return dt_stop_status(&stop);
}
