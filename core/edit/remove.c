/* remove.c - deletion: the star of the vertex becomes a hole, and the hole is retriangulated
 * [Devillers 1999; Devillers & Teillaud 2003 for ties].
 *
 *         P3-----P2               P3-----P2
 *        / \    / \              / \ '.   \
 *       /   \  /   \            /   \  '.  \
 *     P4-----v-----P1    ->   P4     \   '. P1
 *       \   /  \   /            \     \   ./
 *        \ /    \ /              \     \ ./
 *         P5-----P0               P5-----P0
 *
 * The edge P[hi]->P[lo] has a triangle with the apex P[m] on its left, lo < m < hi. Its circle holds no other vertex of the
 * hole: this is the apex rule of the paper, among a handful of points. Two smaller holes are left.
 *
 * The hole of a hull vertex is open to infinity. Its new hull edges come first: the chain P0 ... Pk
 * without the vertices that lie in a bay. Each new hull edge gets a ghost, and closes a pocket of
 * the kind above. */
#include "core/edit/remove.h"

#include <math.h>

#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

enum { MET = 4 }; /* triangles each way, after which most stars have been seen */

/* A hole that is being filled. */
struct hole {
    struct dt_mesh *m;
    const struct dt_rim *rim; /* P[i] = rim[i].origin, all finite in a pocket */
    const struct dt_point *p; /* the place of P[i] */
    const uint32_t *spare;    /* records to be used, from the end */
    uint32_t spares;
    uint32_t face;               /* of the triangles that fill it */
    struct dt_wide_bounds bound; /* below these, signs are uncertain */
};

/* Collects the star of v counterclockwise; a hull vertex's from infinity on. The way round is a
 * chain of cache misses; a second one, clockwise, meets it half way. */
static enum dt_status collect_star(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                   struct dt_cavity *c)
{
    enum dt_status status = DT_OK;
    uint32_t first = m->leaving[v], h = first, other = first, n = 0;
    uint32_t *record = c->record; /* in registers, as rim is */
    struct dt_rim *rim = c->rim;
    do {
        uint32_t u = dt_dest(m, h), beyond = dt_twin(m, dt_next(h));
        dt_fetch(&m->half[beyond]);
        if (u != DT_NONE) {
            dt_fetch(&xy[u]);
            dt_fetch(&m->leaving[u]);
        }
        if (n == c->room) {
            if (!dt_cavity_grow(c))
                return DT_NOMEM;
            record = c->record;
            rim = c->rim;
        }
        record[n] = dt_base(h);
        rim[n++] = (struct dt_rim){u, beyond};
        if ((n & DT_WORK_MASK) == 0)
            status = dt_work(c->work, DT_WORK_BLOCK);
        h = dt_turn_ccw(m, h);
        if (n < MET) {
            other = dt_turn_cw(m, other);
            dt_fetch(&m->half[other]);
        }
    } while (status == DT_OK && h != first);
    c->records = c->rims = n;
    return status == DT_OK ? dt_work(c->work, n & DT_WORK_MASK) : status;
}

static void set_bounds(struct hole *w, uint32_t lo, uint32_t hi)
{
    struct dt_box box = dt_box_of(&w->p[lo], hi - lo + 1);
    w->bound = dt_wide_bounds_of(dt_box_side(&box));
}

/* The apex, among P[lo + 1 .. hi - 1], of the triangle left of a->b = P[hi]->P[lo]. Predicates as
 * in merge.c: cr is the orientation of a, b, c, and dt cr' - dt' cr the in-circle determinant. */
static uint32_t find_apex(const struct hole *w, uint32_t lo, uint32_t hi)
{
    struct dt_point a = w->p[hi], b = w->p[lo], best_p = a;
    uint32_t best = DT_NONE;
    double best_cr = 0, best_dt = 0;
    for (uint32_t i = lo + 1; i < hi; i++) {
        struct dt_point c = w->p[i];
        double ux = c.x - a.x, uy = c.y - a.y;
        double cr = (b.x - a.x) * uy - (b.y - a.y) * ux, dt = ux * (c.x - b.x) + uy * (c.y - b.y);
        if (cr <= w->bound.cr && (cr < -w->bound.cr || dt_orient2d(a, b, c) <= 0))
            continue;
        if (best != DT_NONE) {
            double det = best_dt * cr - dt * best_cr;
            if (fabs(det) <= w->bound.det)
                det = dt_incircle_perturbed(a, b, best_p, c);
            if (det <= 0)
                continue;
        }
        best = i;
        best_p = c;
        best_cr = cr;
        best_dt = dt;
    }
    return best;
}

static uint32_t fill_pocket(struct hole *w, uint32_t lo, uint32_t hi);

/* The half edge P[hi]->P[lo] between lo and hi: of the pocket, which is filled, or beyond a rim edge. */
static inline uint32_t closing(struct hole *w, uint32_t lo, uint32_t hi)
{
    return hi == lo + 1 ? w->rim[lo].beyond : fill_pocket(w, lo, hi);
}

/* Fills the pocket P[lo], ..., P[hi] of at least three. Returns the half edge P[hi]->P[lo] that closes the pocket. This is the
 * second half edge of its triangle, so rim vertices leave by other half edges, which dt_hull_keep need not look at later. */
static uint32_t fill_pocket(struct hole *w, uint32_t lo, uint32_t hi)
{
    uint32_t mid = hi == lo + 2 ? lo + 1 : find_apex(w, lo, hi);
    uint32_t t = w->spare[--w->spares];
    dt_set_corners(w->m, t, w->rim[mid].origin, w->rim[hi].origin, w->rim[lo].origin);
    dt_face_begin(w->m, t, w->face);
    dt_link(w->m, t + 2, closing(w, lo, mid));
    dt_link(w->m, t, closing(w, mid, hi));
    return t + 1;
}

static void fill_inside(struct hole *w, uint32_t n)
{
    uint32_t last = w->rim[n - 1].beyond;
    set_bounds(w, 0, n - 1);
    dt_link(w->m, fill_pocket(w, 0, n - 1), last);
}

/* Finds the hull of the chain rim[1 .. n-1] from the side of infinity; hull[] lists it. Vertices on
 * a straight edge are kept. */
static uint32_t hull_of_chain(const struct hole *w, uint32_t n, uint32_t *hull)
{
    uint32_t k = 0;
    for (uint32_t i = 1; i < n; i++) {
        while (k >= 2 && dt_orient2d(w->p[hull[k - 2]], w->p[hull[k - 1]], w->p[i]) > 0)
            k--;
        hull[k++] = i;
    }
    return k;
}

/* rim[0] runs from infinity to P0, rim[n - 1] from the last vertex of the chain to infinity. */
static void fill_at_hull(struct hole *w, uint32_t n)
{
    uint32_t hull[DT_STAR_SMALL], k = hull_of_chain(w, n, hull);
    uint32_t before = w->rim[0].beyond; /* P0->infinity */
    for (uint32_t i = 0; i + 1 < k; i++) {
        uint32_t lo = hull[i], hi = hull[i + 1];
        set_bounds(w, lo, hi);
        uint32_t inner = closing(w, lo, hi), g = w->spare[--w->spares];
        dt_set_corners(w->m, g, w->rim[lo].origin, w->rim[hi].origin, DT_NONE);
        dt_face_begin(w->m, g, 0);
        dt_link(w->m, g, inner);
        dt_link(w->m, g + 2, before);
        w->m->leaving[w->rim[hi].origin] = before = g + 1;
        w->m->hull = g;
        w->m->ghosts++;
    }
    dt_link(w->m, before, w->rim[n - 1].beyond);
}

/* leaving[] of the rim vertices, which may have pointed into the star. */
static void settle_rim(struct dt_mesh *m, const struct dt_cavity *c)
{
    for (uint32_t i = 0; i < c->rims; i++)
        if (c->rim[i].origin != DT_NONE)
            dt_hull_keep(m, c->rim[i].origin, dt_twin(m, c->rim[i].beyond));
}

/* At most DT_STAR_SMALL corners. */
static void fill_small(struct dt_mesh *m, const struct dt_point *xy, const struct dt_cavity *c,
                       uint32_t face)
{
    struct dt_point p[DT_STAR_SMALL];
    struct hole w = {m, c->rim, p, c->record, c->records, face, {0, 0}};
    bool at_hull = c->rim[0].origin == DT_NONE;
    for (uint32_t i = at_hull; i < c->rims; i++)
        p[i] = xy[w.rim[i].origin];
    if (at_hull) {
        m->ghosts -= 2;
        fill_at_hull(&w, c->rims);
    } else {
        fill_inside(&w, c->rims);
    }
    while (w.spares > 0)
        dt_mesh_drop(m, w.spare[--w.spares]);
}

/* Replaces the star of v, whose constraints are released, by other triangles. */
static enum dt_status fill_star(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                struct dt_cavity *c, const struct dt_through *t)
{
    if (t->n == 2 && c->rim[0].origin != DT_NONE)
        return dt_remove_between(m, xy, c, t);
    if (c->rims > DT_STAR_SMALL)
        return dt_remove_large(m, xy, v, c, t->face[0]);
    fill_small(m, xy, c, t->face[0]);
    return DT_OK;
}

/* The star of v is in the cavity. */
static enum dt_status remove_from_plane(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                        struct dt_cavity *c)
{
    struct dt_through t = {0};
    if (m->fixed != NULL && !dt_find_through(m, xy, v, c, &t))
        return DT_CROSSES;
    if (t.n > 0 && dt_fixed_reserve(m, 1) != DT_OK)
        return DT_NOMEM;
    for (uint32_t i = 0; i < t.n; i++)
        dt_unfix(m, t.half[i], t.covers);
    enum dt_status status = fill_star(m, xy, v, c, &t);
    for (uint32_t i = 0; i < t.n && status != DT_OK; i++)
        dt_fix(m, t.half[i], t.covers);
    if (status != DT_OK)
        return status;
    if (m->fixed != NULL)
        dt_keep_rim_fixed(m, c);
    if (t.n > 0 && c->rim[0].origin == DT_NONE)
        dt_fix(m, dt_base(dt_twin(m, c->rim[0].beyond)), t.covers);
    settle_rim(m, c);
    return DT_OK;
}

/* Releases the edges of two ghosts of a line that become one, and returns how many constraints covered each. */
static uint32_t release_edges(struct dt_mesh *m, uint32_t in, uint32_t out)
{
    uint32_t covers = dt_fixed_count(m, in);
    if (covers > 0) {
        dt_unfix(m, in, covers);
        dt_unfix(m, out, covers);
    }
    return covers;
}

/* Removes an edge from a line. If v lies between a and b, (a, v) and (v, b) become (a, b), on both sides. If v
 * is an end next to e, the two ghosts of v-e go. */
static void remove_from_line(struct dt_mesh *m, uint32_t v, const struct dt_changes *changes)
{
    uint32_t in = m->leaving[v] - 1,
             out = dt_base(dt_twin(m, in + 1)); /* (a, v) and (v, b), possibly a = b */
    uint32_t a = m->half[in], b = m->half[out + 1];
    dt_changes_star(changes, a);
    dt_changes_star(changes, b);
    if (a == b) {
        uint32_t before = dt_twin(m, in + 2),
                 after = dt_twin(m, out + 1); /* a->infinity, infinity->a */
        dt_link(m, before, after);
        m->leaving[a] = before;
        m->hull = dt_base(before);
    } else {
        uint32_t back_in = dt_base(dt_twin(m, out)),
                 back_out = dt_base(dt_twin(m, in)); /* (b, v), (v, a) */
        uint32_t after = dt_twin(m, out + 1), back_after = dt_twin(m, back_out + 1);
        uint32_t covers = release_edges(m, in, out);
        m->half[in + 1] = b;
        m->half[back_in + 1] = a;
        dt_link(m, in, back_in);
        dt_link(m, in + 1, after);
        dt_link(m, back_in + 1, back_after);
        if (covers > 0)
            dt_fix(m, in, covers);
        m->leaving[b] = in + 1;
        m->leaving[a] = back_in + 1;
        m->hull = in;
        in = back_out;
    }
    dt_mesh_drop(m, in);
    dt_mesh_drop(m, out);
    m->ghosts -= 2;
}

/* The last but one vertex goes: the other one is alone. */
static void remove_last_edge(struct dt_mesh *m, uint32_t v, const struct dt_changes *changes)
{
    uint32_t g = m->leaving[v] - 1, h = dt_twin(m, g);
    dt_changes_star(changes, m->half[g]);
    m->alone = m->half[g];
    m->leaving[m->alone] = DT_NONE;
    dt_mesh_drop(m, g);
    dt_mesh_drop(m, dt_base(h));
    m->hull = DT_NONE;
    m->ghosts = 0;
}

enum dt_status dt_remove(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                         struct dt_cavity *scratch)
{
    dt_changes_star(scratch->changes, v);
    if (m->vertices == 2) {
        remove_last_edge(m, v, scratch->changes);
    } else if (m->vertices > 2 && dt_mesh_is_line(m)) {
        remove_from_line(m, v, scratch->changes);
    } else if (m->vertices > 2) {
        enum dt_status status = collect_star(m, xy, v, scratch);
        if (status == DT_OK)
            dt_cavity_report(scratch);
        if (status == DT_OK)
            status = remove_from_plane(m, xy, v, scratch);
        if (status != DT_OK)
            return status;
    }
    m->leaving[v] = DT_NONE;
    m->vertices--;
    return DT_OK;
}
