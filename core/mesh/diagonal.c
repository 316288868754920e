/* diagonal.c - see diagonal.h. */
#include "core/mesh/diagonal.h"

#include "core/mesh/fixed.h"

static void leave_by(struct dt_mesh *m, uint32_t v, uint32_t old, uint32_t h)
{
    if (m->leaving[v] == old)
        m->leaving[v] = h;
}

/* Moves the mark of half edge `from` to `to`, which is a side of the diagonal and takes over the edge of `from`. */
static void carry_fixed(struct dt_mesh *m, uint32_t from, uint32_t to)
{
    if (m->fixed == NULL)
        return;
    dt_fixed_mark(m, to, dt_is_fixed(m, from));
    dt_fixed_mark(m, from, false);
}

void dt_flip(struct dt_mesh *m, uint32_t h)
{
    uint32_t g = dt_twin(m, h), a = dt_origin(m, h), b = dt_origin(m, g);
    uint32_t db = dt_twin(m, dt_prev(g)), ca = dt_twin(m, dt_prev(h)); /* seen from outside */
    carry_fixed(m, dt_prev(g), h);
    carry_fixed(m, dt_prev(h), g);
    m->half[h] = dt_apex_of(m, g);
    m->half[g] = dt_apex_of(m, h);
    dt_link(m, h, db);
    dt_link(m, g, ca);
    dt_link(m, dt_prev(h), dt_prev(g));
    leave_by(m, a, h, dt_next(g));
    leave_by(m, b, g, dt_next(h));
}

void dt_flip_back(struct dt_mesh *m, uint32_t h)
{
    uint32_t g = dt_next(dt_twin(m, dt_prev(h))), d = dt_origin(m, h), c = dt_origin(m, g);
    uint32_t db = dt_twin(m, h), ca = dt_twin(m, g);
    carry_fixed(m, h, dt_prev(g));
    carry_fixed(m, g, dt_prev(h));
    m->half[h] = dt_dest(m, g);
    m->half[g] = dt_dest(m, h);
    dt_link(m, dt_prev(g), db);
    dt_link(m, dt_prev(h), ca);
    dt_link(m, h, g);
    leave_by(m, d, h, dt_prev(g));
    leave_by(m, c, g, dt_prev(h));
}
