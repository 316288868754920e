/* follow.c - what edits have touched, for those who follow a set; see delaunay.h and touched.h. */
#include <stdlib.h>

#include "core/delaunay.h"
#include "core/delaunay_fields.h"
#include "core/set/set.h"

void dt_touched_begin(struct dt *t, bool values)
{
    if (!t->touched.on)
        dt_touched_clear(&t->touched);
    t->touched.on = true;
    t->touched.with_values = values;
}

void dt_touched_end(struct dt *t)
{
    dt_touched_clear(&t->touched);
}

size_t dt_touched_count(const struct dt *t)
{
    return t->touched.rows.n + t->touched.values.n;
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
    /* The order of a ring on a line depends on where the line begins. */
    if (w->rows.n > 0 && dt_is_live(t) && dt_mesh_is_line(&t->mesh))
        w->rows.all = true;
    return take(&w->rows, w->on, keys, n);
}

bool dt_touched_take_values(struct dt *t, const uint64_t **keys, size_t *n)
{
    return take(&t->touched.values, t->touched.with_values, keys, n);
}
