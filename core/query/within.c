/* within.c - the points in a closed box or disc, and the triangles that meet a box.
 *
 * A flood goes from triangle to triangle, ghosts included, across every edge that meets the region. It names a vertex
 * at the triangle around it that leaving[] has, so it only has to remember which triangles it has reached.
 *
 * A disc. The vertices in a disc are connected by edges (nearest.h), unless there are fixed edges. The flood starts at a
 * vertex that is nearest to the centre.
 *
 * A box. The vertices in a box need not be connected. But box and hull are convex, so their intersection is connected:
 * the triangles that meet the box are connected across edges that meet the box. Whether an edge without an end in the
 * box meets it is decided exactly. The flood starts at a triangle that holds a corner of the box. If all four corners
 * are outside, the box meets the hull only if it meets a hull edge. If all points are on one line, a walk along the line
 * finds the first edge that meets the box.
 *
 * If the region holds a large share of the set, a scan of all vertices replaces the flood. */
#include "core/control/stop.h"
#include "core/delaunay_constraints.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/hints/hints.h"
#include "core/mesh/hull.h"
#include "core/query/locate.h"
#include "core/query/nearest.h"
#include "core/query/query.h"
#include "core/query/visited.h"
#include "core/set/set.h"

#include <math.h>
#include <stdlib.h>

enum {
    AHEAD = 4,  /* triangles that are fetched ahead */
    SMALL = 128 /* triangles for which there is room at first */
};

struct region {
    bool disc;
    struct dt_box box;
    struct dt_point centre;
    double radius, inside, outside; /* squares: <= inside is in the disc, > outside is not */
};

static inline bool contains(const struct region *r, struct dt_point p)
{
    if (!r->disc)
        return dt_box_contains(&r->box, p);
    double d = dt_square_distance(p, r->centre);
    return d <= r->inside || (d <= r->outside && dt_compare_radius(p, r->centre, r->radius) <= 0);
}

struct flood {
    const struct dt *t;
    struct region in;
    struct dt_stop *work;
    struct dt_visited seen; /* triangles that it has reached, by number */
    struct dt_ids reached;  /* owns: of each of them the half edge across which */
    struct dt_ids *out;     /* borrows: vertices in the region; NULL: not asked for */
};

/* The triangle of h. */
static inline enum dt_status reach(struct flood *f, uint32_t h)
{
    bool fresh;
    enum dt_status s = dt_visited_add(&f->seen, h >> 3, &fresh);
    if (s != DT_OK || !fresh)
        return s;
    dt_fetch(&f->t->mesh.half[dt_base(h)]);
    return dt_ids_append(&f->reached, h);
}

/* A corner of a triangle. */
struct corner {
    uint32_t v; /* DT_NONE: infinity */
    struct dt_point at;
    bool in; /* the region */
};

static inline struct corner corner(const struct flood *f, uint32_t v)
{
    struct corner c = {.v = v};
    if (v != DT_NONE) {
        c.at = f->t->points.xy[v];
        c.in = contains(&f->in, c.at);
    }
    return c;
}

/* Whether an edge with no end in the region meets it; where edges between vertices lead to all in a disc: not needed. */
static inline bool edge_meets(const struct flood *f, struct dt_point p, struct dt_point q)
{
    if (!f->in.disc)
        return dt_segment_meets_box(p, q, f->in.box.lo, f->in.box.hi);
    return f->t->mesh.fixed != NULL && dt_edge_least(f->in.centre, p, q) <= f->in.outside;
}

/* The triangle beyond the half edge h from p to q, if the edge meets the region. */
static inline enum dt_status cross(struct flood *f, uint32_t h, const struct corner *p,
                                   const struct corner *q)
{
    bool meet =
        p->in || q->in || (p->v != DT_NONE && q->v != DT_NONE && edge_meets(f, p->at, q->at));
    return meet ? reach(f, dt_twin(&f->t->mesh, h)) : DT_OK;
}

/* Takes a corner of the triangle of h, in the region, if leaving[] has this one of the triangles around it. */
static inline enum dt_status take(struct flood *f, uint32_t h, const struct corner *c)
{
    bool here = c->in && f->out != NULL && (f->t->mesh.leaving[c->v] ^ h) < 4;
    return here ? dt_ids_append(f->out, c->v) : DT_OK;
}

/* Visits the triangle of h, which was reached across that edge: its corners, and the triangles beyond its other edges. */
static inline enum dt_status look_at(struct flood *f, uint32_t h)
{
    const struct dt_mesh *m = &f->t->mesh;
    struct corner a = corner(f, dt_origin(m, h)), b = corner(f, dt_dest(m, h)),
                  c = corner(f, dt_apex_of(m, h));
    enum dt_status s = dt_work(f->work, 3);
    if (s == DT_OK)
        s = take(f, h, &a);
    if (s == DT_OK)
        s = take(f, h, &b);
    if (s == DT_OK)
        s = take(f, h, &c);
    if (s == DT_OK)
        s = cross(f, dt_next(h), &b, &c);
    return s == DT_OK ? cross(f, dt_prev(h), &c, &a) : s;
}

/* ---- where a flood starts ---- */

/* *half becomes a half edge of a triangle that meets the box, DT_NONE if there is none. */
static enum dt_status first_in_plane(const struct flood *f, uint32_t *half)
{
    const struct dt_mesh *m = &f->t->mesh;
    const struct dt_point *xy = f->t->points.xy;
    const struct dt_box *b = &f->in.box;
    const struct dt_point corner[4] = {b->lo, b->hi, {b->lo.x, b->hi.y}, {b->hi.x, b->lo.y}};
    for (int i = 0; i < 4; i++)
        if (dt_find(f->t, &(struct dt_place){corner[i], DT_NONE}, half) != DT_OUTSIDE)
            return DT_OK;
    enum dt_status s = DT_OK;
    uint32_t g = m->hull;
    *half = DT_NONE;
    do {
        if (dt_segment_meets_box(xy[dt_hull_vertex(m, g)], xy[dt_hull_successor(m, g)], b->lo,
                                 b->hi))
            *half = dt_twin(m, g);
        g = dt_hull_step(m, g, false);
        s = dt_work(f->work, 1);
    } while (s == DT_OK && *half == DT_NONE && g != m->hull);
    return s;
}

static int sign(double d)
{
    return (d > 0) - (d < 0);
}

/* The position of `at` relative to the box along the direction from p to q: < 0 before it, 0 inside, > 0 past it. A walk
 * that does not reach the box is past it. */
static int along(const struct dt_box *b, struct dt_point at, struct dt_point p, struct dt_point q)
{
    int x = at.x < b->lo.x ? -1 : at.x > b->hi.x, y = at.y < b->lo.y ? -1 : at.y > b->hi.y;
    int dx = sign(q.x - p.x), dy = sign(q.y - p.y);
    if (x == 0 && y == 0)
        return 0;
    return x * dx <= 0 && y * dy <= 0 && (dx != 0 || x == 0) && (dy != 0 || y == 0) ? -1 : 1;
}

/* A place near which the line through p and q enters the box, roughly. */
static struct dt_point entry(const struct dt_box *b, struct dt_point p, struct dt_point q)
{
    double dx = q.x - p.x, dy = q.y - p.y;
    double x0 = dy == 0 ? -(double)INFINITY : p.x + (b->lo.y - p.y) * (dx / dy);
    double x1 = dy == 0 ? (double)INFINITY : p.x + (b->hi.y - p.y) * (dx / dy);
    double x = fmax(b->lo.x, fmin(x0, x1));
    double y = dx == 0 ? b->lo.y : p.y + (x - p.x) * (dy / dx);
    return (struct dt_point){x, y};
}

/* The same where all points are on one line: a walk along it from a hint, ahead or, if the box is not ahead, back. */
static enum dt_status first_on_line(const struct flood *f, uint32_t *half)
{
    const struct dt_mesh *m = &f->t->mesh;
    const struct dt_point *xy = f->t->points.xy;
    const struct dt_box *b = &f->in.box;
    enum dt_status s = DT_OK;
    uint32_t g = m->hull;
    if (f->t->hints.grids > 0)
        g = dt_hint_live(&f->t->hints, m, xy,
                         entry(b, xy[dt_hull_vertex(m, g)], xy[dt_hull_successor(m, g)]));
    struct dt_point p = xy[dt_hull_vertex(m, g)], q = xy[dt_hull_successor(m, g)];
    if (along(b, p, p, q) > 0)
        g = dt_base(dt_twin(m, g));
    *half = DT_NONE;
    for (bool at_end = false; s == DT_OK && !at_end && *half == DT_NONE;
         g = dt_hull_step(m, g, false)) {
        p = xy[dt_hull_vertex(m, g)];
        q = xy[dt_hull_successor(m, g)];
        if (dt_segment_meets_box(p, q, b->lo, b->hi))
            *half = g;
        at_end = along(b, q, p, q) > 0 || dt_hull_turns(m, g);
        s = dt_work(f->work, 1);
    }
    return s;
}

static enum dt_status nearest_one(const struct flood *f, const struct dt_place *q, uint32_t *v)
{
    struct dt_ids one = {0};
    enum dt_status s = dt_nearest_fixed(f->t, q, 1, f->work, &one);
    *v = s == DT_OK ? one.v[0] : DT_NONE;
    free(one.v);
    return s;
}

static enum dt_status begin(struct flood *f)
{
    const struct dt_mesh *m = &f->t->mesh;
    bool tie;
    uint32_t h = DT_NONE, v;
    enum dt_status s;
    if (f->in.disc) {
        struct dt_place centre = {f->in.centre, DT_NONE};
        if (m->fixed == NULL || dt_mesh_is_line(m))
            s = dt_nearest_vertex(f->t, &centre, f->work, &v, &tie);
        else
            s = nearest_one(f, &centre, &v);
        if (s == DT_OK && contains(&f->in, f->t->points.xy[v]))
            h = m->leaving[v];
    } else {
        s = dt_mesh_is_line(m) ? first_on_line(f, &h) : first_in_plane(f, &h);
    }
    if (s != DT_OK || h == DT_NONE)
        return s;
    struct corner p = corner(f, dt_origin(m, h)), q = corner(f, dt_dest(m, h));
    s = dt_ids_reserve(&f->reached, SMALL);
    if (s == DT_OK)
        s = reach(f, h);
    return s == DT_OK ? cross(f, h, &p, &q) : s;
}

/* ---- flood or scan ---- */

static inline void fetch_apex(const struct dt *t, uint32_t h)
{
    uint32_t v = dt_apex_of(&t->mesh, h);
    if (v != DT_NONE) {
        dt_fetch(&t->points.xy[v]);
        dt_fetch(&t->mesh.leaving[v]);
    }
}

/* From where it starts to all that is in the region. *scan: a scan of the whole set, which costs much less for each
 * result, should replace it: it is given up. */
static enum dt_status flood_on(struct flood *f, bool *scan)
{
    enum dt_status s = begin(f);
    *scan = false;
    for (size_t at = 0; s == DT_OK && at < f->reached.n && !*scan; at++) {
        if (at + AHEAD < f->reached.n)
            fetch_apex(f->t, f->reached.v[at + AHEAD]);
        s = look_at(f, f->reached.v[at]);
        *scan = f->reached.n > 512 && f->reached.n > f->t->mesh.tri_end / 64;
    }
    return s;
}

/* Appends the vertices in the region to *out, which may be NULL. *reached: the triangles; owned by the caller. */
static enum dt_status flood(const struct dt *t, const struct region *r, struct dt_stop *work,
                            struct dt_ids *out, struct dt_ids *reached, bool *scan)
{
    struct flood f = {.t = t, .in = *r, .work = work, .out = out};
    dt_visited_init(&f.seen, DT_VISITED_SMALL);
    enum dt_status s = flood_on(&f, scan);
    dt_visited_clear(&f.seen);
    *reached = f.reached;
    return s;
}

static enum dt_status scan_points(const struct dt *t, const struct region *r, struct dt_stop *work,
                                  struct dt_ids *out)
{
    const struct dt_points *p = &t->points;
    enum dt_status s = DT_OK;
    for (uint32_t v = 0; v < p->end && s == DT_OK; v++) {
        if (contains(r, p->xy[v]) && p->id[v] != DT_NONE)
            s = dt_ids_append(out, v);
        if (s == DT_OK && (v & DT_WORK_MASK) == 0)
            s = dt_work(work, DT_WORK_BLOCK);
    }
    return s;
}

/* ---- points ---- */

static enum dt_status within(const struct dt *t, const struct region *r,
                             const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    struct dt_ids reached = {0};
    bool scan = t->mesh.vertices == 1; /* which is in no triangle */
    size_t n = out->n;
    enum dt_status s = dt_readable(t);
    if (s != DT_OK || t->mesh.vertices == 0)
        return s;
    if (!scan)
        s = flood(t, r, &work, out, &reached, &scan);
    free(reached.v);
    if (s == DT_OK && scan) {
        out->n = n;
        s = scan_points(t, r, &work, out);
    }
    if (s == DT_OK)
        dt_vertices_to_ids(t, out, n);
    else
        out->n = n;
    return s;
}

enum dt_status dt_within_box(const struct dt *t, struct dt_point lo, struct dt_point hi,
                             const struct dt_options *opt, struct dt_ids *out)
{
    if (lo.x > hi.x || lo.y > hi.y)
        return dt_readable(t);
    return within(t, &(struct region){.box = {lo, hi}}, opt, out);
}

enum dt_status dt_within_disc(const struct dt *t, struct dt_point centre, double r,
                              const struct dt_options *opt, struct dt_ids *out)
{
    struct region disc = {.disc = true, .centre = centre, .radius = r};
    disc.inside = r * r * (1 - 4 * DT_DISTANCE_BOUND);
    disc.outside = r * r * (1 + 4 * DT_DISTANCE_BOUND);
    return within(t, &disc, opt, out);
}

/* ---- the triangles that meet a box ---- */

bool dt_triangle_meets(const struct dt_point p[3], struct dt_point lo, struct dt_point hi)
{
    struct dt_box b = {lo, hi}, around = dt_box_of(p, 3);
    return dt_box_overlaps(&around, &b) &&
           (dt_segment_meets_box(p[0], p[1], lo, hi) || dt_segment_meets_box(p[1], p[2], lo, hi) ||
            dt_segment_meets_box(p[2], p[0], lo, hi) ||
            (dt_orient2d(p[0], p[1], lo) > 0 && dt_orient2d(p[1], p[2], lo) > 0 &&
             dt_orient2d(p[2], p[0], lo) > 0));
}

static enum dt_status scan_triangles(const struct dt *t, const struct dt_box *b,
                                     struct dt_stop *work, struct dt_ids *out)
{
    const struct dt_point *xy = t->points.xy;
    enum dt_status s = DT_OK;
    for (uint32_t h = 0; h < 8 * t->mesh.tri_end && s == DT_OK; h += 8) {
        const uint32_t *v = t->mesh.half + h;
        if (!dt_is_dead(&t->mesh, h) && !dt_is_ghost(&t->mesh, h) &&
            dt_triangle_meets((struct dt_point[]){xy[v[0]], xy[v[1]], xy[v[2]]}, b->lo, b->hi))
            s = dt_ids_append(out, h);
        if (s == DT_OK && (h >> 3 & DT_WORK_MASK) == 0)
            s = dt_work(work, DT_WORK_BLOCK);
    }
    return s;
}

/* Appends the corners of these triangles to *out, sorted. */
static enum dt_status put_triangles(const struct dt *t, const struct dt_ids *triangles, bool cw,
                                    struct dt_ids *out)
{
    enum dt_status s = dt_ids_reserve(out, 3 * triangles->n);
    if (s != DT_OK || triangles->n == 0)
        return s;
    uint32_t *row = out->v + out->n;
    size_t n = 0;
    for (size_t i = 0; i < triangles->n; i++)
        if (!dt_is_ghost(&t->mesh, triangles->v[i]))
            dt_triangle_ids(t, triangles->v[i], cw, row + 3 * n++);
    qsort(row, n, 3 * sizeof *row, dt_triangle_compare);
    out->n += 3 * n;
    return DT_OK;
}

enum dt_status dt_within_triangles(const struct dt *t, struct dt_point lo, struct dt_point hi,
                                   bool cw, const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    struct dt_box b = {lo, hi};
    struct dt_ids triangles = {0};
    bool scan;
    enum dt_status s = dt_readable(t);
    if (s != DT_OK || dt_mesh_is_line(&t->mesh) || lo.x > hi.x || lo.y > hi.y)
        return s;
    s = flood(t, &(struct region){.box = b}, &work, NULL, &triangles, &scan);
    if (s == DT_OK && scan) {
        triangles.n = 0;
        s = scan_triangles(t, &b, &work, &triangles);
    }
    if (s == DT_OK)
        s = put_triangles(t, &triangles, cw, out);
    free(triangles.v);
    return s;
}
