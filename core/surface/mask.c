/* mask.c - the cells of a raster that are inside borders, by the edges at which that changes.
 *
 *       row ----(--------)-----(------      A row is outside in the west. It changes sides at each edge that it crosses: an edge
 *               a        b     c            contains its lower end, not its upper one. Cells on an edge are inside.
 *
 * Exact signs decide which cell of a row is the first one to the east of an edge, and which cells are on the edge. Edges are found
 * along the constraints that are borders, so triangles are not looked at. If there are more edges than cells, each cell is looked up
 * by itself. */
#include "core/constraints/enforce.h"
#include "core/delaunay_surface.h"
#include "core/exact/predicates.h"
#include "core/memory/sort.h"
#include "core/mesh/fixed.h"
#include "core/query/locate.h"
#include "core/query/prefetch.h"
#include "core/query/query.h"

#include <stdlib.h>
#include <string.h>

enum {
    MOST = 1 << 18, /* edges: 1 MB */
    CELLS_POLLED = 4096
};

struct mask {
    const struct dt *t;
    const struct dt_raster *r;
    struct dt_enclosure in;
    uint32_t *half; /* owns `most` */
    size_t n, most;
    struct dt_stop stop;
    uint8_t *bits, *on; /* borrows; owns: cells on an edge */
};

/* ---- edges ---- */

static bool encloses(const struct mask *k, uint32_t half)
{
    const struct dt_mesh *m = &k->t->mesh;
    return !dt_is_ghost(m, half) && dt_encloses(&k->in, dt_face(m, half));
}

/* Lists the edges of the constraint with the inside on one side. False: there are too many. */
static bool list_edges(struct mask *k, const struct dt_constraint *c)
{
    const struct dt_mesh *m = &k->t->mesh;
    const struct dt_point *xy = k->t->points.xy;
    uint32_t v = dt_points_vertex(&k->t->points, c->a), end = dt_points_vertex(&k->t->points, c->b);
    for (uint32_t half; v != end; v = dt_dest(m, half)) {
        half = dt_chain_next(m, xy, m->leaving[v], xy[end]);
        if (half == DT_NONE || k->n == k->most)
            return false;
        uint32_t twin = dt_twin(m, half);
        if (encloses(k, half) != encloses(k, twin))
            k->half[k->n++] = half < twin ? half : twin;
    }
    return true;
}

/* Lists the edges of the border of the number, or of all: DT_NONE. False: there are too many. */
static bool list_all(struct mask *k, uint32_t number)
{
    const struct dt_declared *d = &k->t->constraints->declared;
    bool few = d->borders <= k->most;
    for (uint32_t i = 0; i < d->end && few && !dt_stopped(&k->stop); i++) {
        if (!dt_declared_is_live(d, i))
            continue;
        struct dt_constraint c = dt_declared_get(d, i);
        if (c.border && (number == DT_NONE || c.number == number))
            few = list_edges(k, &c);
    }
    k->n = dt_sort_unique(k->half, k->n, NULL, NULL);
    return few;
}

/* ---- rows ---- */

static void set(uint8_t *bits, uint64_t cell)
{
    bits[cell / 8] |= (uint8_t)(1 << cell % 8);
}

static struct dt_point centre(const struct mask *k, uint32_t row, uint32_t column)
{
    return dt_raster_centre(k->r, (uint64_t)row * k->r->columns + column);
}

/* The first row whose centres are not above y, or are below it. */
static uint32_t first_row(const struct mask *k, double y, bool below)
{
    uint32_t lo = 0, hi = k->r->rows;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        double at = centre(k, middle, 0).y;
        if (below ? at < y : at <= y)
            hi = middle;
        else
            lo = middle + 1;
    }
    return lo;
}

/* The first column whose centre is to the east of an edge from a up to b. Near: a guess. */
static uint32_t first_column(const struct mask *k, struct dt_point a, struct dt_point b,
                             uint32_t row, uint32_t near)
{
    uint32_t lo = 0, hi = k->r->columns;
    for (uint32_t c = near; lo < hi; c = lo + (hi - lo) / 2) {
        if (dt_orient2d(a, b, centre(k, row, c)) < 0) {
            hi = c;
            if (c > lo && dt_orient2d(a, b, centre(k, row, c - 1)) >= 0)
                return c;
        } else
            lo = c + 1;
        if (c == near && lo == near + 1 && lo < hi && dt_orient2d(a, b, centre(k, row, lo)) < 0)
            return lo;
    }
    return lo;
}

/* The column in which the line of the edge crosses the row, about. */
static uint32_t guess(const struct mask *k, struct dt_point a, struct dt_point b, double y)
{
    const struct dt_raster *r = k->r;
    double x = a.x + (b.x - a.x) / (b.y - a.y) * (y - a.y);
    double c = (x - r->lo.x) / (r->hi.x - r->lo.x) * r->columns;
    return !(c > 0) ? 0 : c < r->columns ? (uint32_t)c : r->columns - 1;
}

/* The cells of a row that are on a level edge, or at its ends. */
static void mark_level(struct mask *k, struct dt_point a, struct dt_point b, uint32_t row)
{
    double west = a.x < b.x ? a.x : b.x, east = a.x < b.x ? b.x : a.x;
    for (uint32_t c = 0; c < k->r->columns; c++) {
        double x = centre(k, row, c).x;
        if (x >= west && x <= east)
            set(k->on, (uint64_t)row * k->r->columns + c);
    }
}

static void cross(struct mask *k, struct dt_point a, struct dt_point b, uint32_t row)
{
    const uint32_t columns = k->r->columns;
    const uint64_t begin = (uint64_t)row * columns;
    const double y = centre(k, row, 0).y;
    uint32_t east = first_column(k, a, b, row, guess(k, a, b, y));
    for (uint32_t c = east; c > 0 && dt_orient2d(a, b, centre(k, row, c - 1)) == 0; c--)
        set(k->on, begin + c - 1);
    if (y < b.y && east < columns)
        k->bits[(begin + east) / 8] ^= (uint8_t)(1 << (begin + east) % 8);
}

/* Crosses all rows that meet the edge. */
static void cross_rows(struct mask *k, uint32_t half)
{
    const struct dt_mesh *m = &k->t->mesh;
    struct dt_point a = k->t->points.xy[dt_origin(m, half)], b = k->t->points.xy[dt_dest(m, half)];
    if (a.y > b.y) {
        struct dt_point lower = b;
        b = a;
        a = lower;
    }
    uint32_t end = first_row(k, a.y, true);
    for (uint32_t row = first_row(k, b.y, false); row < end && !dt_stopped(&k->stop); row++)
        if (a.y == b.y)
            mark_level(k, a, b, row);
        else
            cross(k, a, b, row);
}

/* From the cells where a row changes sides to those that are inside. */
static void fill_rows(struct mask *k)
{
    const uint64_t columns = k->r->columns, n = columns * k->r->rows;
    uint64_t column = 0;
    unsigned inside = 0;
    for (uint64_t i = 0; i < n; i++) {
        if (i % CELLS_POLLED == 0 && dt_stopped(&k->stop))
            return;
        inside ^= k->bits[i / 8] >> i % 8 & 1;
        if (inside)
            set(k->bits, i);
        else
            k->bits[i / 8] &= (uint8_t) ~(1 << i % 8);
        if (++column == columns)
            column = inside = 0;
    }
    for (uint64_t i = 0; i < (n + 7) / 8; i++)
        k->bits[i] |= k->on[i];
}

static void mark_by_edges(struct mask *k)
{
    for (size_t i = 0; i < k->n; i++)
        cross_rows(k, k->half[i]);
    fill_rows(k);
}

/* ---- single cells ---- */

static bool is_inside(const struct mask *k, const struct dt_place *p)
{
    const struct dt_mesh *m = &k->t->mesh;
    uint32_t half;
    enum dt_where where = dt_find(k->t, p, &half);
    bool inside = where != DT_OUTSIDE && encloses(k, half);
    if (where == DT_ON_EDGE)
        return inside || encloses(k, dt_twin(m, half));
    for (uint32_t h = dt_turn_ccw(m, half); where == DT_ON_VERTEX && !inside && h != half;
         h = dt_turn_ccw(m, h))
        inside = encloses(k, h);
    return inside;
}

static void mark_by_places(struct mask *k, uint64_t cells)
{
    struct dt_place place[DT_AHEAD];
    size_t n;
    for (uint64_t from = 0; from < cells && !dt_stopped(&k->stop); from += n) {
        n = cells - from < DT_AHEAD ? (size_t)(cells - from) : DT_AHEAD;
        for (size_t i = 0; i < n; i++)
            place[i].at = dt_raster_centre(k->r, from + i);
        dt_walk_to_places(k->t, place, n, DT_PLACE_READ);
        for (size_t i = 0; i < n; i++)
            if (is_inside(k, &place[i]))
                set(k->bits, from + i);
    }
}

enum dt_status dt_raster_inside(const struct dt *t, uint32_t number, const struct dt_raster *r,
                                const struct dt_options *opt, uint8_t *bits)
{
    const uint64_t n = (uint64_t)r->columns * r->rows;
    const size_t bytes = (size_t)((n + 7) / 8);
    struct mask k = {.t = t, .r = r, .bits = bits, .stop = dt_stop_of(opt)};
    enum dt_status status = dt_enclosure_of(t, number, &k.in);
    if (status == DT_OK && !dt_has_closed_border(t))
        status = DT_OPEN;
    if (status != DT_OK)
        return status;
    k.most = n < MOST ? (size_t)n : MOST;
    k.half = malloc(k.most * sizeof *k.half);
    k.on = calloc(bytes, 1);
    memset(bits, 0, bytes);
    if (k.half == NULL || k.on == NULL)
        dt_stop_because(&k.stop, DT_NOMEM);
    else if (list_all(&k, number))
        mark_by_edges(&k);
    else
        mark_by_places(&k, n);
    free(k.half);
    free(k.on);
    return dt_stop_status(&k.stop);
}
