/* follow.c - what edits have touched, for those who follow a set; see delaunay.h and touched.h. */
#include <stdlib.h>

#include "core/delaunay.h"
#include "core/set/set.h"

void dt_touched_begin(struct dt *t)
{
    if (!t->touched.on)
        dt_touched_clear(&t->touched);
    t->touched.on = true;
}

void dt_touched_end(struct dt *t)
{
    dt_touched_clear(&t->touched);
}

static int by_key(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

bool dt_touched_take(struct dt *t, const uint64_t **keys, size_t *n)
{
    struct dt_touched *w = &t->touched;
    /* The order of a ring on a line depends on where the line begins. */
    bool all = w->all || (w->n > 0 && dt_is_live(t) && dt_mesh_is_line(&t->mesh));
    size_t kept = 0;
    if (w->n > 0)
        qsort(w->key, w->n, sizeof *w->key, by_key);
    for (size_t i = 0; i < w->n; i++)
        if (kept == 0 || w->key[kept - 1] >> 1 != w->key[i] >> 1)
            w->key[kept++] = w->key[i];
    *keys = w->key;
    *n = all ? 0 : kept;
    w->n = 0;
    w->all = false;
    return !all;
}
