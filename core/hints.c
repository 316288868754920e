/* hints.c - builds the grid of hints.
 *
 * Grid 0 has CELLS_PER_POINT cells a point. One pass over the vertices leaves in each cell the half
 * edge of the last vertex that came by, and counts; the vertices are in spatial order in memory, so
 * this runs through the cells nearly in order. Then each cell with more than CROWD points gets a
 * grid of its own, treated in the same way, and so on, breadth first. A grid most of whose points
 * are in crowded cells was wasted on them, so it is made anew with few cells: the next level will
 * fit better. */
#include "core/hints.h"

#include "core/hull.h"
#include "core/memory.h"
#include "core/parallel.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_PER_POINT 1.75
#define CELLS_PER_POINT_COARSE 0.125
#define CROWD 12      /* points in one cell that are worth a grid */
#define MAX_CELLS 6.0 /* a point, over all grids; beyond that cells stay crowded */
#define IS_GRID 4u
#define NEAR 2       /* cells: a distance that need not be improved */
#define FARTHEST 254 /* cells: distances are cut off there */

/* What a grid under construction covers: the vertices list[from .. to - 1]. */
struct span {
    uint32_t from, to;
};

struct builder {
    struct dt_hints *hints;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    const struct dt_pool *pool;
    unsigned slices;   /* of grid 0 */
    uint8_t *count;    /* points in each cell of the grid at hand, 255 for more */
    uint32_t *list;    /* vertices in crowded cells, grid by grid */
    uint32_t *scratch; /* as long as list */
    struct span *span; /* by grid */
    uint32_t span_cap;
};

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
    copy->grid = dt_array_new(g->grids, sizeof *copy->grid);
    copy->cell = dt_array_new(g->cells, sizeof *copy->cell);
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

struct box {
    struct dt_point lo, hi;
};

static void box_add(struct box *b, struct dt_point p)
{
    b->lo.x = p.x < b->lo.x ? p.x : b->lo.x;
    b->lo.y = p.y < b->lo.y ? p.y : b->lo.y;
    b->hi.x = p.x > b->hi.x ? p.x : b->hi.x;
    b->hi.y = p.y > b->hi.y ? p.y : b->hi.y;
}

static const struct box no_box = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};

static struct box box_of_hull(const struct dt_mesh *m, const struct dt_point *xy)
{
    struct box b = no_box;
    uint32_t g = m->hull;
    do {
        box_add(&b, xy[dt_hull_vertex(m, g)]);
        g = dt_hull_step(m, g, false);
    } while (g != m->hull);
    return b;
}

/* Square cells, about `cells` of them; at least one row and one column whatever the box. */
static void grid_shape(struct dt_hint_grid *g, const struct box *b, double cells)
{
    double w = b->hi.x - b->lo.x, h = b->hi.y - b->lo.y;
    double nx = w == 0 ? 1 : h == 0 ? cells : ceil(sqrt(cells * (w / h)));
    nx = nx < cells ? nx : ceil(cells);
    double ny = h == 0 ? 1 : ceil(cells / nx);
    g->lo = b->lo;
    g->nx = (uint32_t)nx;
    g->ny = (uint32_t)ny;
    g->per_x = w == 0 ? 0 : nx / w;
    g->per_y = h == 0 ? 0 : ny / h;
}

static enum dt_status reserve_cells(struct dt_hints *g, double end)
{
    if (g->cell != NULL && end <= g->cell_cap)
        return DT_OK;
    double want = g->cell_cap == 0 ? end : end + end / 4;
    if (want > UINT32_MAX)
        return DT_NOMEM;
    uint32_t *cell = dt_array_grow(g->cell, g->cells, (size_t)want, sizeof *cell);
    if (cell == NULL)
        return DT_NOMEM;
    g->cell = cell;
    g->cell_cap = (uint32_t)want;
    return DT_OK;
}

/* Makes room for one more grid and its span. */
static enum dt_status reserve_grid(struct builder *b)
{
    struct dt_hints *g = b->hints;
    uint32_t want = 2 * g->grids + 1;
    if (g->grids == g->grid_cap) {
        struct dt_hint_grid *grid = dt_array_grow(g->grid, g->grids, want, sizeof *grid);
        if (grid == NULL)
            return DT_NOMEM;
        g->grid = grid;
        g->grid_cap = want;
    }
    if (g->grids == b->span_cap) {
        struct span *span = dt_array_grow(b->span, g->grids, want, sizeof *span);
        if (span == NULL)
            return DT_NOMEM;
        b->span = span;
        b->span_cap = want;
    }
    return DT_OK;
}

/* Drops half edges into the cells of one grid. Threads may meet in a cell: whose half edge it keeps
 * does not matter, nor does a point that is not counted. */
struct drop {
    struct dt_hint_grid grid;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    uint32_t *cell; /* the grid's first one, as of the count */
    uint8_t *count;
    unsigned slices;
};

static inline void drop(const struct drop *d, uint32_t v)
{
    uint32_t c = dt_hint_cell(&d->grid, d->xy[v]);
    uint8_t n = __atomic_load_n(&d->count[c], __ATOMIC_RELAXED);
    __atomic_store_n(&d->cell[c], d->mesh->leaving[v], __ATOMIC_RELAXED);
    __atomic_store_n(&d->count[c], (uint8_t)(n + (n < UINT8_MAX)), __ATOMIC_RELAXED);
}

static void drop_slice(void *arg, unsigned i)
{
    const struct drop d = *(const struct drop *)arg; /* which no store into count can change */
    uint32_t end = dt_slice(d.mesh->vert_cap, i + 1, d.slices);
    for (uint32_t v = dt_slice(d.mesh->vert_cap, i, d.slices); v < end; v++)
        if (d.mesh->leaving[v] != DT_NONE)
            drop(&d, v);
}

/* Drops all vertices of grid k: those of its span, or for grid 0 all that the mesh has. */
static void drop_all(const struct builder *b, uint32_t k)
{
    const struct dt_hint_grid *g = &b->hints->grid[k];
    struct drop d = {.grid = *g,
                     .mesh = b->mesh,
                     .xy = b->xy,
                     .count = b->count,
                     .cell = b->hints->cell + g->first,
                     .slices = b->slices};
    d.grid.first = 0;
    memset(b->count, 0, (size_t)g->nx * g->ny);
    if (k == 0) {
        dt_run(b->pool, b->slices, drop_slice, &d);
        return;
    }
    for (uint32_t i = b->span[k].from; i < b->span[k].to; i++)
        drop(&d, b->list[i]);
}

/* What a cell has, and how many cells away that comes from: 0 its own, FARTHEST + 1 nothing yet. */
struct content {
    uint32_t h;
    unsigned far;
};

/* The nearer one of a cell's content and its neighbour's. No branches: the outcome is a toss. */
static inline struct content nearer(struct content own, struct content next)
{
    unsigned far = next.far + (next.far < FARTHEST ? 1u : 0u);
    bool take = far < own.far;
    return (struct content){take ? next.h | DT_HINT_LENT : own.h, take ? far : own.far};
}

/* From left to right along a row and from the row below. */
static void sweep_up(uint32_t *cell, uint8_t *far, size_t nx, bool has_below)
{
    struct content left = {0, FARTHEST + 1};
    for (size_t i = 0; i < nx; i++) {
        struct content own = {cell[i], far[i]};
        if (has_below)
            own = nearer(own, (struct content){(cell - nx)[i], (far - nx)[i]});
        left = nearer(own, left);
        cell[i] = left.h;
        far[i] = (uint8_t)left.far;
    }
}

/* From right to left and from the row above, only for cells whose content is not near already. */
static void sweep_down(uint32_t *cell, uint8_t *far, size_t nx, bool has_above)
{
    for (size_t i = nx; i-- > 0;) {
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

/* Rows of one grid, in bands. */
struct fill {
    uint32_t *cell;
    uint8_t *far; /* counts at first */
    size_t nx;
    uint32_t rows;
    unsigned bands;
    atomic_bool bare; /* some band has no content at all */
};

static void fill_band(void *arg, unsigned i)
{
    struct fill *f = arg;
    uint32_t lo = dt_slice(f->rows, i, f->bands), hi = dt_slice(f->rows, i + 1, f->bands);
    size_t begin = lo * f->nx, end = hi * f->nx, nx = f->nx;
    uint32_t *cell = f->cell;
    uint8_t *far = f->far;
    for (size_t c = begin; c < end; c++)
        far[c] = far[c] == 0 ? FARTHEST + 1 : 0;
    for (size_t row = begin; row < end; row += nx)
        sweep_up(cell + row, far + row, nx, row > begin);
    for (size_t row = end; row > begin; row -= nx)
        sweep_down(cell + row - nx, far + row - nx, nx, row < end);
    if (begin < end && far[begin] > FARTHEST)
        atomic_store_explicit(&f->bare, true, memory_order_relaxed);
}

/* Every empty cell takes the content of one that is not, nearly of the nearest: a distance
 * transform in two sweeps [Rosenfeld & Pfaltz 1966], band by band; and once more over all if there
 * are bands without a point, which get theirs from beyond. b->count becomes the distances. */
static void fill_empty(const struct builder *b, const struct dt_hint_grid *g, unsigned bands)
{
    struct fill f = {.cell = b->hints->cell + g->first,
                     .far = b->count,
                     .nx = g->nx,
                     .rows = g->ny,
                     .bands = bands};
    dt_run(b->pool, bands, fill_band, &f);
    if (!atomic_load_explicit(&f.bare, memory_order_relaxed))
        return;
    for (uint32_t row = 1; row < f.rows; row++)
        sweep_up(f.cell + row * f.nx, f.far + row * f.nx, f.nx, true);
    for (uint32_t row = f.rows; row-- > 0;)
        sweep_down(f.cell + row * f.nx, f.far + row * f.nx, f.nx, row + 1 < f.rows);
}

static bool crowded(const struct builder *b, const struct dt_hint_grid *g, uint32_t v)
{
    return b->count[dt_hint_cell(g, b->xy[v]) - g->first] > CROWD;
}

static bool has_crowd(const struct builder *b, const struct dt_hint_grid *g)
{
    for (uint32_t i = 0; i < g->nx * g->ny; i++)
        if (b->count[i] > CROWD)
            return true;
    return false;
}

/* Moves the vertices of grid k > 0 that are in crowded cells to the front of its span and tells how
 * many they are. */
static uint32_t gather_crowd(struct builder *b, uint32_t k)
{
    const struct dt_hint_grid *g = &b->hints->grid[k];
    uint32_t n = 0, *list = b->list + b->span[k].from, size = b->span[k].to - b->span[k].from;
    for (uint32_t i = 0; i < size; i++) {
        uint32_t v = list[i];
        if (!crowded(b, g, v))
            continue;
        list[i] = list[n];
        list[n++] = v;
    }
    return n;
}

/* The same for grid 0, which has no span: makes the list. */
static enum dt_status list_crowd(struct builder *b, uint32_t *crowd)
{
    const struct dt_mesh *m = b->mesh;
    if (b->list == NULL)
        b->list = dt_array_new(m->vertices, sizeof *b->list);
    if (b->scratch == NULL)
        b->scratch = dt_array_new(m->vertices, sizeof *b->scratch);
    if (b->list == NULL || b->scratch == NULL)
        return DT_NOMEM;
    uint32_t n = 0;
    for (uint32_t v = 0, left = m->vertices; left > 0; v++) {
        if (m->leaving[v] == DT_NONE)
            continue;
        if (crowded(b, b->hints->grid, v))
            b->list[n++] = v;
        left--;
    }
    *crowd = n;
    return DT_OK;
}

static enum dt_status find_crowd(struct builder *b, uint32_t k, uint32_t *crowd)
{
    if (k == 0)
        return list_crowd(b, crowd);
    *crowd = gather_crowd(b, k);
    return DT_OK;
}

/* Gives each crowded cell of grid k a grid: numbers them, then sorts the n crowded vertices, at the
 * front of the span, by grid. Shapes come later, when each grid's own turn has come. */
static enum dt_status divide_crowd(struct builder *b, uint32_t k, uint32_t n)
{
    struct dt_hints *hints = b->hints;
    uint32_t first_child = hints->grids, from = k > 0 ? b->span[k].from : 0;
    uint32_t end = hints->grid[k].first + hints->grid[k].nx * hints->grid[k].ny;
    for (uint32_t c = hints->grid[k].first; c < end; c++) {
        if (b->count[c - hints->grid[k].first] <= CROWD)
            continue;
        enum dt_status s = reserve_grid(b);
        if (s != DT_OK)
            return s;
        b->span[hints->grids] = (struct span){0, 0};
        hints->cell[c] = hints->grids++ << 3 | IS_GRID;
    }
    const struct dt_hint_grid *g = &hints->grid[k];
    memcpy(b->scratch, b->list + from, n * sizeof *b->scratch);
    for (uint32_t i = 0; i < n; i++)
        b->span[hints->cell[dt_hint_cell(g, b->xy[b->scratch[i]])] >> 3].to++;
    for (uint32_t child = first_child, at = from; child < hints->grids; child++) {
        uint32_t size = b->span[child].to;
        b->span[child] = (struct span){at, at};
        at += size;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t child = hints->cell[dt_hint_cell(g, b->xy[b->scratch[i]])] >> 3;
        b->list[b->span[child].to++] = b->scratch[i];
    }
    return DT_OK;
}

/* Shapes grid k for n vertices in the box and drops them in. */
static enum dt_status place(struct builder *b, uint32_t k, const struct box *box, double cells)
{
    struct dt_hint_grid *g = &b->hints->grid[k];
    grid_shape(g, box, cells);
    g->first = b->hints->cells;
    enum dt_status s = reserve_cells(b->hints, (double)g->first + (double)g->nx * g->ny);
    if (s == DT_OK)
        drop_all(b, k);
    return s;
}

/* The box of the n vertices of grid k. */
static struct box box_of(const struct builder *b, uint32_t k, uint32_t *n)
{
    struct box box = no_box;
    *n = b->mesh->vertices;
    if (k == 0)
        return box_of_hull(b->mesh, b->xy);
    *n = b->span[k].to - b->span[k].from;
    for (uint32_t i = b->span[k].from; i < b->span[k].to; i++)
        box_add(&box, b->xy[b->list[i]]);
    return box;
}

static enum dt_status build_grid(struct builder *b, uint32_t k)
{
    struct dt_hints *hints = b->hints;
    uint32_t n, crowd = 0;
    assert(k == 0 || (b->list != NULL && b->span != NULL)); /* what made grid k filled its span */
    struct box box = box_of(b, k, &n);
    enum dt_status s = place(b, k, &box, n * CELLS_PER_POINT);
    bool refine =
        s == DT_OK && has_crowd(b, &hints->grid[k]) && hints->cells < MAX_CELLS * b->mesh->vertices;
    if (refine)
        s = find_crowd(b, k, &crowd);
    if (s == DT_OK && crowd > n / 2 && n * CELLS_PER_POINT_COARSE >= 2) {
        s = place(b, k, &box, n * CELLS_PER_POINT_COARSE);
        if (s == DT_OK)
            s = find_crowd(b, k, &crowd);
    }
    if (s == DT_OK && crowd > 0)
        s = divide_crowd(b, k, crowd);
    if (s != DT_OK)
        return s;
    fill_empty(b, &hints->grid[k], k == 0 ? b->slices : 1);
    hints->cells += hints->grid[k].nx * hints->grid[k].ny;
    return DT_OK;
}

/* Gives back what the grids reserved and did not need. */
static void trim(struct dt_hints *g)
{
    if (g->cell_cap == g->cells)
        return;
    uint32_t *cell = dt_array_grow(g->cell, g->cells, g->cells, sizeof *cell);
    if (cell != NULL) {
        g->cell = cell;
        g->cell_cap = g->cells;
    }
}

enum dt_status dt_hints_build(struct dt_hints *g, struct dt_mesh *m, const struct dt_point *xy,
                              const struct dt_pool *pool)
{
    struct dt_hints made = {0};
    dt_hints_clear(g);
    m->recycled = false;
    if (m->vertices < 2)
        return DT_OK;
    struct builder b = {.hints = &made,
                        .mesh = m,
                        .xy = xy,
                        .pool = pool,
                        .slices = dt_threads_for(pool, m->vertices)};
    b.count = dt_array_new((size_t)(m->vertices * CELLS_PER_POINT * 2) + 16, 1);
    enum dt_status s = b.count == NULL ? DT_NOMEM : reserve_grid(&b);
    if (s == DT_OK)
        made.grids = 1;
    for (uint32_t k = 0; s == DT_OK && k < made.grids; k++)
        s = build_grid(&b, k);
    dt_array_free(b.count);
    dt_array_free(b.list);
    dt_array_free(b.scratch);
    dt_array_free(b.span);
    if (s == DT_OK) {
        trim(&made);
        *g = made;
    } else {
        dt_hints_clear(&made);
    }
    return s;
}
