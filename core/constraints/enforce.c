/* enforce.c - see enforce.h.
 *
 * The way is a list of steps: an edge along which it runs, marked by ALONG, or one that it crosses, seen from the triangle
 * before it. A part without a vertex on it is a run of edges crossed, each in the triangle behind the one before:
 *
 *           w --- x             e: u->w, its twin g: w->u. If x is to the left of the way, the next edge is u->x,
 *         / |   /               and x->w is a side of the polygon on the left.
 *        s -e- g --->
 *         \ | /
 *           u                                                                                                    */
#include "core/constraints/enforce.h"

#include <stdlib.h>

#include "core/constraints/march.h"
#include "core/memory/memory.h"
#include "core/mesh/diagonal.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"
#include "core/mesh/star.h"

#define ALONG 4u /* a bit that no half edge has */

void dt_enforcer_clear(struct dt_enforcer *e)
{
    free(e->step.v);
    free(e->crossed.v);
    free(e->spare.v);
    dt_pocket_clear(&e->pocket);
    dt_suspects_clear(&e->suspects);
    *e = (struct dt_enforcer){0};
}

size_t dt_enforcer_memory(const struct dt_enforcer *e)
{
    return (e->step.cap + e->crossed.cap + e->spare.cap + e->suspects.half.cap) * sizeof(uint32_t) +
           e->pocket.cap * sizeof *e->pocket.side;
}

enum dt_status dt_enforce_edge(struct dt_enforcer *e, uint32_t a, uint32_t b, struct dt_stop *work,
                               bool *done)
{
    uint32_t half = dt_edge_between(e->mesh, a, b);
    *done = false;
    if (half == DT_NONE)
        return DT_OK;
    enum dt_status status = dt_work(work, 1);
    if (status == DT_OK)
        status = dt_fixed_reserve(e->mesh, 1);
    *done = status == DT_OK;
    if (*done)
        dt_fix(e->mesh, half, 1);
    return status;
}

/* ---- the way ---- */

/* Notes the edges that the way from p crosses, from e on, until it comes to a vertex: *at leaves that. */
static enum dt_status cross_part(struct dt_enforcer *e, struct dt_point p, struct dt_point q,
                                 uint32_t edge, struct dt_stop *work, uint32_t *at)
{
    const struct dt_mesh *m = e->mesh;
    for (;;) {
        enum dt_status status = dt_work(work, 1);
        if (status == DT_OK)
            status = dt_ids_append(&e->step, edge);
        if (status == DT_OK && dt_is_fixed(m, edge))
            status = dt_ids_append(&e->crossed, edge);
        if (status != DT_OK)
            return status;
        uint32_t g = dt_twin(m, edge);
        int side = dt_orient2d(p, q, e->xy[dt_apex_of(m, g)]);
        if (side == 0) {
            *at = dt_prev(g);
            return DT_OK;
        }
        edge = dt_march_next(m, edge, side);
    }
}

enum dt_status dt_enforce_look(struct dt_enforcer *e, uint32_t a, uint32_t b, struct dt_stop *work)
{
    const struct dt_mesh *m = e->mesh;
    enum dt_status status = DT_OK;
    bool swapped;
    uint32_t half, at = DT_NONE;
    e->step.n = e->crossed.n = 0;
    enum dt_march_step step = dt_march_between(m, e->xy, a, b, &half, &swapped);
    uint32_t from = swapped ? b : a, to = swapped ? a : b;
    for (;;) {
        if (step == DT_MARCH_ALONG) {
            status = dt_ids_append(&e->step, half | ALONG);
            at = dt_twin(m, half);
        } else {
            status = cross_part(e, e->xy[from], e->xy[to], half, work, &at);
        }
        if (status != DT_OK || dt_origin(m, at) == to)
            return status == DT_OK ? dt_work(work, 1) : status;
        step = dt_march_begin(m, e->xy, at, e->xy[to], &half);
    }
}

/* ---- one part ---- */

/* Returns how many steps from i on belong to one part. */
static size_t part_length(const struct dt_enforcer *e, size_t i)
{
    size_t n = 1;
    while (i + n < e->step.n && (e->step.v[i + n] & ALONG) == 0 &&
           dt_base(e->step.v[i + n]) == dt_base(dt_twin(e->mesh, e->step.v[i + n - 1])))
        n++;
    return n;
}

/* Notes a side of the polygon, by its half edge on the inside. */
static void add_side(struct dt_enforcer *e, uint32_t inner)
{
    dt_pocket_add(&e->pocket, dt_origin(e->mesh, inner), inner | DT_SIDE_INNER);
}

/* The polygon on the right of the part edge[n]: from its first vertex to its last. */
static void collect_right(struct dt_enforcer *e, const uint32_t *edge, size_t n)
{
    const struct dt_mesh *m = e->mesh;
    e->pocket.n = 0;
    add_side(e, dt_prev(edge[0]));
    for (size_t i = 0; i < n; i++) {
        uint32_t g = dt_twin(m, edge[i]);
        if (i + 1 == n || edge[i + 1] == dt_prev(g))
            add_side(e, dt_next(g));
    }
    uint32_t end = dt_apex_of(m, dt_twin(m, edge[n - 1]));
    dt_pocket_add(&e->pocket, end, DT_NONE);
}

/* That on the left: from its last vertex to its first. */
static void collect_left(struct dt_enforcer *e, const uint32_t *edge, size_t n)
{
    const struct dt_mesh *m = e->mesh;
    e->pocket.n = 0;
    for (size_t i = n; i-- > 0;) {
        uint32_t g = dt_twin(m, edge[i]);
        if (i + 1 == n || edge[i + 1] == dt_next(g))
            add_side(e, dt_prev(g));
    }
    add_side(e, dt_next(edge[0]));
    dt_pocket_add(&e->pocket, dt_apex_of(m, edge[0]), DT_NONE);
}

static void report_stars(const struct dt_enforcer *e, const uint32_t *edge, size_t n)
{
    const struct dt_mesh *m = e->mesh;
    dt_changes_star(e->changes, dt_apex_of(m, edge[0]));
    for (size_t i = 0; i < n; i++) {
        dt_changes_star(e->changes, dt_origin(m, edge[i]));
        dt_changes_star(e->changes, dt_dest(m, edge[i]));
    }
    dt_changes_star(e->changes, dt_apex_of(m, dt_twin(m, edge[n - 1])));
}

/* Replaces the triangles that the part crosses; there is room. Returns a half edge of the new edge. */
static uint32_t fill_part(struct dt_enforcer *e, const uint32_t *edge, size_t n)
{
    struct dt_mesh *m = e->mesh;
    uint32_t spares = 0, first = dt_base(edge[0]);
    e->pocket.face = dt_face(m, first);
    if (e->changes != NULL)
        report_stars(e, edge, n);
    for (size_t i = 0; i <= n; i++)
        e->spare.v[spares++] = dt_mesh_take(m);
    collect_right(e, edge, n);
    uint32_t right = dt_pocket_fill(&e->pocket, m, e->xy, e->spare.v, &spares, &e->suspects);
    collect_left(e, edge, n);
    uint32_t left = dt_pocket_fill(&e->pocket, m, e->xy, e->spare.v, &spares, &e->suspects);
    dt_link(m, left, right);
    for (size_t i = 0; i < n; i++) {
        uint32_t behind = dt_base(dt_twin(m, edge[i]));
        dt_mesh_drop(m, i == 0 ? first : dt_base(edge[i]));
        if (i + 1 == n)
            dt_mesh_drop(m, behind);
    }
    m->recycled = true;
    return left;
}

/* The same where the part crosses one edge: it becomes the other diagonal of its two triangles. */
static uint32_t flip_part(struct dt_enforcer *e, uint32_t edge)
{
    if (e->changes != NULL)
        report_stars(e, &edge, 1);
    dt_flip(e->mesh, edge);
    e->mesh->recycled = true;
    return dt_prev(edge);
}

/* Makes the part of `length` steps an edge; there is room. Returns a half edge of that edge. */
static uint32_t make_edge(struct dt_enforcer *e, const uint32_t *step, size_t length)
{
    if ((*step & ALONG) != 0)
        return *step & ~ALONG;
    return length == 1 ? flip_part(e, *step) : fill_part(e, step, length);
}

enum dt_status dt_enforce(struct dt_enforcer *e)
{
    struct dt_mesh *m = e->mesh;
    size_t n = e->step.n;
    enum dt_status status = dt_mesh_make_room(m, 0, (uint32_t)(2 * n));
    if (status == DT_OK)
        status = dt_fixed_reserve(m, n);
    if (status == DT_OK)
        status = dt_ids_reserve(&e->spare, 2 * n); /* which has none */
    if (status == DT_OK)
        status = dt_pocket_reserve(&e->pocket, n + 3);
    for (size_t i = 0; i < n && status == DT_OK;) {
        size_t length = (e->step.v[i] & ALONG) != 0 ? 1 : part_length(e, i);
        dt_fix(m, make_edge(e, &e->step.v[i], length), 1);
        i += length;
    }
    return status;
}

/* ---- the chain ---- */

uint32_t dt_chain_next(const struct dt_mesh *m, const struct dt_point *xy, uint32_t near,
                       struct dt_point q)
{
    struct dt_point p = xy[dt_origin(m, near)];
    uint32_t h = near;
    do {
        if (dt_is_fixed(m, h)) {
            struct dt_point u = xy[dt_dest(m, h)];
            if (dt_compare_xy(p, u) == dt_compare_xy(p, q) && dt_orient2d(p, u, q) == 0)
                return h;
        }
        h = dt_turn_ccw(m, h);
    } while (h != near);
    return DT_NONE;
}

void dt_enforce_release(struct dt_enforcer *e, uint32_t a, uint32_t b)
{
    struct dt_mesh *m = e->mesh;
    uint32_t near = m->leaving[a];
    do {
        uint32_t h = dt_chain_next(m, e->xy, near, e->xy[b]);
        dt_unfix(m, h, 1);
        if (!dt_is_fixed(m, h))
            dt_suspect(&e->suspects, h);
        near = dt_twin(m, h);
    } while (dt_origin(m, near) != b);
}

void dt_enforce_mend(struct dt_enforcer *e)
{
    dt_mend(e->mesh, e->xy, &e->suspects, e->changes);
}

enum dt_status dt_enforce_segment(struct dt_enforcer *e, uint32_t a, uint32_t b,
                                  struct dt_stop *work)
{
    bool done;
    if (a == b)
        return dt_work(work, 1);
    enum dt_status status = dt_enforce_edge(e, a, b, work, &done);
    if (status != DT_OK || done)
        return status;
    status = dt_enforce_look(e, a, b, work);
    if (status == DT_OK && e->crossed.n > 0)
        status = DT_CROSSES;
    if (status == DT_OK)
        status = dt_enforce(e);
    if (status == DT_OK)
        dt_enforce_mend(e);
    return status;
}

void dt_enforce_flag(struct dt_enforcer *e, uint32_t flag)
{
    for (size_t i = 0; i < e->step.n; i++) {
        uint32_t h = e->step.v[i] & ~ALONG, g = dt_twin(e->mesh, h);
        dt_face_set(e->mesh, h, dt_face(e->mesh, h) | flag);
        dt_face_set(e->mesh, g, dt_face(e->mesh, g) | flag);
    }
}
