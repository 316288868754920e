/* voronoi.c - the cells of a set one after the other, now or at the moment of a view.
 *
 * Each cell is computed from its star alone (cell.h), which needs neither memory nor an order of the cells. But a
 * circumcentre is computed three times, once for each corner of its triangle. all_cells.c makes all cells at once. */
#include "core/cells/all_cells.h"
#include "core/cells/cell.h"
#include "core/mesh/hull.h"
#include "core/set/set.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the box ---- */

static void add(struct dt_bounds *b, struct dt_point p)
{
    struct dt_box box = b->any ? (struct dt_box){b->lo, b->hi} : (struct dt_box){p, p};
    dt_box_add(&box, p);
    b->any = true;
    b->lo = box.lo;
    b->hi = box.hi;
}

static bool add_hull(const struct dt *t, struct dt_bounds *b, size_t steps)
{
    const struct dt_mesh *m = &t->mesh;
    if (m->vertices < 2) {
        if (m->vertices == 1)
            add(b, t->points.xy[m->alone]);
        return true;
    }
    if (!b->any)
        b->ghost = m->hull;
    for (; steps > 0; steps--) {
        add(b, t->points.xy[dt_hull_vertex(m, b->ghost)]);
        b->ghost = dt_hull_step(m, b->ghost, false);
        if (b->ghost == m->hull)
            return true;
    }
    return false;
}

enum dt_status dt_bounds_read(const struct dt *t, const struct dt_view *v, struct dt_bounds *b,
                              size_t steps, bool *done)
{
    struct dt_row row[64];
    size_t n = 1;
    enum dt_status s = dt_view_readable_delaunay(t, v);
    if (s != DT_OK)
        return s;
    if (!b->rows && dt_view_if_changed(t, v) == NULL) {
        *done = add_hull(t, b, steps);
        return DT_OK;
    }
    b->rows = true;
    for (; steps > 0 && n > 0 && s == DT_OK; steps -= steps < n ? steps : n) {
        s = dt_view_rows(t, v, &b->from, row, sizeof row / sizeof *row, &n);
        for (size_t i = 0; s == DT_OK && i < n; i++)
            if (row[i].id == row[i].representative)
                add(b, row[i].at);
    }
    *done = n == 0;
    return s;
}

static double below(double v, double grow)
{
    double r = v - grow;
    return r < v ? r : nextafter(v, -(double)INFINITY);
}

void dt_bounds_grow(const struct dt_bounds *b, struct dt_point *lo, struct dt_point *hi)
{
    struct dt_box box = {b->lo, b->hi};
    double grow = dt_box_side(&box) / 2;
    *lo = (struct dt_point){0, 0};
    *hi = (struct dt_point){1, 1};
    if (!b->any)
        return;
    if (grow == 0)
        grow = fmax(1, fmax(fabs(b->lo.x), fabs(b->lo.y)));
    *lo = (struct dt_point){below(b->lo.x, grow), below(b->lo.y, grow)};
    *hi = (struct dt_point){0.0 - below(-b->hi.x, grow), 0.0 - below(-b->hi.y, grow)};
}

/* ---- the cursor ---- */

enum dt_status dt_cells_begin(const struct dt *t, const struct dt_view *v, struct dt_point lo,
                              struct dt_point hi, struct dt_cells *c)
{
    struct dt_summary sum;
    enum dt_status s = dt_view_readable(t, v, true);
    if (s != DT_OK)
        return s;
    if (!(lo.x < hi.x && lo.y < hi.y))
        return DT_RANGE;
    if (v != NULL)
        dt_view_summary(v, &sum);
    else
        dt_summary(t, &sum);
    *c = (struct dt_cells){.lo = {lo.x + 0.0, lo.y + 0.0}, /* no zero is negative */
                           .hi = {hi.x + 0.0, hi.y + 0.0},
                           .rows = sum.points - sum.coincident,
                           .view = v,
                           .end = v == NULL ? DT_NONE : dt_view_next_id(v)};
    return DT_OK;
}

void dt_cells_as_of(struct dt_cells *c, const struct dt_view *v)
{
    c->view = v;
    if (v != NULL && c->end == DT_NONE)
        c->end = dt_view_next_id(v);
}

bool dt_cells_cut(const struct dt *t, struct dt_cells *c, uint32_t ids, struct dt_cells *part)
{
    *part = *c;
    if (c->id >= c->end)
        return false;
    uint32_t end = dt_view_ids_after(t, c->view, c->id, ids > 0 ? ids : 1);
    part->end = c->id = end < c->end ? end : c->end;
    return true;
}

void dt_cells_only(const struct dt_cells *c, uint32_t id, struct dt_cells *one)
{
    *one = *c;
    one->id = id;
    one->end = id + 1;
}

/* ---- cells from stars ---- */

struct reading {
    const struct dt *t;
    const struct dt_view *v; /* NULL: what it reads is as it is now */
    bool line;
    struct dt_stop stop;
    struct dt_cell_work work;
    struct dt_neighbours around;
};

/* The place that a vertex, or an id, had. */
static struct dt_point place(const struct reading *r, uint32_t at, bool is_id)
{
    if (r->v == NULL && !is_id)
        return r->t->points.xy[at];
    return dt_view_place(r->t, r->v, is_id ? at : r->t->points.id[at]);
}

/* The target of cells. */
struct sink {
    struct dt_cell *cell;
    struct dt_point *corner;
    size_t room, cap, cells, corners;
    size_t need; /* corners of the next cell, at most */
};

/* False: there is no room. */
static bool take(struct sink *k, const struct dt_cell_work *w, uint32_t id)
{
    if (k->cells == k->room || w->n > k->cap - k->corners)
        return false;
    k->cell[k->cells++] = (struct dt_cell){id, w->n};
    memcpy(k->corner + k->corners, w->polygon, w->n * sizeof *k->corner);
    k->corners += w->n;
    return true;
}

/* Steps that each neighbour takes: a circumcentre in double words. */
enum { WORK = 4 };

/* Reads the star of the id, which is longer than usual, if the steps last for it and there is room for its cell. */
static enum dt_status read_long(struct reading *r, uint32_t id, struct sink *k)
{
    struct dt_star star = dt_star_of(r->t, r->v, id);
    uint32_t most = dt_work_is_limited(&r->stop) ? (uint32_t)r->stop.left / WORK + 1 : DT_NONE;
    uint32_t degree =
        star.saved != NULL ? star.saved_degree : dt_star_degree(&r->t->mesh, star.vertex, most);
    enum dt_status s = dt_work(&r->stop, WORK * (uint64_t)degree);
    if (s != DT_OK)
        return s;
    k->need = (size_t)degree + DT_CELL_MORE;
    if (k->need > k->cap - k->corners)
        return DT_TOOSMALL;
    return dt_neighbours_read(r->t, r->v, id, &r->around);
}

/* Makes the cell of star i, whose ring consists of vertices, or of ids where it was saved or is longer than usual. */
static enum dt_status make(struct reading *r, const struct dt_stars *s, uint32_t i,
                           const struct dt_box *box, struct sink *k)
{
    uint32_t degree = s->degree[i];
    const uint32_t *ring = s->ring[i];
    bool on_hull = s->on_hull[i], saved = s->vertex[i] == DT_NONE, ids = saved;
    enum dt_status st =
        degree == DT_NONE ? read_long(r, s->id[i], k) : dt_work(&r->stop, WORK * degree);
    if (st != DT_OK)
        return st;
    if (degree == DT_NONE) {
        degree = (uint32_t)r->around.ring.n;
        ring = r->around.ring.v;
        on_hull = r->around.on_hull;
        ids = true;
    }
    if (!dt_cell_reserve(&r->work, degree))
        return DT_NOMEM;
    for (uint32_t n = 0; n < degree; n++)
        r->work.ring[n] = place(r, ring[n], ids);
    dt_cell_make(&r->work, place(r, saved ? s->id[i] : s->vertex[i], saved), degree,
                 r->line   ? DT_CELL_ON_LINE
                 : on_hull ? DT_CELL_ON_HULL
                           : DT_CELL_INSIDE,
                 box);
    k->need = r->work.n;
    return dt_stop_status(&r->stop);
}

static enum dt_status read_cells(struct reading *r, struct dt_cells *c, struct sink *k)
{
    const struct dt_box box = {c->lo, c->hi};
    struct dt_stars stars;
    while (c->id < c->end && k->cells < k->room) {
        size_t left = k->room - k->cells, ahead = (k->cap - k->corners) / 8 + 1;
        left = left < ahead ? left : ahead;
        dt_stars_walk(r->t, r->v, c->id, c->end, left < DT_STARS ? (uint32_t)left : DT_STARS,
                      &stars);
        if (stars.n == 0)
            c->id = c->end;
        for (uint32_t i = 0; i < stars.n; i++) {
            enum dt_status s = make(r, &stars, i, &box, k);
            if (s != DT_OK)
                return s;
            if (!take(k, &r->work, stars.id[i]))
                return DT_TOOSMALL;
            c->id = stars.id[i] + 1;
        }
    }
    return DT_OK;
}

enum dt_status dt_cells_read(const struct dt *t, struct dt_cells *c, struct dt_cell *cell,
                             size_t room, struct dt_point *corner, size_t cap, size_t *n,
                             size_t *corners)
{
    *n = *corners = 0;
    if (c->made != NULL)
        return dt_all_cells_read(c, cell, room, corner, cap, n, corners);
    enum dt_status s = dt_view_readable(t, c->view, true);
    if (s != DT_OK)
        return s;
    struct reading r = {.t = t, .v = dt_view_if_changed(t, c->view), .stop = dt_stop_of(c->opt)};
    r.work.stop = &r.stop;
    r.line = c->view != NULL ? c->view->line : dt_mesh_is_line(&t->mesh);
    struct sink k = {.cell = cell, .corner = corner, .room = room, .cap = cap};
    s = read_cells(&r, c, &k);
    *n = k.cells;
    *corners = k.corners;
    if (s == DT_TOOSMALL && k.cells > 0)
        s = DT_OK;
    else if (s == DT_TOOSMALL)
        *corners = k.need;
    dt_cell_clear(&r.work);
    free(r.around.ring.v);
    return s;
}
