/* all_cells.c - all cells at once, in the order of the vertices in memory.
 *
 *      vertices     v0        v1     v2 ...      in Morton order: each circumcentre is computed once, for three cells
 *      corner[]     ------ -------- ------ ...
 *                   ^
 *      cell[id]     at, corners                  ids are in any order: reading one cell takes one cache miss or two, which
 *                                                are fetched ahead
 *
 * Made one by one, in the order of ids, a cell takes a dozen cache misses, and all of its circumcentres.
 *
 * Records of triangles are numbered in Morton order, too. So a walk over the vertices needs the triangles of few blocks of
 * records at a time: the circumcentres of a block are computed together, about once, and kept for a while. */
#include "core/cells/all_cells.h"

#include "core/cells/cell.h"
#include "core/cells/centre.h"
#include "core/mesh/hull.h"
#include "core/mesh/star.h"
#include "core/set/set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SPARE = 4096, /* corners of cells at the hull and the box, beyond those of triangles */
    PENDING = 64, /* cells whose areas are computed together */
    BLOCK = 16,   /* records: eight cache lines */
    BLOCKS = 2048 /* that are kept: half a megabyte of circumcentres */
};

struct circumcentres {
    struct dt_point at[BLOCKS * BLOCK];
    uint32_t block[BLOCKS]; /* which one is kept here; DT_NONE: none */
};

/* The corners of a cell: `corners` of them from `at` on. */
struct made {
    uint32_t at, corners; /* corners DT_NONE: there is no cell of that id */
};

struct dt_cells_made {
    struct dt_box box;
    bool areas;              /* these are kept instead of the cells: */
    double *area;            /* owns `ids`, by id; NaN: there is no cell of that id */
    struct made *cell;       /* owns `ids`, by id */
    struct dt_point *corner; /* owns cap, in the order of memory; of areas, of the last cells */
    uint32_t ids, cells;     /* cells: how many there will be */
    size_t corners, cap;
    bool whole; /* all have been made */
    /* while they are made */
    uint32_t vertex;              /* the next one */
    struct circumcentres *centre; /* owns */
    struct dt_cell_work work;
    struct dt_cell last[PENDING]; /* cells whose areas have not been computed yet */
    uint32_t pending;
};

/* ---- life ---- */

static enum dt_status begin(const struct dt *t, const struct dt_cells *c, bool areas,
                            struct dt_cells_made **out)
{
    *out = NULL;
    enum dt_status s = dt_readable_delaunay(t);
    if (s != DT_OK)
        return s;
    if (dt_mesh_is_line(&t->mesh) || t->points.next_id / 2 > dt_points_live(&t->points))
        return DT_OK;
    struct dt_cells_made *m = calloc(1, sizeof *m);
    if (m == NULL)
        return DT_NOMEM;
    m->box = (struct dt_box){c->lo, c->hi};
    m->areas = areas;
    m->ids = t->points.next_id;
    m->cells = c->rows;
    m->cap = 6 * (size_t)(areas ? PENDING : m->cells) + SPARE;
    *out = m;
    return DT_OK;
}

enum dt_status dt_cells_make_begin(const struct dt *t, const struct dt_cells *c,
                                   struct dt_cells_made **out)
{
    return begin(t, c, false, out);
}

enum dt_status dt_areas_make_begin(const struct dt *t, const struct dt_cells *c,
                                   struct dt_cells_made **out)
{
    return begin(t, c, true, out);
}

void dt_cells_made_free(struct dt_cells_made *m)
{
    if (m == NULL)
        return;
    dt_array_free(m->area);
    dt_array_free(m->cell);
    dt_array_free(m->corner);
    dt_cell_clear(&m->work);
    free(m->centre);
    free(m);
}

size_t dt_cells_made_memory(const struct dt_cells_made *m)
{
    size_t of_id = m->areas ? sizeof *m->area : sizeof *m->cell;
    return sizeof *m + (m->whole ? 0 : sizeof *m->centre) + dt_cell_memory(&m->work) +
           dt_array_bytes(m->ids, of_id) +
           (m->whole && m->areas ? 0 : dt_array_bytes(m->cap, sizeof *m->corner));
}

uint64_t dt_cells_made_corners(const struct dt_cells_made *m)
{
    return m->corners;
}

static bool reserve(const struct dt *t, struct dt_cells_made *m)
{
    if (m->cell != NULL || m->area != NULL)
        return true;
    struct dt_pages *pages = t->points.pages;
    m->centre = malloc(sizeof *m->centre);
    m->corner = dt_array_new_in(pages, m->cap, sizeof *m->corner);
    void *by_id = dt_array_new_in(pages, m->ids, m->areas ? sizeof *m->area : sizeof *m->cell);
    m->area = m->areas ? by_id : NULL;
    m->cell = m->areas ? NULL : by_id;
    if (m->centre == NULL || m->corner == NULL || by_id == NULL)
        return false;
    memset(m->centre->block, 0xff, sizeof m->centre->block);
    if (m->areas) /* all bits make a NaN */
        memset(m->area, 0xff, m->ids * sizeof *m->area);
    else
        memset(m->cell, 0xff, m->ids * sizeof *m->cell);
    return true;
}

/* Room for the corners of one more cell, and for those that are copied with them. */
static bool make_room(const struct dt *t, struct dt_cells_made *m, size_t corners)
{
    corners = corners < DT_CELL_USUAL ? DT_CELL_USUAL : corners;
    if (corners <= m->cap - m->corners)
        return true;
    size_t cap = m->corners + corners + m->cap / 8;
    if (cap >= UINT32_MAX)
        return false;
    if (!dt_array_resize(t->points.pages, &m->corner, m->corners, cap, sizeof *m->corner))
        return false;
    m->cap = cap;
    return true;
}

/* ---- circumcentres ---- */

static void find_block(struct circumcentres *c, const struct dt *t, uint32_t block)
{
    static const struct dt_point none[3] = {
        {0, 0}, {1, 0}, {0, 1}}; /* of ghosts and dead records */
    struct dt_point corner[BLOCK][3], *at = &c->at[block % BLOCKS * BLOCK];
    c->block[block % BLOCKS] = block;
    for (uint32_t i = 0; i < BLOCK; i++) {
        uint32_t record = block * BLOCK + i;
        const uint32_t *v = t->mesh.half + 8 * (size_t)record;
        bool is_triangle = record < t->mesh.tri_end && v[2] < DT_DEAD;
        for (uint32_t k = 0; k < 3; k++)
            corner[i][k] = is_triangle ? t->points.xy[v[k]] : none[k];
    }
    for (uint32_t i = 0; i < BLOCK; i += 2)
        dt_centre_two(corner[i], corner[i + 1], &at[i], &at[i + 1]);
}

/* The circumcentre of the triangle of the half edge, which has three corners; valid until the next call. */
static inline const struct dt_point *circumcentre(struct circumcentres *c, const struct dt *t,
                                                  uint32_t half)
{
    uint32_t triangle = half / 8, block = triangle / BLOCK;
    if (c->block[block % BLOCKS] != block)
        find_block(c, t, block);
    return &c->at[triangle % (BLOCKS * BLOCK)];
}

/* ---- making ---- */

/* The corners around the vertex, inside the hull, into work.centre, and the least and most of each coordinate. Returns how
 * many; 0: out of memory, or stopped. */
static uint32_t gather(const struct dt *t, struct dt_cells_made *m, uint32_t v, dt_lanes *least,
                       dt_lanes *most)
{
    uint32_t first = t->mesh.leaving[v], h = first, n = 0;
    *least = dt_lanes_both((double)INFINITY);
    *most = -*least;
    do {
        if (n % DT_POLL_MISSES == 0 && dt_stopped(m->work.stop))
            return 0;
        if (n == m->work.ring_cap) {
            uint32_t degree = dt_star_degree(&t->mesh, v, DT_NONE);
            if (!dt_cell_reserve(&m->work, degree))
                return 0;
            return gather(t, m, v, least, most);
        }
        dt_lanes centre = dt_lanes_load(&circumcentre(m->centre, t, h)->x);
        dt_lanes_store(&m->work.centre[n++].x, centre);
        *least = dt_lanes_least(*least, centre);
        *most = dt_lanes_most(*most, centre);
        h = dt_turn_ccw(&t->mesh, h);
    } while (h != first);
    return n;
}

/* The neighbours of the vertex into work.ring. Returns how many; 0: out of memory. */
static uint32_t gather_ring(const struct dt *t, struct dt_cells_made *m, uint32_t v)
{
    uint32_t first = t->mesh.leaving[v], h = first, n = 0;
    if (!dt_cell_reserve(&m->work, dt_star_degree(&t->mesh, v, DT_NONE)))
        return 0;
    do {
        uint32_t d = dt_dest(&t->mesh, h);
        if (d != DT_NONE)
            m->work.ring[n++] = t->points.xy[d];
        h = dt_turn_ccw(&t->mesh, h);
    } while (h != first);
    return n;
}

/* Takes work.polygon. */
static bool take(const struct dt *t, struct dt_cells_made *m, uint32_t *corners)
{
    if (!make_room(t, m, m->work.n))
        return false;
    memcpy(m->corner + m->corners, m->work.polygon, m->work.n * sizeof *m->corner);
    *corners = m->work.n;
    return true;
}

static bool make_inside(const struct dt *t, struct dt_cells_made *m, uint32_t v, uint32_t *corners)
{
    dt_lanes least, most;
    uint32_t n = gather(t, m, v, &least, &most);
    *corners = n;
    if (n == 0 || !make_room(t, m, n))
        return false;
    if (dt_cell_make_plain(m->work.centre, n, least, most, &m->box, m->corner + m->corners))
        return true;
    if (gather_ring(t, m, v) == 0)
        return false;
    dt_cell_make_around(&m->work, t->points.xy[v], n, &m->box);
    return take(t, m, corners);
}

static bool make_on_hull(const struct dt *t, struct dt_cells_made *m, uint32_t v, uint32_t *corners)
{
    uint32_t n = gather_ring(t, m, v);
    if (n == 0)
        return false;
    dt_cell_make(&m->work, t->points.xy[v], n, DT_CELL_ON_HULL, &m->box);
    return take(t, m, corners);
}

static void compute_areas(struct dt_cells_made *m)
{
    double area[PENDING];
    dt_cell_areas(m->last, m->pending, m->corner, area);
    for (uint32_t i = 0; i < m->pending; i++)
        m->area[m->last[i].id] = area[i];
    m->pending = 0;
    m->corners = 0;
}

static bool make_cell(const struct dt *t, struct dt_cells_made *m, uint32_t v)
{
    uint32_t n;
    if (!(dt_on_hull(&t->mesh, v) ? make_on_hull(t, m, v, &n) : make_inside(t, m, v, &n)))
        return false;
    if (m->areas)
        m->last[m->pending++] = (struct dt_cell){t->points.id[v], n};
    else
        m->cell[t->points.id[v]] = (struct made){(uint32_t)m->corners, n};
    m->corners += n;
    if (m->pending == PENDING)
        compute_areas(m);
    return true;
}

static enum dt_status make_some(const struct dt *t, struct dt_cells_made *m, uint32_t points)
{
    enum { AHEAD = 16 };
    uint32_t end = t->points.end;
    if (!reserve(t, m) || !dt_cell_reserve(&m->work, 1))
        return DT_NOMEM;
    for (; points > 0 && m->vertex < end; points--, m->vertex++) {
        uint32_t ahead = m->vertex + AHEAD;
        if (ahead < end) {
            dt_fetch(&t->mesh.half[t->mesh.leaving[ahead]]);
            if (!m->areas)
                dt_fetch(&m->cell[t->points.id[ahead]]);
        }
        if (t->points.id[m->vertex] != DT_NONE && !make_cell(t, m, m->vertex))
            return DT_NOMEM;
    }
    return DT_OK;
}

/* Frees the memory that only the making needs: for areas, the corners too. */
static void end_making(struct dt_cells_made *m)
{
    m->whole = true;
    dt_cell_clear(&m->work);
    free(m->centre);
    m->centre = NULL;
    if (m->areas)
        dt_array_free(m->corner);
    if (m->areas)
        m->corner = NULL;
}

enum dt_status dt_cells_make(const struct dt *t, struct dt_cells_made *m,
                             const struct dt_options *opt, uint32_t points, bool *done)
{
    struct dt_stop stop = dt_stop_of(opt);
    m->work.stop = &stop;
    enum dt_status s = make_some(t, m, points);
    m->work.stop = NULL;
    *done = m->vertex >= t->points.end;
    if (s == DT_OK && *done && m->pending > 0)
        compute_areas(m);
    if (s == DT_OK && *done)
        end_making(m);
    return dt_stop_status(&stop) != DT_OK ? dt_stop_status(&stop) : s;
}

/* ---- reading ---- */

static void fetch(const struct dt_cells_made *m, uint32_t id)
{
    if (id >= m->ids || m->cell[id].corners == DT_NONE)
        return;
    dt_fetch(&m->corner[m->cell[id].at]);
    dt_fetch(&m->corner[m->cell[id].at + 4]);
}

/* n corners, or DT_CELL_USUAL of them where there is room, without a loop whose end cannot be predicted. */
static void copy(struct dt_point *to, const struct dt_point *from, uint32_t n, size_t room)
{
    uint32_t end = n < DT_CELL_USUAL && room >= DT_CELL_USUAL ? DT_CELL_USUAL : n;
    for (uint32_t i = 0; i < end; i++)
        dt_lanes_store(&to[i].x, dt_lanes_load(&from[i].x));
}

enum dt_status dt_all_cells_read(struct dt_cells *c, struct dt_cell *cell, size_t room,
                                 struct dt_point *corner, size_t cap, size_t *n, size_t *corners)
{
    enum { AHEAD = 24 };
    const struct dt_cells_made *m = c->made;
    uint32_t end = c->end < m->ids ? c->end : m->ids;
    for (; c->id < end && *n < room; c->id++) {
        struct made k = m->cell[c->id];
        fetch(m, c->id + AHEAD);
        if (k.corners == DT_NONE)
            continue;
        if (k.corners > cap - *corners) {
            if (*n > 0)
                return DT_OK;
            *corners = k.corners;
            return DT_TOOSMALL;
        }
        cell[(*n)++] = (struct dt_cell){c->id, k.corners};
        copy(corner + *corners, m->corner + k.at, k.corners, cap - *corners);
        *corners += k.corners;
    }
    return DT_OK;
}

size_t dt_areas_read(struct dt_cells *c, uint32_t *id, double *area, size_t room)
{
    const struct dt_cells_made *m = c->made;
    uint32_t end = c->end < m->ids ? c->end : m->ids;
    size_t n = 0;
    for (; c->id < end && n < room; c->id++) {
        id[n] = c->id;
        area[n] = m->area[c->id];
        n += isnan(area[n]) ? 0 : 1;
    }
    return n;
}
