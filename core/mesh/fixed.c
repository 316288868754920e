/* fixed.c - see fixed.h. */
#include "core/mesh/fixed.h"

#include <stdlib.h>

enum { LEAST = 16 };

enum dt_status dt_fixed_begin(struct dt_mesh *m)
{
    if (m->fixed != NULL)
        return DT_OK;
    m->fixed = calloc(1, sizeof *m->fixed);
    if (m->fixed == NULL)
        return DT_NOMEM;
    for (size_t t = 0; t < m->tri_end; t++)
        m->half[8 * t + 3] = 0;
    return DT_OK;
}

/* ---- the table ---- */

static uint32_t home(const struct dt_fixed *f, uint32_t a, uint32_t b)
{
    uint64_t key = ((uint64_t)a << 32 | b) * 0x9e3779b97f4a7c15u;
    return (uint32_t)(key >> 32) & (f->cap - 1);
}

/* The place of the edge, or the place at which it could be entered; the table has a free place. */
static struct dt_more *find(const struct dt_fixed *f, uint32_t a, uint32_t b)
{
    uint32_t i = home(f, a, b);
    while (f->more[i].a != DT_NONE && (f->more[i].a != a || f->more[i].b != b))
        i = (i + 1) & (f->cap - 1);
    return &f->more[i];
}

/* Frees the place, and moves those after it that would no longer be found [Knuth, TAOCP 3, sec. 6.4, algorithm R]. */
static void leave(struct dt_fixed *f, struct dt_more *at)
{
    uint32_t mask = f->cap - 1, hole = (uint32_t)(at - f->more), i = hole;
    f->n--;
    for (;;) {
        f->more[hole].a = DT_NONE;
        do {
            i = (i + 1) & mask;
            if (f->more[i].a == DT_NONE)
                return;
        } while (((i - home(f, f->more[i].a, f->more[i].b)) & mask) < ((i - hole) & mask));
        f->more[hole] = f->more[i];
        hole = i;
    }
}

enum dt_status dt_fixed_reserve(struct dt_mesh *m, size_t n)
{
    struct dt_fixed *f = m->fixed;
    size_t cap = f->cap < LEAST ? LEAST : f->cap;
    while ((f->n + n) * 4 > cap * 3)
        cap *= 2;
    if (cap == f->cap)
        return DT_OK;
    struct dt_fixed larger = {.more = dt_array_new(cap, sizeof *larger.more), .n = f->n};
    if (larger.more == NULL || cap > UINT32_MAX / 2) {
        dt_array_free(larger.more);
        return DT_NOMEM;
    }
    larger.cap = (uint32_t)cap;
    for (size_t i = 0; i < cap; i++)
        larger.more[i].a = DT_NONE;
    for (uint32_t i = 0; i < f->cap; i++)
        if (f->more[i].a != DT_NONE)
            *find(&larger, f->more[i].a, f->more[i].b) = f->more[i];
    dt_array_free(f->more);
    *f = larger;
    return DT_OK;
}

/* The entry of the edge of h. NULL: the table has no places. */
static struct dt_more *entry(const struct dt_mesh *m, uint32_t h, uint32_t end[2])
{
    uint32_t a = dt_origin(m, h), b = dt_dest(m, h);
    end[0] = a < b ? a : b;
    end[1] = a < b ? b : a;
    return m->fixed->cap == 0 ? NULL : find(m->fixed, end[0], end[1]);
}

uint32_t dt_fixed_count(const struct dt_mesh *m, uint32_t h)
{
    uint32_t end[2];
    if (!dt_is_fixed(m, h))
        return 0;
    const struct dt_more *e = m->fixed->n == 0 ? NULL : entry(m, h, end);
    return e == NULL || e->a == DT_NONE ? 1 : 1 + e->more;
}

static void mark_both(struct dt_mesh *m, uint32_t h, bool fixed)
{
    dt_fixed_mark(m, h, fixed);
    dt_fixed_mark(m, dt_twin(m, h), fixed);
}

void dt_fix(struct dt_mesh *m, uint32_t h, uint32_t n)
{
    uint32_t end[2], more = dt_is_fixed(m, h) ? n : n - 1;
    mark_both(m, h, true);
    if (more == 0)
        return;
    struct dt_more *e = entry(m, h, end);
    m->fixed->n += e->a == DT_NONE;
    e->more = e->a == DT_NONE ? more : e->more + more;
    e->a = end[0];
    e->b = end[1];
}

void dt_unfix(struct dt_mesh *m, uint32_t h, uint32_t n)
{
    uint32_t end[2], left = dt_fixed_count(m, h) - n;
    struct dt_more *e = m->fixed->n == 0 ? NULL : entry(m, h, end);
    if (e != NULL && e->a != DT_NONE) {
        if (left > 1)
            e->more = left - 1;
        else
            leave(m->fixed, e);
    }
    if (left == 0)
        mark_both(m, h, false);
}
