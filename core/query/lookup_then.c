/* lookup_then.c - see lookup_then.h. The walk ends for the reason given in locate.c, which holds for any
 * Delaunay triangulation. */
#include "core/query/lookup_then.h"

#include "core/exact/predicates.h"
#include "core/set/set.h"

#include <stdlib.h>

/* ---- rings and places ---- */

struct dt_then dt_then_of(const struct dt *t, const struct dt_view *v, struct dt_stop *work)
{
    return (struct dt_then){.t = t, .v = v, .work = work, .id = DT_NONE};
}

void dt_then_clear(struct dt_then *r)
{
    free(r->around.ring.v);
    r->around.ring.v = NULL;
}

enum dt_status dt_then_read(struct dt_then *r, uint32_t id)
{
    if (r->id == id)
        return DT_OK;
    enum dt_status st = dt_neighbours_read(r->t, r->v, id, &r->around);
    r->id = st == DT_OK ? id : DT_NONE;
    return st == DT_OK ? dt_work(r->work, r->around.ring.n) : st;
}

/* ---- the triangle ---- */

/* The corner right of the edge from the vertex that was read to its neighbour b; DT_NONE: that is an edge
 * of the hull. */
static uint32_t right_of(const struct dt_then *r, uint32_t b)
{
    uint32_t c;
    (void)dt_neighbours_have(&r->around, b, false, &c);
    return c;
}

/* Of the triangles at the vertex id, the first one. */
static enum dt_status first_at_vertex(struct dt_then *r, uint32_t id, uint32_t out[3])
{
    enum dt_status st = dt_then_read(r, id);
    const struct dt_ids *ring = &r->around.ring;
    for (size_t i = 0; st == DT_OK && i < ring->n; i++)
        if (i + 1 < ring->n || !r->around.on_hull)
            dt_first_triangle(out, id, ring->v[i], ring->v[(i + 1) % ring->n]);
    return st;
}

/* The same for that with these corners, in which the place is, and for those on its other side if it is on
 * an edge or a corner. */
static enum dt_status arrive(struct dt_then *r, const uint32_t id[3], const int side[3],
                             uint32_t out[3])
{
    enum dt_status st = DT_OK;
    dt_first_triangle(out, id[0], id[1], id[2]);
    for (unsigned k = 0; k < 3 && st == DT_OK; k++) {
        uint32_t a = id[k], b = id[(k + 1) % 3];
        if (side[k] != 0)
            continue;
        if (side[(k + 2) % 3] == 0)
            return first_at_vertex(r, a, out);
        st = dt_then_read(r, a);
        uint32_t c = st == DT_OK ? right_of(r, b) : DT_NONE;
        if (c != DT_NONE)
            dt_first_triangle(out, a, c, b);
    }
    return st;
}

/* One step of the walk from the triangle id[3]. *done: it has ended. */
static enum dt_status step(struct dt_then *r, struct dt_point q, uint32_t id[3], uint32_t out[3],
                           bool *done)
{
    struct dt_point p[3] = {dt_then_place(r, id[0]), dt_then_place(r, id[1]),
                            dt_then_place(r, id[2])};
    int side[3];
    for (unsigned k = 0; k < 3; k++) {
        side[k] = dt_orient2d(p[k], p[(k + 1) % 3], q);
        if (side[k] >= 0)
            continue;
        uint32_t a = id[k], b = id[(k + 1) % 3];
        enum dt_status st = dt_then_read(r, a);
        uint32_t c = st == DT_OK ? right_of(r, b) : DT_NONE;
        *done = c == DT_NONE;
        id[0] = a;
        id[1] = c;
        id[2] = b;
        return st;
    }
    *done = true;
    return arrive(r, id, side, out);
}

enum dt_status dt_locate_then(const struct dt *t, const struct dt_view *v, struct dt_point q,
                              uint32_t from, struct dt_stop *work, uint32_t out[3])
{
    if (v->line || from == DT_NONE)
        return DT_OK;
    struct dt_then r = dt_then_of(t, v, work);
    enum dt_status st = dt_then_read(&r, from);
    bool done = false;
    if (st == DT_OK) {
        uint32_t id[3] = {from, r.around.ring.v[0], r.around.ring.v[1]};
        while (st == DT_OK && !done)
            st = step(&r, q, id, out, &done);
    }
    dt_then_clear(&r);
    return st;
}
