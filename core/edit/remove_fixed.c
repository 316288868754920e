/* remove_fixed.c - deletion of a vertex from a mesh with fixed edges. The star of the vertex becomes one polygon; or two, if
 * constraints run through the vertex, with an edge between them that they cover from now on:
 *
 *        +-------+                  +-------+
 *       / \     / \                / .     . \         The polygons are filled ear by ear (pocket.h), and flips make their
 *      a === v === b       ->     a ========= b        edges Delaunay. (The apex rule of remove.c is of no use here: a
 *       \ /     \ /                \  .    . /         corner may be in the circle of a triangle and hidden from it.)
 *        +-------+                  +-------+
 */
#include "core/constraints/enforce.h"
#include "core/edit/remove.h"
#include "core/exact/predicates.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

/* The star of v while it is replaced. */
struct hole {
    struct dt_mesh *m;
    const struct dt_point *xy;
    struct dt_point v;
    const struct dt_cavity *c;
    struct dt_enforcer *e;
    uint32_t spares;
    uint32_t fixed[2], n_fixed; /* corners of the rim at the ends of fixed spokes */
    uint32_t covers;            /* constraints that run through v */
    uint32_t face[2]; /* of the triangles between them, from either one on; else face[0] of all */
};

/* The half edge from v in the i-th triangle of the star: to the i-th corner of the rim. */
static uint32_t spoke(const struct hole *w, uint32_t v, uint32_t i)
{
    uint32_t h = w->c->record[i];
    while (dt_origin(w->m, h) != v)
        h++;
    return h;
}

/* False: not two constraints' edges that go straight on. */
static bool look_for_fixed(struct hole *w, uint32_t v)
{
    w->n_fixed = 0;
    w->face[0] = dt_face(w->m, w->c->record[0]);
    for (uint32_t i = 0; i < w->c->rims; i++) {
        uint32_t h = spoke(w, v, i);
        if (!dt_is_fixed(w->m, h))
            continue;
        if (w->n_fixed == 2)
            return false;
        w->covers = dt_fixed_count(w->m, h);
        w->face[w->n_fixed] = dt_face(w->m, h);
        w->fixed[w->n_fixed++] = i;
    }
    if (w->n_fixed == 0)
        return true;
    return w->n_fixed == 2 && dt_orient2d(w->xy[w->c->rim[w->fixed[0]].origin], w->v,
                                          w->xy[w->c->rim[w->fixed[1]].origin]) == 0;
}

/* Fills what is between the corners lo and hi of the rim, and counts on beyond its end if hi is smaller, with triangles
 * of the face. Returns what is on the inside of the edge from hi to lo. */
static uint32_t fill(struct hole *w, uint32_t lo, uint32_t hi, bool closed, uint32_t face)
{
    uint32_t n = w->c->rims, i = lo;
    w->e->pocket.n = 0;
    w->e->pocket.face = face;
    for (;;) {
        dt_pocket_add(&w->e->pocket, w->c->rim[i].origin, w->c->rim[i].beyond);
        if (i == hi)
            break;
        i = i + 1 < n ? i + 1 : 0;
    }
    return dt_pocket_fill(&w->e->pocket, w->m, w->xy, closed, &w->v, w->c->record, &w->spares,
                          &w->e->suspects);
}

static void fill_inside(struct hole *w)
{
    if (w->n_fixed == 0) {
        fill(w, 0, w->c->rims - 1, true, w->face[0]);
        return;
    }
    uint32_t one = fill(w, w->fixed[0], w->fixed[1], false, w->face[0]);
    uint32_t other = fill(w, w->fixed[1], w->fixed[0], false, w->face[1]);
    dt_link(w->m, one, other);
    dt_fix(w->m, one, w->covers);
}

/* The corners of the rim on the hull without v, into hull[]. Those on a straight edge are kept. */
static uint32_t hull_of_chain(const struct hole *w, uint32_t *hull)
{
    uint32_t k = 0;
    for (uint32_t i = 1; i < w->c->rims; i++) {
        struct dt_point p = w->xy[w->c->rim[i].origin];
        while (k >= 2 && dt_orient2d(w->xy[w->c->rim[hull[k - 2]].origin],
                                     w->xy[w->c->rim[hull[k - 1]].origin], p) > 0)
            k--;
        hull[k++] = i;
    }
    return k;
}

/* As in remove.c. */
static void fill_at_hull(struct hole *w)
{
    struct dt_mesh *m = w->m;
    const struct dt_rim *rim = w->c->rim;
    uint32_t *hull = w->e->step.v, k = hull_of_chain(w, hull), before = rim[0].beyond, inner = 0;
    m->ghosts -= 2;
    for (uint32_t i = 0; i + 1 < k; i++) {
        uint32_t lo = hull[i], hi = hull[i + 1];
        inner = fill(w, lo, hi, false, w->face[0]);
        uint32_t g = w->c->record[--w->spares];
        dt_set_corners(m, g, rim[lo].origin, rim[hi].origin, DT_NONE);
        dt_face_begin(m, g, 0);
        dt_fixed_mark(m, g, dt_is_fixed(m, inner));
        dt_link(m, g, inner);
        dt_link(m, g + 2, before);
        m->leaving[rim[hi].origin] = before = g + 1;
        m->hull = g;
        m->ghosts++;
    }
    dt_link(m, before, rim[w->c->rims - 1].beyond);
    if (w->n_fixed == 2)
        dt_fix(m, inner, w->covers);
}

static enum dt_status reserve(struct hole *w)
{
    struct dt_enforcer *e = w->e;
    enum dt_status status = dt_pocket_reserve(&e->pocket, w->c->rims + 1);
    if (status == DT_OK)
        status = dt_enforcer_reserve(e, w->c->rims);
    return status == DT_OK ? dt_fixed_reserve(w->m, 1) : status;
}

enum dt_status dt_remove_fixed(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                               struct dt_cavity *c)
{
    struct hole w = {.m = m, .xy = xy, .v = xy[v], .c = c, .e = c->enforcer, .spares = c->records};
    w.e->mesh = m;
    w.e->xy = xy;
    w.e->changes = c->changes;
    if (!look_for_fixed(&w, v))
        return DT_CROSSES;
    enum dt_status status = reserve(&w);
    if (status != DT_OK)
        return status;
    for (uint32_t i = 0; i < w.n_fixed; i++)
        dt_unfix(m, spoke(&w, v, w.fixed[i]), w.covers);
    if (c->rim[0].origin == DT_NONE)
        fill_at_hull(&w);
    else
        fill_inside(&w);
    while (w.spares > 0)
        dt_mesh_drop(m, c->record[--w.spares]);
    dt_enforce_mend(w.e);
    return DT_OK;
}
