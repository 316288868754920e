/* remove_fixed.c - deletion of a vertex from a mesh with fixed edges. Constraints that run through the vertex divide the hole
 * into two polygons, with an edge between them that they cover from now on:
 *
 *        +-------+                  +-------+
 *       / \     / \                / '.   .' \
 *      a === v === b       ->     a ========= b
 *       \ /     \ /                \ .'   '. /
 *        +-------+                  +-------+
 *
 * The apex rule of remove.c holds for the hole, and for each of the two polygons:
 *
 * 1. v sees every corner, so no corner is in the circle of v and an edge of the rim.
 * 2. So the edges of the rim are Delaunay among the corners, and a-b is a hull edge of the corners on each of its sides.
 * 3. No fixed edge hides a corner of the hole from another corner with which it will share a triangle. */
#include "core/constraints/enforce.h"
#include "core/edit/remove.h"
#include "core/exact/predicates.h"
#include "core/mesh/fixed.h"

/* The half edge from v in the i-th triangle of the star: to the i-th corner of the rim. */
static uint32_t spoke(const struct dt_mesh *m, uint32_t v, const struct dt_cavity *c, uint32_t i)
{
    uint32_t h = c->record[i];
    while (dt_origin(m, h) != v)
        h++;
    return h;
}

bool dt_find_through(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                     const struct dt_cavity *c, struct dt_through *t)
{
    *t = (struct dt_through){.face = {dt_face(m, c->record[0])}};
    for (uint32_t i = 0; i < c->rims; i++) {
        uint32_t h = dt_has_fixed(m, c->record[i]) ? spoke(m, v, c, i) : DT_NONE;
        if (h == DT_NONE || !dt_is_fixed(m, h))
            continue;
        if (t->n == 2)
            return false;
        t->face[t->n] = dt_face(m, h);
        t->half[t->n] = h;
        t->at[t->n++] = i;
    }
    if (t->n == 0)
        return true;
    t->covers = dt_fixed_count(m, t->half[0]);
    return t->n == 2 &&
           dt_orient2d(xy[c->rim[t->at[0]].origin], xy[v], xy[c->rim[t->at[1]].origin]) == 0;
}

/* Fills what is between the corners lo and hi of the rim, and counts on beyond its end if hi is smaller, with triangles
 * of the face. Returns what is on the inside of the edge from hi to lo. */
static uint32_t fill(struct dt_enforcer *e, const struct dt_cavity *c, uint32_t lo, uint32_t hi,
                     uint32_t face, uint32_t *spares)
{
    uint32_t i = lo;
    e->pocket.n = 0;
    e->pocket.face = face;
    for (;;) {
        dt_pocket_add(&e->pocket, c->rim[i].origin, c->rim[i].beyond);
        if (i == hi)
            break;
        i = i + 1 < c->rims ? i + 1 : 0;
    }
    return dt_pocket_fill(&e->pocket, e->mesh, e->xy, c->record, spares, &e->suspects);
}

enum dt_status dt_remove_between(struct dt_mesh *m, const struct dt_point *xy, struct dt_cavity *c,
                                 const struct dt_through *t)
{
    struct dt_enforcer *e = c->enforcer;
    uint32_t spares = c->records;
    enum dt_status status = dt_pocket_reserve(&e->pocket, c->rims + 1);
    if (status == DT_OK)
        status = dt_work(c->work, c->rims);
    if (status != DT_OK)
        return status;
    e->mesh = m;
    e->xy = xy;
    e->changes = c->changes;
    uint32_t one = fill(e, c, t->at[0], t->at[1], t->face[0], &spares);
    uint32_t other = fill(e, c, t->at[1], t->at[0], t->face[1], &spares);
    dt_link(m, one, other);
    dt_fix(m, one, t->covers);
    while (spares > 0)
        dt_mesh_drop(m, c->record[--spares]);
    dt_enforce_mend(e);
    return DT_OK;
}
