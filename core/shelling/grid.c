/* grid.c - building the uniform grid and its two searches for points: see grid.h for the structure.
 *
 * Source: the paper, "Preprocessing the data" and "Finding a start point and the first edge".
 * Deviations: (1) Cells are runs of one array instead of linked lists. (2) The box needs no offset by TOL,
 * because points on its border cannot fall out of a clamped cell number. (3) Coincident points were
 * recognised before. (4) The side of a cell is at least 1/n of the box, so there are at most 3n + 1 cells
 * for any shape of the box. (5) Crowded cells have cells of their own. */
#include "core/shelling/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/exact/predicates.h"
#include "core/memory/memory.h"

/* A cell with more points than this gets cells of its own. On evenly spread points, which have 16/9
 * in a cell on average, that never happens. */
#define CROWD 32

/* If one cell of a grid holds more than half of the points, the grid is made again as a zoom, in the same memory. Its
 * cells have the side that a grid for ZOOM points would have. A zoom makes the box smaller by a factor of at least 4; other
 * grids halve the number of points. An axis has 2^400 places, so cells are nested less than 28 + 400/2 deep. */
#define ZOOM 64

/* Steps for each point or cell of a pass, and for a point that is compared by distance. */
#define PASS_STEPS 4u
#define COMPARE_STEPS 16u
#define BETWEEN_POLLS (1u << 19) /* steps: a millisecond, or ten where they are slow */

/* The state of building, besides the grid itself. */
struct builder {
    struct dt_grid *grid;
    uint32_t *cell;      /* room for a cell number of each point */
    struct dt_point *xy; /* room for the points of a crowded cell, and where they are from */
    uint32_t *from;
};

/* Points on their way into the grid. */
struct source {
    const struct dt_point *xy;
    const uint32_t *from; /* NULL: they are the caller's array itself */
    uint32_t n;
};

bool dt_grid_spend(struct dt_stop *stop, uint64_t steps)
{
    if (stop == NULL)
        return false;
    uint64_t left = stop->left;
    stop->left = steps > left ? 0 : left - steps;
    if (steps > left)
        dt_stop_because(stop, DT_TOOBIG);
    if (left / BETWEEN_POLLS == stop->left / BETWEEN_POLLS)
        return dt_stop_status(stop) != DT_OK;
    return dt_stopped(stop);
}

static enum dt_status status_of(const struct builder *b)
{
    return b->grid->stop == NULL ? DT_OK : dt_stop_status(b->grid->stop);
}

/* Of a pass over points or cells; false: it is over, or has to stop. */
static bool next_piece(const struct builder *b, struct dt_piece *at)
{
    return dt_next_piece(NULL, at) && !dt_grid_spend(b->grid->stop, PASS_STEPS * (at->b - at->a));
}

static void cells_clear(struct dt_cells *c)
{
    for (uint32_t i = 0; i < c->subs; i++)
        cells_clear(&c->sub[i]);
    free(c->sub);
    free(c->sub_cell);
    dt_array_free(c->start);
    *c = (struct dt_cells){.subs = 0};
}

void dt_grid_clear(struct dt_grid *g)
{
    cells_clear(&g->top);
    *g = (struct dt_grid){.n = 0};
}

/* Box, side, lines and their length for points of which `share` are meant to be spread evenly. */
static void cells_measure(struct dt_cells *c, const struct builder *b, struct source p,
                          uint32_t share)
{
    struct dt_box box = dt_box_of(p.xy, 1);
    for (struct dt_piece at = dt_pieces(0, p.n); next_piece(b, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            dt_box_add(&box, p.xy[i]);
    double width = dt_box_width(&box), height = dt_box_height(&box);
    c->lo = box.lo;
    c->side = fmax(sqrt(width * height / share) * 4 / 3, fmax(width, height) / share);
    if (c->side == 0)
        c->side = 1; /* a single point */
    c->per_unit = 1 / c->side;
    c->upright = height > width;
    c->lines = (uint32_t)dt_cells_across(c, box.hi) + 1;
    c->length = (uint32_t)dt_cells_along(c, box.hi) + 1;
}

/* Finds the cell of each point, and makes the places in `start`, which begin at `first`. *most is
 * how many the fullest cell has. */
static enum dt_status cells_count(struct dt_cells *c, const struct builder *b, struct source p,
                                  uint32_t first, uint32_t *most)
{
    uint32_t cells = c->lines * c->length;
    dt_array_free(c->start);
    c->start = dt_array_new((size_t)cells + 2, sizeof *c->start);
    if (c->start == NULL)
        return DT_NOMEM;
    for (struct dt_piece at = dt_pieces(0, cells + 2); next_piece(b, &at);)
        memset(c->start + at.a, 0, (at.b - at.a) * sizeof *c->start);
    uint32_t *begin = c->start + 1; /* begin[i] = start[i], until cells_fill moves it on */
    for (struct dt_piece at = dt_pieces(0, p.n); next_piece(b, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            b->cell[i] = dt_cells_index(c, p.xy[i]);
            begin[b->cell[i] + 1]++;
        }
    *most = 0;
    c->start[0] = begin[0] = first;
    for (struct dt_piece at = dt_pieces(0, cells); next_piece(b, &at);)
        for (uint32_t i = at.a + 1; i <= at.b; i++) {
            *most = begin[i] > *most ? begin[i] : *most;
            begin[i] += begin[i - 1];
        }
    return status_of(b);
}

/* Puts the points at their places. */
static void cells_fill(struct dt_cells *c, const struct builder *b, struct source p)
{
    uint32_t *end = c->start + 1; /* of each cell, in the end */
    for (struct dt_piece at = dt_pieces(0, p.n); next_piece(b, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            uint32_t place = end[b->cell[i]]++;
            b->grid->xy[place] = p.xy[i];
            b->grid->from[place] = p.from == NULL ? i : p.from[i];
        }
}

static enum dt_status cells_refine(struct dt_cells *c, struct builder *b);

/* Builds the cells of points whose places begin at `first`, and those inside of them. */
static enum dt_status cells_build(struct dt_cells *c, struct builder *b, struct source p,
                                  uint32_t first)
{
    uint32_t most;
    cells_measure(c, b, p, p.n);
    enum dt_status status = cells_count(c, b, p, first, &most);
    if (status == DT_OK && most > p.n / 2 && p.n > ZOOM) {
        cells_measure(c, b, p, ZOOM);
        status = cells_count(c, b, p, first, &most);
    }
    if (status != DT_OK)
        return status;
    cells_fill(c, b, p);
    status = status_of(b);
    return status == DT_OK && most > CROWD ? cells_refine(c, b) : status;
}

static uint32_t cell_points(const struct dt_cells *c, uint32_t cell)
{
    return c->start[cell + 1] - c->start[cell];
}

/* Gives the crowded cell number `cell` of c cells of its own in *sub. */
static enum dt_status cell_refine(const struct dt_cells *c, uint32_t cell, struct dt_cells *sub,
                                  struct builder *b)
{
    uint32_t first = c->start[cell], n = cell_points(c, cell);
    for (struct dt_piece at = dt_pieces(0, n); next_piece(b, &at);) {
        memcpy(b->xy + at.a, b->grid->xy + first + at.a, (at.b - at.a) * sizeof *b->xy);
        memcpy(b->from + at.a, b->grid->from + first + at.a, (at.b - at.a) * sizeof *b->from);
    }
    return cells_build(sub, b, (struct source){b->xy, b->from, n}, first);
}

/* Room for the points of one crowded cell at a time, for the largest first. */
static bool make_room(struct builder *b)
{
    if (b->xy == NULL) {
        b->xy = dt_array_new(b->grid->n, sizeof *b->xy);
        b->from = dt_array_new(b->grid->n, sizeof *b->from);
    }
    return b->xy != NULL && b->from != NULL;
}

/* Gives every crowded cell of c cells of its own. */
static enum dt_status cells_refine(struct dt_cells *c, struct builder *b)
{
    uint32_t cells = c->lines * c->length, crowded = 0;
    for (struct dt_piece at = dt_pieces(0, cells); next_piece(b, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            crowded += cell_points(c, i) > CROWD;
    if (status_of(b) != DT_OK)
        return status_of(b);
    c->sub = calloc(crowded, sizeof *c->sub);
    c->sub_cell = malloc(crowded * sizeof *c->sub_cell);
    if (c->sub == NULL || c->sub_cell == NULL || !make_room(b))
        return DT_NOMEM;
    for (struct dt_piece at = dt_pieces(0, cells); next_piece(b, &at);)
        for (uint32_t i = at.a; i < at.b; i++) {
            if (cell_points(c, i) <= CROWD)
                continue;
            c->sub_cell[c->subs++] = i;
            enum dt_status status = cell_refine(c, i, &c->sub[c->subs - 1], b);
            if (status != DT_OK)
                return status;
        }
    return status_of(b);
}

enum dt_status dt_grid_build(struct dt_grid *g, const struct dt_point *in, uint32_t n,
                             struct dt_point *xy, uint32_t *from)
{
    struct builder b = {.grid = g, .cell = dt_array_new(n, sizeof *b.cell)};
    *g = (struct dt_grid){.xy = xy, .from = from, .n = n, .stop = g->stop};
    enum dt_status status = DT_NOMEM;
    if (b.cell != NULL)
        status = cells_build(&g->top, &b, (struct source){in, NULL, n}, 0);
    dt_array_free(b.cell);
    dt_array_free(b.xy);
    dt_array_free(b.from);
    if (status != DT_OK)
        dt_grid_clear(g);
    return status;
}

uint32_t dt_cells_first_sub(const struct dt_cells *c, uint32_t cell)
{
    uint32_t lo = 0, hi = c->subs;
    while (lo < hi) {
        uint32_t mid = (lo + hi) / 2;
        if (c->sub_cell[mid] < cell)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

double dt_grid_spacing(const struct dt_grid *g, struct dt_point p)
{
    const struct dt_cells *c = &g->top;
    while (c->subs > 0) {
        uint32_t cell = dt_cells_index(c, p), i = dt_cells_first_sub(c, cell);
        if (i == c->subs || c->sub_cell[i] != cell)
            break;
        c = &c->sub[i];
    }
    return c->side;
}

/* ---- start point and first edge ---- */

/* A rectangle of cells: lines first_line..last_line, cells first..last of each, clipped to the
 * grid. */
struct window {
    int64_t first_line, last_line, first, last;
};

/* Calls visit for every run of places of the window that is not empty. */
static void visit_window(const struct dt_cells *c, struct window w,
                         void (*visit)(void *arg, uint32_t i, uint32_t end), void *arg)
{
    int64_t lines = c->lines, length = c->length;
    w.first_line = w.first_line < 0 ? 0 : w.first_line;
    w.last_line = w.last_line >= lines ? lines - 1 : w.last_line;
    w.first = w.first < 0 ? 0 : w.first;
    w.last = w.last >= length ? length - 1 : w.last;
    if (w.first > w.last)
        return;
    for (int64_t j = w.first_line; j <= w.last_line; j++) {
        uint32_t i = c->start[j * length + w.first], end = c->start[j * length + w.last + 1];
        if (i < end)
            visit(arg, i, end);
    }
}

/* Calls visit for the ring of cells at distance k around cell (i, j), on the sides whose bit is set in `sides`.
 * Sides 0 and 1 are the lines above and below, sides 2 and 3 the cells left and right. */
static void visit_ring(const struct dt_cells *c, int64_t i, int64_t j, int64_t k, unsigned sides,
                       void (*visit)(void *arg, uint32_t i, uint32_t end), void *arg)
{
    struct window side[4] = {{j + k, j + k, i - k, i + k},
                             {j - k, j - k, i - k, i + k},
                             {j - k + 1, j + k - 1, i - k, i - k},
                             {j - k + 1, j + k - 1, i + k, i + k}};
    for (int s = 0; s < (k == 0 ? 1 : 4); s++)
        if (sides >> s & 1)
            visit_window(c, side[s], visit, arg);
}

static void take_first(void *arg, uint32_t i, uint32_t end)
{
    uint32_t *place = arg;
    if (*place == DT_NONE)
        *place = i;
}

/* The steps that a ring at distance k costs, without the steps of the visits. */
static uint64_t ring_steps(int64_t k)
{
    return 16 + 8 * (uint64_t)k;
}

uint32_t dt_grid_middle(struct dt_grid *g)
{
    const struct dt_cells *c = &g->top;
    uint32_t place = DT_NONE;
    for (int64_t k = 0; place == DT_NONE; k++) { /* ends, as the grid holds points */
        visit_ring(c, c->length / 2, c->lines / 2, k, 15, take_first, &place);
        if (dt_grid_spend(g->stop, ring_steps(k)))
            return 0;
    }
    return place;
}

struct nearest {
    struct dt_grid *grid;
    uint32_t from, best;
    double distance; /* to the best one; rounded */
};

static void take_nearest(void *arg, uint32_t i, uint32_t end)
{
    struct nearest *s = arg;
    const struct dt_point *xy = s->grid->xy, from = xy[s->from];
    for (; i < end && !dt_grid_spend(s->grid->stop, COMPARE_STEPS); i++) {
        if (i == s->from || dt_grid_removed(s->grid, i))
            continue;
        if (s->best == DT_NONE || dt_compare_distance(from, xy[i], xy[s->best]) < 0) {
            s->best = i;
            s->distance = sqrt(dt_square_distance(xy[i], from));
        }
    }
}

/* Rows and columns around the point's cell, farther and farther; a direction ends once the perpendicular to its
 * nearest side is longer than the distance found [the paper, fig. 3]. The factor covers all rounding. */
uint32_t dt_grid_nearest(struct dt_grid *g, uint32_t place)
{
    const struct dt_cells *c = &g->top;
    struct nearest s = {g, place, DT_NONE, HUGE_VAL};
    double u = dt_cells_along(c, g->xy[place]), v = dt_cells_across(c, g->xy[place]);
    uint32_t i = dt_cell(u, c->length), j = dt_cell(v, c->lines);
    unsigned sides = 15;
    visit_ring(c, i, j, 0, sides, take_nearest, &s);
    for (int64_t k = 1; sides != 0; k++) {
        double reach = s.distance * c->per_unit * (1 + DT_RING_ROOM) + DT_RING_ROOM;
        double gap[4] = {(double)(j + k) - v, v - (double)(j - k + 1), u - (double)(i - k + 1),
                         (double)(i + k) - u};
        bool outside[4] = {j + k >= c->lines, k > j, k > i, i + k >= c->length};
        for (unsigned side = 0; side < 4; side++)
            if (gap[side] > reach || outside[side])
                sides &= ~(1u << side);
        visit_ring(c, i, j, k, sides, take_nearest, &s);
        if (dt_grid_spend(g->stop, ring_steps(k)))
            break;
    }
    return s.best;
}
