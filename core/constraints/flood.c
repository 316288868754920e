/* flood.c - see flood.h. */
#include "core/constraints/flood.h"

#include <stdlib.h>

#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"

struct flood {
    struct dt_mesh *m;
    const struct dt_point *xy;
    const struct dt_segment *loose;
    size_t n_loose;
    struct dt_sum *area;
    struct dt_ids stack; /* owns: triangles */
};

static bool is_known(const struct dt_mesh *m, uint32_t h)
{
    return (dt_face(m, h) & DT_FLOOD_UNKNOWN) == 0;
}

/* inside: 0 or 1. */
static enum dt_status reach(struct flood *f, uint32_t h, uint32_t inside)
{
    dt_face_set(f->m, h, (dt_face(f->m, h) & DT_FLOOD_NEAR) | inside);
    return dt_ids_append(&f->stack, dt_base(h));
}

/* ---- loose sides ---- */

/* Each segment contains its lower end and not its upper one, so that a way through a corner of the polygon meets one side or both. */
static bool meets(const struct dt_segment *s, struct dt_point a, struct dt_point b)
{
    if (dt_greater(s->p.x, s->q.x) < dt_lesser(a.x, b.x) ||
        dt_lesser(s->p.x, s->q.x) > dt_greater(a.x, b.x) ||
        dt_greater(s->p.y, s->q.y) < dt_lesser(a.y, b.y) ||
        dt_lesser(s->p.y, s->q.y) > dt_greater(a.y, b.y))
        return false;
    return (dt_orient2d(a, b, s->p) > 0) != (dt_orient2d(a, b, s->q) > 0) &&
           (dt_orient2d(s->p, s->q, a) > 0) != (dt_orient2d(s->p, s->q, b) > 0);
}

static struct dt_point centroid(const struct flood *f, uint32_t h)
{
    const struct dt_point *xy = f->xy;
    const uint32_t *v = &f->m->half[dt_base(h)];
    return (struct dt_point){xy[v[0]].x / 3 + xy[v[1]].x / 3 + xy[v[2]].x / 3,
                             xy[v[0]].y / 3 + xy[v[1]].y / 3 + xy[v[2]].y / 3};
}

/* Counts how often loose sides cross the way from the centroid of h's triangle to the middle of h. */
static uint32_t count_to_edge(const struct flood *f, uint32_t h)
{
    if ((dt_face(f->m, h) & DT_FLOOD_NEAR) == 0 || dt_is_ghost(f->m, h))
        return 0;
    struct dt_point a = f->xy[dt_origin(f->m, h)], b = f->xy[dt_dest(f->m, h)];
    struct dt_point from = centroid(f, h), to = {a.x / 2 + b.x / 2, a.y / 2 + b.y / 2};
    uint32_t n = 0;
    for (size_t i = 0; i < f->n_loose; i++)
        n += meets(&f->loose[i], from, to);
    return n;
}

/* ---- all ---- */

/* Visits what is beyond h, whose triangle is inside or not. A side that is met from the inside is counted. */
static enum dt_status look_beyond(struct flood *f, uint32_t h, uint32_t inside)
{
    uint32_t g = dt_twin(f->m, h);
    bool known = is_known(f->m, g);
    if (known && f->area == NULL)
        return DT_OK;
    uint32_t sides = dt_fixed_count(f->m, h);
    if (f->n_loose > 0)
        sides += count_to_edge(f, h) + count_to_edge(f, g);
    if (f->area != NULL && inside == 1 && sides % 2 == 1)
        dt_sum_cross(f->area, f->xy[dt_origin(f->m, h)], f->xy[dt_dest(f->m, h)]);
    return known ? DT_OK : reach(f, g, (inside + sides) % 2);
}

static enum dt_status flood(struct flood *f, struct dt_stop *work)
{
    enum dt_status status = reach(f, f->m->hull, 0);
    while (status == DT_OK && f->stack.n > 0) {
        uint32_t t = f->stack.v[--f->stack.n], inside = dt_face(f->m, t) & DT_FLOOD_INSIDE;
        status = dt_work(work, 1);
        for (uint32_t k = 0; k < 3 && status == DT_OK; k++)
            status = look_beyond(f, t + k, inside);
    }
    return status;
}

void dt_flood_begin(struct dt_mesh *m)
{
    for (uint32_t t = 0; t < m->tri_end; t++)
        dt_face_set(m, 8 * t, DT_FLOOD_UNKNOWN);
}

enum dt_status dt_flood(struct dt_mesh *m, const struct dt_point *xy,
                        const struct dt_segment *loose, size_t n, struct dt_stop *work,
                        struct dt_sum *area)
{
    struct flood f = {.m = m, .xy = xy, .loose = loose, .n_loose = n, .area = area};
    enum dt_status status = m->vertices < 2 ? DT_OK : flood(&f, work);
    free(f.stack.v);
    return status;
}
