/* lookup.c - many places at once: their triangles, and their nearest points; now, or at the moment of a
 * view.
 *
 * Places are walked to side by side (prefetch.h). With a view, the answer of the present is right as long as the rows and
 * rings it follows from have no image since the view began. Otherwise the search is repeated in the rings of that moment.
 * A view keeps rows and rings by id, so the search goes from ring to ring; each step costs the reading of a
 * ring. */
#include "core/memory/sort.h"
#include "core/query/locate.h"
#include "core/query/nearest.h"
#include "core/query/prefetch.h"
#include "core/query/query.h"
#include "core/set/view_rows.h"
#include "core/set/view_stars.h"

#include <stdlib.h>
#include <string.h>

struct lookup {
    const struct dt *t;
    const struct dt_view *then; /* NULL: nothing has changed since */
    struct dt_stop work;
    uint64_t random;
    uint32_t width;              /* words of an answer */
    struct dt_ids ids;           /* owns: workspace */
    struct dt_neighbours around; /* owns: the star then that was read last */
    enum dt_status (*answer)(struct lookup *l, const struct dt_place *p, uint32_t *out);
};

/* ---- whether an answer was the same ---- */

static bool row_has_changed(const struct lookup *l, uint32_t id)
{
    return id >= l->then->next_id || dt_view_has(&l->t->views, l->then, DT_IMAGE_ROW, id);
}

/* Whether the place or the neighbours of the vertex have changed since the view began. */
static bool has_changed(const struct lookup *l, uint32_t v)
{
    uint32_t id = l->t->points.id[v];
    return row_has_changed(l, id) || dt_view_has(&l->t->views, l->then, DT_IMAGE_RING, id);
}

/* Whether the vertex was one then; *id: its id. */
static bool was_vertex(const struct lookup *l, uint32_t v, uint32_t *id)
{
    *id = v == DT_NONE ? DT_NONE : l->t->points.id[v];
    return v != DT_NONE && dt_view_representative(l->t, l->then, *id) == *id;
}

/* A vertex of that moment: v, a neighbour of it or, if none of them was one, one on the hull. */
static uint32_t vertex_then(const struct lookup *l, uint32_t v)
{
    const struct dt_mesh *m = &l->t->mesh;
    uint32_t id, h = v == DT_NONE ? DT_NONE : m->leaving[v];
    if (was_vertex(l, v, &id))
        return id;
    while (h != DT_NONE) {
        if (was_vertex(l, dt_dest(m, h), &id))
            return id;
        h = dt_turn_ccw(m, h);
        if (h == m->leaving[v])
            break;
    }
    return l->then->on_hull;
}

/* ---- triangles ---- */

/* Makes best[3] the triangle a b c (counterclockwise), from its smallest id, if that comes before best in
 * DT_TRIANGLES. DT_NONE three times comes behind all. */
static void first_triangle(uint32_t best[3], uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t row[3] = {a, b, c};
    dt_triangle_turn(row);
    if (dt_triangle_compare(row, best) < 0)
        memcpy(best, row, sizeof row);
}

static void offer(const struct lookup *l, uint32_t h, uint32_t out[3])
{
    const uint32_t *corner = l->t->mesh.half + dt_base(h), *id = l->t->points.id;
    if (!dt_is_ghost(&l->t->mesh, h))
        first_triangle(out, id[corner[0]], id[corner[1]], id[corner[2]]);
}

/* The first of the triangles round the origin of h. */
static enum dt_status offer_star(struct lookup *l, uint32_t h, uint32_t out[3])
{
    const struct dt_mesh *m = &l->t->mesh;
    uint32_t first = h, steps = 0;
    enum dt_status st = DT_OK;
    do {
        offer(l, h, out);
        h = dt_turn_ccw(m, h);
        if ((++steps & DT_WORK_MASK) == 0)
            st = dt_work(&l->work, DT_WORK_BLOCK);
    } while (st == DT_OK && h != first);
    return st;
}

/* The corners of the triangle or the ghost at h determine the answer. Whether it was the same. */
static bool triangle_was_same(const struct lookup *l, uint32_t h)
{
    const uint32_t *corner = l->t->mesh.half + dt_base(h);
    bool changed = false;
    for (unsigned k = 0; k < 3 && !changed; k++)
        changed = corner[k] != DT_NONE && has_changed(l, corner[k]);
    return !changed;
}

/* ---- triangles then ---- */

static enum dt_status read_star(struct lookup *l, uint32_t id)
{
    enum dt_status st = dt_neighbours_read(l->t, l->then, id, &l->around);
    return st == DT_OK ? dt_work(&l->work, l->around.ring.n) : st;
}

/* *c: the corner right of the edge from a to its neighbour b; DT_NONE: that is an edge of the hull. */
static enum dt_status right_of(struct lookup *l, uint32_t a, uint32_t b, uint32_t *c)
{
    enum dt_status st = read_star(l, a);
    *c = DT_NONE;
    if (st == DT_OK)
        (void)dt_neighbours_have(&l->around, b, false, c);
    return st;
}

/* The first of the triangles at the vertex id. */
static enum dt_status first_at_vertex(struct lookup *l, uint32_t id, uint32_t out[3])
{
    enum dt_status st = read_star(l, id);
    const struct dt_ids *ring = &l->around.ring;
    for (size_t i = 0; st == DT_OK && i + l->around.on_hull < ring->n; i++)
        first_triangle(out, id, ring->v[i], ring->v[(i + 1) % ring->n]);
    return st;
}

/* The same for that with these corners, in which the place is, and for those on its other side if it is on
 * an edge or a corner. */
static enum dt_status arrive_then(struct lookup *l, const uint32_t id[3], const int side[3],
                                  uint32_t out[3])
{
    enum dt_status st = DT_OK;
    first_triangle(out, id[0], id[1], id[2]);
    for (unsigned k = 0; k < 3 && st == DT_OK; k++) {
        uint32_t a = id[k], b = id[(k + 1) % 3], c;
        if (side[k] != 0)
            continue;
        if (side[(k + 2) % 3] == 0)
            return first_at_vertex(l, a, out);
        st = right_of(l, a, b, &c);
        if (c != DT_NONE)
            first_triangle(out, a, c, b);
    }
    return st;
}

/* One step of the walk from the triangle id[3]. *done: it has ended. */
static enum dt_status step_then(struct lookup *l, struct dt_point q, uint32_t id[3],
                                uint32_t out[3], bool *done)
{
    struct dt_point p[3];
    int side[3];
    for (unsigned k = 0; k < 3; k++)
        p[k] = dt_view_place(l->t, l->then, id[k]);
    for (unsigned k = 0; k < 3; k++)
        side[k] = dt_orient2d(p[k], p[(k + 1) % 3], q);
    unsigned first = l->then->constrained ? dt_random_below(&l->random, 3) : 0;
    for (unsigned i = 0; i < 3; i++) {
        unsigned k = (first + i) % 3;
        if (side[k] >= 0)
            continue;
        uint32_t a = id[k], b = id[(k + 1) % 3], c;
        enum dt_status st = right_of(l, a, b, &c);
        *done = c == DT_NONE;
        id[0] = a;
        id[1] = c;
        id[2] = b;
        return st;
    }
    *done = true;
    return arrive_then(l, id, side, out);
}

/* `from` was a vertex, best one near q; DT_NONE: there was none. The walk ends for the reason given in locate.c, which
 * holds for any Delaunay triangulation. With constraints it could return to a triangle; there it takes edges at
 * random, so that it ends with probability 1 [Devillers, Pion & Teillaud 2002]. */
static enum dt_status locate_then(struct lookup *l, struct dt_point q, uint32_t from,
                                  uint32_t out[3])
{
    if (l->then->line || from == DT_NONE)
        return DT_OK;
    enum dt_status st = read_star(l, from);
    if (st != DT_OK)
        return st;
    uint32_t id[3] = {from, l->around.ring.v[0], l->around.ring.v[1]};
    for (bool done = false; st == DT_OK && !done;)
        st = step_then(l, q, id, out, &done);
    return st;
}

static enum dt_status locate(struct lookup *l, const struct dt_place *p, uint32_t *out)
{
    const struct dt *t = l->t;
    uint32_t h;
    if (dt_mesh_is_line(&t->mesh))
        return l->then == NULL ? DT_OK : locate_then(l, p->at, l->then->on_hull, out);
    enum dt_where where = dt_find(t, p, &h);
    if (l->then != NULL && !triangle_was_same(l, h))
        return locate_then(l, p->at, vertex_then(l, t->mesh.half[dt_base(h)]), out);
    if (where == DT_ON_VERTEX)
        return offer_star(l, h, out);
    if (where != DT_OUTSIDE)
        offer(l, h, out);
    if (where == DT_ON_EDGE)
        offer(l, dt_twin(&t->mesh, h), out);
    return DT_OK;
}

/* ---- the nearest ---- */

/* Whether no neighbour of v has moved since then, and, with `alone`, v is nearer to q than all neighbours. */
static enum dt_status look_round(struct lookup *l, struct dt_point q, uint32_t v, bool alone,
                                 bool *same)
{
    const struct dt_mesh *m = &l->t->mesh;
    const struct dt_point *xy = l->t->points.xy;
    uint32_t h = m->leaving[v], steps = 0;
    while (*same && h != DT_NONE) {
        uint32_t w = dt_dest(m, h);
        if (w != DT_NONE)
            *same = !row_has_changed(l, l->t->points.id[w]) &&
                    (!alone ||
                     dt_squares_decide(dt_square_distance(xy[v], q), dt_square_distance(xy[w], q)));
        h = dt_turn_ccw(m, h);
        steps++;
        if (h == m->leaving[v])
            break;
    }
    return dt_work(&l->work, steps);
}

/* Whether the nearest points, in l->ids, were the same. The search goes by the rings of the points that it finds. Around the
 * first point, neighbours must not be as near, because ties depend on more than these rings. */
static enum dt_status nearest_were_same(struct lookup *l, struct dt_point q, bool *same)
{
    enum dt_status st = DT_OK;
    *same = l->ids.n == l->width && !l->then->constrained;
    for (size_t i = 0; *same && st == DT_OK && i < l->ids.n; i++) {
        uint32_t v = dt_points_vertex(&l->t->points, l->ids.v[i]);
        *same = !has_changed(l, v);
        st = look_round(l, q, v, i == 0, same);
    }
    return st;
}

static enum dt_status nearest(struct lookup *l, const struct dt_place *p, uint32_t *out)
{
    bool same = true;
    l->ids.n = 0;
    enum dt_status st = dt_nearest_within_work(l->t, p, l->width, &l->work, &l->ids);
    if (st == DT_OK && l->then != NULL)
        st = nearest_were_same(l, p->at, &same);
    if (st == DT_OK && !same) {
        uint32_t v = l->ids.n == 0 ? DT_NONE : dt_points_vertex(&l->t->points, l->ids.v[0]);
        l->ids.n = 0;
        st = dt_nearest_then(l->t, l->then, p->at, vertex_then(l, v), l->width, &l->work,
                             &l->around, &l->ids);
    }
    for (size_t i = 0; st == DT_OK && i < l->ids.n; i++)
        out[i] = l->ids.v[i];
    return st;
}

/* ---- many ---- */

static enum dt_status answer_all(struct lookup *l, const struct dt_point *p, size_t n,
                                 uint32_t *out, size_t *done)
{
    struct dt_place place[DT_AHEAD];
    enum dt_status st = DT_OK;
    while (st == DT_OK && *done < n) {
        size_t many = n - *done < DT_AHEAD ? n - *done : DT_AHEAD;
        for (size_t i = 0; i < many; i++)
            place[i].at = p[*done + i];
        dt_walk_to_places(l->t, place, many, DT_PLACE_READ);
        for (size_t i = 0; i < many; i++) {
            uint32_t *row = out + *done * l->width;
            for (uint32_t k = 0; k < l->width; k++)
                row[k] = DT_NONE;
            st = dt_work(&l->work, 1);
            if (st == DT_OK)
                st = l->answer(l, &place[i], row);
            if (st != DT_OK)
                break;
            ++*done;
        }
    }
    free(l->ids.v);
    free(l->around.ring.v);
    return st;
}

static enum dt_status look_up(struct lookup *l, const struct dt_view *v, const struct dt_point *p,
                              size_t n, uint32_t *out, size_t *done)
{
    *done = 0;
    enum dt_status st = dt_view_readable(l->t, v, true);
    if (st != DT_OK)
        return st;
    /* Points that come to an empty set change nothing that it had. */
    bool was_empty = v != NULL && v->on_hull == DT_NONE;
    l->then = was_empty ? v : dt_view_if_changed(l->t, v);
    return answer_all(l, p, n, out, done);
}

enum dt_status dt_locate_many(const struct dt *t, const struct dt_view *v, const struct dt_point *p,
                              size_t n, const struct dt_options *opt, uint32_t *out, size_t *done)
{
    struct lookup l = {.t = t, .work = dt_stop_of(opt), .width = 3, .answer = locate};
    return look_up(&l, v, p, n, out, done);
}

enum dt_status dt_nearest_many(const struct dt *t, const struct dt_view *v,
                               const struct dt_point *p, size_t n, uint32_t k,
                               const struct dt_options *opt, uint32_t *out, size_t *done)
{
    struct lookup l = {.t = t, .work = dt_stop_of(opt), .width = k, .answer = nearest};
    return look_up(&l, v, p, n, out, done);
}
