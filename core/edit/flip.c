/* flip.c - see flip.h.
 *
 * A triangulation all of whose triangles turn left and all of whose edges are locally Delaunay is the
 * Delaunay triangulation; so are, with ties broken, the edges of the canonical one. A flip lowers the
 * surface over the plane that the lifted, perturbed points span, so no triangulation comes twice and the
 * flips end [Lawson 1977; Edelsbrunner 2001, sec. 1.2]. An edge that is not locally Delaunay is a diagonal
 * of a strictly convex quadrilateral, so it can always be flipped, and hull edges never change.
 *
 *            c                         c
 *          /   \                     / | \
 *        /       \                 /   |   \        h:  a->b, its twin b->a. The records stay within
 *       a ------- b       ->      a    |    b       the quadrilateral: b->c and a->d keep their half
 *        \   h   /                 \   |   /        edges, d->b becomes h, c->a becomes the twin, and
 *          \   /                     \ | /          the diagonal c->d prev(h).
 *            d                         d
 */
#include "core/edit/flip.h"

#include "core/exact/predicates.h"
#include "core/mesh/hull.h"

static bool add_suspect(struct dt_flips *f, uint32_t h)
{
    if (f->suspects == sizeof f->suspect / sizeof *f->suspect)
        return false;
    f->suspect[f->suspects++] = h;
    return true;
}

enum { SPOKES = 16, MET = 4 };

/* Lists the next spokes of a star, from *h on, which moves on; returns how many. The way round is a chain
 * of cache misses: a second one, clockwise, meets it half way. What lies around is fetched. */
static uint32_t next_spokes(const struct dt_mesh *m, const struct dt_point *xy, uint32_t first,
                            uint32_t *h, uint32_t spoke[SPOKES])
{
    uint32_t n = 0, other = first;
    do {
        dt_fetch(&m->half[dt_base(dt_twin(m, dt_next(*h)))]);
        dt_fetch(&xy[dt_dest(m, *h)]);
        spoke[n++] = *h;
        *h = dt_turn_ccw(m, *h);
        if (n < MET) {
            other = dt_turn_cw(m, other);
            dt_fetch(&m->half[other]);
        }
    } while (*h != first && n < SPOKES);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t beyond = dt_apex_of(m, dt_twin(m, dt_next(spoke[i])));
        if (beyond != DT_NONE)
            dt_fetch(&xy[beyond]);
    }
    return n;
}

/* Looks at the triangle left of the spoke h, and at its edges to the triangles before and beyond. False:
 * the move is not allowed. */
static bool look_at(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                    struct dt_point to, struct dt_point before, struct dt_flips *f)
{
    struct dt_point p = xy[dt_dest(m, h)], q = xy[dt_apex_of(m, h)];
    uint32_t rim = dt_next(h), beyond = dt_twin(m, rim);
    if (dt_orient2d(to, p, q) <= 0)
        return false;
    if (dt_incircle_perturbed(to, p, q, before) > 0 && !add_suspect(f, h))
        return false;
    return dt_is_ghost(m, beyond) ||
           dt_incircle_perturbed(to, p, q, xy[dt_apex_of(m, beyond)]) <= 0 || add_suspect(f, rim);
}

enum dt_status dt_star_allows(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                              struct dt_point to, struct dt_work *work, struct dt_flips *f,
                              bool *allowed)
{
    enum dt_status status = DT_OK;
    *allowed = !dt_on_hull(m, v);
    f->suspects = f->flipped = 0;
    uint32_t spoke[SPOKES], first = m->leaving[v], h = first;
    if (!*allowed)
        return DT_OK;
    struct dt_point before = xy[dt_dest(m, dt_turn_cw(m, h))];
    do {
        uint32_t n = next_spokes(m, xy, first, &h, spoke);
        status = dt_work(work, n);
        for (uint32_t i = 0; i < n && *allowed; i++) {
            *allowed = look_at(m, xy, spoke[i], to, before, f);
            before = xy[dt_dest(m, spoke[i])];
        }
    } while (status == DT_OK && *allowed && h != first);
    *allowed = *allowed && status == DT_OK;
    return status;
}

static void leave_by(struct dt_mesh *m, uint32_t v, uint32_t old, uint32_t h)
{
    if (m->leaving[v] == old)
        m->leaving[v] = h;
}

/* Flips the edge of h: see the drawing. */
static void flip(struct dt_mesh *m, uint32_t h)
{
    uint32_t g = dt_twin(m, h), a = dt_origin(m, h), b = dt_origin(m, g);
    uint32_t db = dt_twin(m, dt_prev(g)), ca = dt_twin(m, dt_prev(h)); /* seen from outside */
    m->half[h] = dt_apex_of(m, g);
    m->half[g] = dt_apex_of(m, h);
    dt_link(m, h, db);
    dt_link(m, g, ca);
    dt_link(m, dt_prev(h), dt_prev(g));
    leave_by(m, a, h, dt_next(g));
    leave_by(m, b, g, dt_next(h));
}

/* The inverse of flip(m, h). */
static void flip_back(struct dt_mesh *m, uint32_t h)
{
    uint32_t g = dt_next(dt_twin(m, dt_prev(h))), d = dt_origin(m, h), c = dt_origin(m, g);
    uint32_t db = dt_twin(m, h), ca = dt_twin(m, g);
    m->half[h] = dt_dest(m, g);
    m->half[g] = dt_dest(m, h);
    dt_link(m, dt_prev(g), db);
    dt_link(m, dt_prev(h), ca);
    dt_link(m, h, g);
    leave_by(m, d, h, dt_prev(g));
    leave_by(m, c, g, dt_prev(h));
}

static bool is_delaunay(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h)
{
    uint32_t g = dt_twin(m, h);
    return dt_is_ghost(m, g) ||
           dt_incircle_perturbed(xy[dt_origin(m, h)], xy[dt_origin(m, g)], xy[dt_apex_of(m, h)],
                                 xy[dt_apex_of(m, g)]) <= 0;
}

/* Flips the edge of h and suspects those around it. */
static enum dt_status flip_one(struct dt_mesh *m, struct dt_flips *f, uint32_t h,
                               const struct dt_cavity *scratch)
{
    enum dt_status status = dt_work(scratch->work, 1);
    uint32_t g = dt_twin(m, h);
    if (status == DT_OK && f->flipped == DT_FLIPS)
        status = DT_TOOBIG;
    if (status != DT_OK)
        return status;
    dt_changes_star(scratch->changes, dt_origin(m, h));
    dt_changes_star(scratch->changes, dt_origin(m, g));
    dt_changes_star(scratch->changes, dt_apex_of(m, h));
    dt_changes_star(scratch->changes, dt_apex_of(m, g));
    flip(m, h);
    f->flip[f->flipped++] = h;
    bool room = add_suspect(f, h) && add_suspect(f, dt_next(h)) && add_suspect(f, g) &&
                add_suspect(f, dt_next(g));
    return room ? DT_OK : DT_TOOBIG;
}

enum dt_status dt_flip_all(struct dt_mesh *m, const struct dt_point *xy, struct dt_flips *f,
                           const struct dt_cavity *scratch)
{
    enum dt_status status = DT_OK;
    while (status == DT_OK && f->suspects > 0) {
        uint32_t h = f->suspect[--f->suspects];
        if (!is_delaunay(m, xy, h))
            status = flip_one(m, f, h, scratch);
    }
    while (status != DT_OK && f->flipped > 0)
        flip_back(m, f->flip[--f->flipped]);
    m->recycled = m->recycled || f->flipped > 0;
    return status;
}
