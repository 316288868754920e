/* touched.c - the keys that edits have touched, for readers that follow a set; see delaunay.h and set.h. */
#include "core/set/set.h"

#include <stdlib.h>

#include "core/memory/memory.h"
#include "core/mesh/hull.h"

enum { MOST = 16384, MOST_CONSTRAINTS = 8192 };

void dt_touched_clear(struct dt_touched *w)
{
    free(w->rows.key);
    free(w->values.key);
    free(w->constraints.row);
    *w = (struct dt_touched){.on = false};
}

void dt_touched_note(struct dt_touched_list *w, uint64_t key)
{
    if (w->all)
        return;
    w->all = w->n == MOST || dt_items_append(&w->key, &w->n, &w->cap, &key, sizeof key) != DT_OK;
}

void dt_touched_note_constraint(struct dt *t, const struct dt_constraint *c, bool moved)
{
    struct dt_touched_constraints *w = &t->touched.constraints;
    const struct dt_touched_constraint row = {
        *c, {dt_points_xy(&t->points, c->a), dt_points_xy(&t->points, c->b)}, moved};
    w->all = w->all || w->n == MOST_CONSTRAINTS ||
             dt_items_append(&w->row, &w->n, &w->cap, &row, sizeof row) != DT_OK;
}

void dt_touched_note_end(struct dt *t, uint32_t id)
{
    const struct dt_declared *d = &t->constraints->declared;
    for (uint32_t row = dt_declared_first(d, id); row != DT_NONE && !t->touched.constraints.all;
         row = dt_declared_next(d, row, id)) {
        struct dt_constraint c = dt_declared_get(d, row);
        dt_touched_note_constraint(t, &c, true);
    }
}

/* Cost: O(1), but on a line O(points). */
static enum dt_touched_line line_of(const struct dt *t)
{
    const struct dt_mesh *m = &t->mesh;
    if (!dt_is_live(t) || !dt_mesh_is_line(m))
        return DT_NOT_ON_LINE;
    if (m->vertices < 2)
        return DT_LINE_UP;
    struct dt_point end[2];
    for (int k = 0; k < 2; k++)
        end[k] = t->points.xy[dt_hull_vertex(m, dt_hull_first(m, t->points.id, k == 1))];
    bool up = end[0].x < end[1].x || (end[0].x == end[1].x && end[0].y < end[1].y);
    return up ? DT_LINE_UP : DT_LINE_DOWN;
}

void dt_touched_begin(struct dt *t, bool values)
{
    if (!t->touched.on) {
        dt_touched_clear(&t->touched);
        t->touched.line = line_of(t);
    }
    t->touched.on = true;
    t->touched.with_values = values;
}

void dt_touched_end(struct dt *t)
{
    dt_touched_clear(&t->touched);
}

size_t dt_touched_count(const struct dt *t)
{
    return t->touched.rows.n + t->touched.values.n + t->touched.constraints.n;
}

static bool take(struct dt_touched_list *w, bool on, const uint64_t **keys, size_t *n)
{
    bool all = w->all || !on;
    *keys = w->key;
    *n = all ? 0 : w->n;
    w->n = 0;
    w->all = false;
    return !all;
}

bool dt_touched_take(struct dt *t, const uint64_t **keys, size_t *n)
{
    struct dt_touched *w = &t->touched;
    if (w->rows.n > 0 || w->rows.all) {
        enum dt_touched_line line = line_of(t);
        w->rows.all = w->rows.all || line != w->line;
        w->line = line;
    }
    return take(&w->rows, w->on, keys, n);
}

bool dt_touched_take_values(struct dt *t, const uint64_t **keys, size_t *n)
{
    return take(&t->touched.values, t->touched.with_values, keys, n);
}

bool dt_touched_take_constraints(struct dt *t, const struct dt_touched_constraint **rows, size_t *n)
{
    struct dt_touched_constraints *w = &t->touched.constraints;
    bool all = w->all || !t->touched.on;
    *rows = w->row;
    *n = all ? 0 : w->n;
    w->n = 0;
    w->all = false;
    return !all;
}
