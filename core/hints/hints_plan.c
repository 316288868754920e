/* hints_plan.c - lays out the grids of hints, on a sample of the vertices.
 *
 * A sixteenth of the points shows well enough where they crowd, and on which scales; it may be wrong about
 * single cells, whose searches then take one more step. So the layout costs a fraction of a pass over all
 * vertices, however many grids lie within one another.
 *
 * Breadth first: a grid of CELLS_PER_POINT cells for each point that its samples stand for, then a
 * grid for each cell in which samples crowd, on their box, and so on. A grid most of whose samples are in
 * crowded cells is of little use, so it is remade with few cells: the next level will fit better. If all grids
 * together take more memory than a set may have for them, they are laid out again with fewer cells. */
#include "core/hints/hints.h"

#include <math.h>
#include <string.h>

#include "core/memory/memory.h"

#define CELLS_PER_POINT 0.9 /* of one grid; fewer if all of them take too much */
#define CELLS_PER_POINT_COARSE 0.125
#define CROWD 12u        /* points in one cell that are worth a grid */
#define CROWD_COARSE 48u /* the same of a coarse grid, where evenly spread ones have 8 to a cell */
#define MAX_CELLS 6.0    /* a point, over all grids; beyond that cells stay crowded */
#define BYTES_PER_POINT 6.0 /* for all grids of a set that is not small: 98 with all the rest */
#define HOPELESS 1.5        /* times that: points on so many scales that searches need it */
#define SMALL 10000u        /* points */
#define ATTEMPTS 4
#define STRIDE 16u   /* every STRIDE-th vertex is a sample */
#define SAMPLES 256u /* at least, if there are as many vertices */

/* The samples that a grid covers: list[from .. to - 1]. */
struct span {
    uint32_t from, to;
};

struct planner {
    struct dt_hints *hints;
    const struct dt_mesh *mesh;
    const struct dt_point *xy;
    struct dt_stop *stop;
    uint32_t stride, crowd; /* points that a sample stands for; samples that may share a cell */
    double density;         /* cells per point in one grid */
    uint8_t *count;         /* samples in each cell of the current grid, 255 for more */
    uint32_t *list;         /* the samples, grid by grid */
    uint32_t *scratch;      /* as long as list */
    uint32_t samples;
    struct span *span; /* by grid */
    uint32_t span_cap;
};

/* Square cells, about `cells` of them; at least one row and one column for any box. */
static void grid_shape(struct dt_hint_grid *g, const struct dt_box *b, double cells)
{
    double w = dt_box_width(b), h = dt_box_height(b);
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
    if (!dt_array_resize(g->pages, &g->cell, g->cells, (size_t)want, sizeof *g->cell))
        return DT_NOMEM;
    g->cell_cap = (uint32_t)want;
    return DT_OK;
}

/* Makes room for one more grid and its span. */
static enum dt_status reserve_grid(struct planner *p)
{
    struct dt_hints *g = p->hints;
    uint32_t want = 2 * g->grids + 1;
    if (g->grids == g->grid_cap) {
        if (!dt_array_resize(g->pages, &g->grid, g->grids, want, sizeof *g->grid))
            return DT_NOMEM;
        g->grid_cap = want;
    }
    if (g->grids == p->span_cap) {
        if (!dt_array_resize(g->pages, &p->span, g->grids, want, sizeof *p->span))
            return DT_NOMEM;
        p->span_cap = want;
    }
    return DT_OK;
}

/* The place of a sample in p->count. */
static uint32_t cell_of(const struct planner *p, const struct dt_hint_grid *g, uint32_t v)
{
    return dt_hint_cell(g, p->xy[v]) - g->first;
}

/* Shapes grid k for the box and counts its samples. */
static void shape_and_count(struct planner *p, uint32_t k, const struct dt_box *box, double cells)
{
    struct dt_hint_grid *g = &p->hints->grid[k];
    grid_shape(g, box, cells);
    g->first = p->hints->cells;
    memset(p->count, 0, (size_t)g->nx * g->ny);
    for (uint32_t i = p->span[k].from; i < p->span[k].to; i++) {
        uint8_t *count = &p->count[cell_of(p, g, p->list[i])];
        *count = (uint8_t)(*count + (*count < UINT8_MAX));
    }
}

/* Whether most samples share a cell with more than `limit` others. */
static bool most_are_crowded(const struct planner *p, uint32_t k, uint32_t limit)
{
    const struct dt_hint_grid *g = &p->hints->grid[k];
    uint32_t crowded = 0, from = p->span[k].from, to = p->span[k].to;
    for (uint32_t i = from; i < to; i++)
        crowded += p->count[cell_of(p, g, p->list[i])] > limit;
    return crowded > (to - from) / 2;
}

/* Moves the samples of grid k that are in crowded cells to the front of its span. Returns how many
 * there are. */
static uint32_t gather_crowd(struct planner *p, uint32_t k)
{
    const struct dt_hint_grid *g = &p->hints->grid[k];
    uint32_t n = 0, *list = p->list + p->span[k].from, size = p->span[k].to - p->span[k].from;
    for (uint32_t i = 0; i < size; i++) {
        uint32_t v = list[i];
        if (p->count[cell_of(p, g, v)] <= p->crowd)
            continue;
        list[i] = list[n];
        list[n++] = v;
    }
    return n;
}

/* Gives each crowded cell of grid k a grid: numbers them, then sorts the n crowded samples, at the
 * front of the span, by grid. Shapes come later, when each grid's own turn has come. */
static enum dt_status divide_crowd(struct planner *p, uint32_t k, uint32_t n)
{
    struct dt_hints *hints = p->hints;
    uint32_t first_child = hints->grids, from = p->span[k].from;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *cell = &hints->cell[dt_hint_cell(&hints->grid[k], p->xy[p->list[from + i]])];
        if (*cell & DT_HINT_GRID)
            continue;
        enum dt_status s = reserve_grid(p);
        if (s != DT_OK)
            return s;
        p->span[hints->grids] = (struct span){0, 0};
        *cell = hints->grids++ << 3 | DT_HINT_GRID;
    }
    const struct dt_hint_grid *g = &hints->grid[k];
    memcpy(p->scratch, p->list + from, n * sizeof *p->scratch);
    for (uint32_t i = 0; i < n; i++)
        p->span[hints->cell[dt_hint_cell(g, p->xy[p->scratch[i]])] >> 3].to++;
    for (uint32_t child = first_child, at = from; child < hints->grids; child++) {
        uint32_t size = p->span[child].to;
        p->span[child] = (struct span){at, at};
        at += size;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t child = hints->cell[dt_hint_cell(g, p->xy[p->scratch[i]])] >> 3;
        p->list[p->span[child].to++] = p->scratch[i];
    }
    return DT_OK;
}

/* The box of the samples of grid k, with a margin that other points are likely to reach. */
static struct dt_box box_of_samples(const struct planner *p, uint32_t k)
{
    uint32_t from = p->span[k].from, n = p->span[k].to - from;
    struct dt_box box = dt_box_of(&p->xy[p->list[from]], 1);
    for (uint32_t i = from + 1; i < from + n; i++)
        dt_box_add(&box, p->xy[p->list[i]]);
    if (p->stride > 1) {
        double w = dt_box_width(&box) * 2 / n, h = dt_box_height(&box) * 2 / n;
        box = (struct dt_box){{box.lo.x - w, box.lo.y - h}, {box.hi.x + w, box.hi.y + h}};
    }
    return box;
}

/* Its passes over the samples, a sixteenth of the vertices, do not poll; the work between them does. */
static enum dt_status plan_grid(struct planner *p, uint32_t k)
{
    struct dt_hints *hints = p->hints;
    struct dt_box box = box_of_samples(p, k);
    double n = (double)(p->span[k].to - p->span[k].from) * p->stride;
    shape_and_count(p, k, &box, n * CELLS_PER_POINT_COARSE);
    if (!dt_stopped(p->stop) && !most_are_crowded(p, k, CROWD_COARSE / p->stride))
        shape_and_count(p, k, &box, n * p->density);
    struct dt_hint_grid g = hints->grid[k];
    uint32_t end = g.first + g.nx * g.ny, crowd = 0;
    enum dt_status s = reserve_cells(hints, end);
    if (s != DT_OK)
        return s;
    for (struct dt_piece at = dt_pieces(g.first, end); dt_next_piece(p->stop, &at);)
        for (uint32_t c = at.a; c < at.b; c++)
            hints->cell[c] = DT_HINT_LENT;
    hints->cells = end;
    if (end < MAX_CELLS * p->mesh->vertices && !dt_stopped(p->stop))
        crowd = gather_crowd(p, k);
    return crowd > 0 ? divide_crowd(p, k, crowd) : dt_stop_status(p->stop);
}

/* Takes the samples; there is room for them. */
static void take_samples(struct planner *p)
{
    const struct dt_mesh *m = p->mesh;
    uint32_t wait = 0;
    for (struct dt_piece at = dt_pieces(0, m->vert_cap); dt_next_piece(p->stop, &at);)
        for (uint32_t v = at.a; v < at.b; v++) {
            if (m->leaving[v] == DT_NONE || wait-- > 0)
                continue;
            p->list[p->samples++] = v;
            wait = p->stride - 1;
        }
}

/* Lays out all grids for the samples. */
static enum dt_status plan_grids(struct planner *p)
{
    p->hints->cells = p->hints->grids = 0;
    enum dt_status s = dt_stopped(p->stop) ? dt_stop_status(p->stop) : reserve_grid(p);
    if (s == DT_OK)
        p->span[p->hints->grids++] = (struct span){0, p->samples};
    for (uint32_t k = 0; s == DT_OK && k < p->hints->grids; k++)
        s = plan_grid(p, k);
    return s;
}

/* The factor by which the grids exceed their memory; 1 if they do not, or if fewer cells would not help. */
static double excess(const struct planner *p)
{
    const struct dt_hints *g = p->hints;
    double bytes = (double)g->cells * sizeof *g->cell + (double)g->grids * sizeof *g->grid;
    double factor = bytes / (BYTES_PER_POINT * p->mesh->vertices);
    return p->mesh->vertices < SMALL || factor < 1 || factor > HOPELESS ? 1 : factor;
}

static void *shrink(void *array, uint32_t used, uint32_t *cap, size_t size)
{
    void *fitting = *cap == used ? NULL : dt_array_grow(array, used, used, size);
    if (fitting == NULL)
        return array;
    *cap = used;
    return fitting;
}

/* Gives back the reserved memory that is not needed. */
static void trim(struct dt_hints *g)
{
    g->cell = shrink(g->cell, g->cells, &g->cell_cap, sizeof *g->cell);
    g->grid = shrink(g->grid, g->grids, &g->grid_cap, sizeof *g->grid);
}

void dt_hints_plan(struct dt_hints *g, const struct dt_mesh *m, const struct dt_point *xy,
                   struct dt_stop *stop)
{
    struct planner p = {.hints = g,
                        .mesh = m,
                        .xy = xy,
                        .stop = stop,
                        .stride = m->vertices / SAMPLES,
                        .density = CELLS_PER_POINT};
    p.stride = p.stride < 1 ? 1 : p.stride > STRIDE ? STRIDE : p.stride;
    p.crowd = CROWD / p.stride < 1 ? 1 : CROWD / p.stride;
    size_t samples = m->vertices / p.stride + 1;
    p.count = dt_array_new((size_t)(m->vertices * CELLS_PER_POINT * 2) + 64, 1);
    p.list = dt_array_new(samples, sizeof *p.list);
    p.scratch = dt_array_new(samples, sizeof *p.scratch);
    enum dt_status s = DT_NOMEM;
    if (p.count != NULL && p.list != NULL && p.scratch != NULL) {
        take_samples(&p);
        s = plan_grids(&p);
    }
    for (int i = 1; s == DT_OK && i < ATTEMPTS && excess(&p) > 1; i++) {
        p.density /= excess(&p) * excess(&p); /* the cells of coarse grids stay as many */
        s = plan_grids(&p);
    }
    dt_array_free(p.count);
    dt_array_free(p.list);
    dt_array_free(p.scratch);
    dt_array_free(p.span);
    if (s == DT_OK)
        trim(g);
    else
        dt_stop_because(stop, s);
}
