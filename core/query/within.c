/* within.c - the points in a closed box or disc, and the triangles that meet a box.
 *
 * A flood goes from each vertex in the region to its neighbours there. The vertices in a disc are connected by edges
 * (nearest.h), so it reaches all of them from one that is nearest to the centre. Those in a box need not be. But box
 * and hull are convex, so what they share is connected, and so are, edge by edge, the triangles that meet it: here the
 * flood starts with such a triangle, and also crosses the edges that meet the box with no end in it, which is decided
 * exactly. A first triangle: one that holds a corner of the box; if all four corners are outside, the box meets the
 * hull only if it meets a hull edge.
 *
 * Where the region turns out to hold a large share of the set, a scan of all vertices replaces the flood. */
#include "core/control/stop.h"
#include "core/exact/box.h"
#include "core/exact/predicates.h"
#include "core/grid/hints.h"
#include "core/mesh/hull.h"
#include "core/query/locate.h"
#include "core/query/nearest.h"
#include "core/query/query.h"
#include "core/query/visited.h"
#include "core/set/set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct region {
    bool disc;
    struct dt_box box;
    struct dt_point centre;
    double radius;
};

static inline bool contains(const struct region *r, struct dt_point p)
{
    if (!r->disc)
        return dt_box_contains(&r->box, p);
    double d = dt_square_distance(p, r->centre), most = r->radius * r->radius;
    return dt_squares_decide(d, most) ? d < most : dt_compare_radius(p, r->centre, r->radius) <= 0;
}

/* Whether the closed segment p-q meets the box: no axis and not the segment's normal separates
 * them. */
static bool meets(const struct dt_box *b, struct dt_point p, struct dt_point q)
{
    if (dt_box_contains(b, p) || dt_box_contains(b, q))
        return true;
    struct dt_box around = dt_box_of((const struct dt_point[]){p, q}, 2);
    if (!dt_box_overlaps(&around, b))
        return false;
    bool rising = (p.x < q.x) == (p.y < q.y);
    struct dt_point left = {b->lo.x, rising ? b->hi.y : b->lo.y},
                    right = {b->hi.x, rising ? b->lo.y : b->hi.y};
    return dt_orient2d(p, q, left) * dt_orient2d(p, q, right) <= 0;
}

/* Triangles with a corner in the region are met while walking round that corner; only edges that cross a box from
 * outside to outside need a list of their own. */
struct flood {
    const struct dt *t;
    struct region in;
    struct dt_stop *work;
    struct dt_visited vertices, edges; /* seen; an edge by its lower half edge */
    struct dt_ids todo;                /* edges across the box, to be looked at from both sides */
    struct dt_ids *out;                /* borrowed: vertices in the region */
    struct dt_ids
        *triangles; /* borrowed: those that meet the box, some twice; NULL: not asked for */
};

/* The triangle of h, which meets the box. */
static enum dt_status meet(struct flood *f, uint32_t h)
{
    bool asked = f->triangles != NULL && !dt_is_ghost(&f->t->mesh, h);
    return asked ? dt_ids_append(f->triangles, dt_base(h)) : DT_OK;
}

/* Takes v if it is in the region. */
static inline enum dt_status take(struct flood *f, uint32_t v)
{
    bool fresh;
    if (!contains(&f->in, f->t->points.xy[v]))
        return DT_OK;
    enum dt_status s = dt_visited_add(&f->vertices, v, &fresh);
    if (s == DT_OK && fresh) {
        dt_fetch(&f->t->mesh.leaving[v]);
        s = dt_ids_append(f->out, v);
    }
    return s;
}

/* Takes the edge of h if it crosses the box and neither end is in it. */
static enum dt_status cross(struct flood *f, uint32_t h)
{
    const struct dt_mesh *m = &f->t->mesh;
    const struct dt_box *b = &f->in.box;
    struct dt_point p = f->t->points.xy[dt_origin(m, h)], q = f->t->points.xy[dt_dest(m, h)];
    uint32_t twin = dt_twin(m, h);
    bool fresh;
    if (dt_box_contains(b, p) || dt_box_contains(b, q) || !meets(b, p, q))
        return DT_OK;
    enum dt_status s = dt_visited_add(&f->edges, h < twin ? h : twin, &fresh);
    return s == DT_OK && fresh ? dt_ids_append(&f->todo, h) : s;
}

/* The triangle of h, unless h is the edge of a ghost: its third corner and its two other edges. */
static enum dt_status look_beyond(struct flood *f, uint32_t h)
{
    const struct dt_mesh *m = &f->t->mesh;
    if (dt_is_ghost(m, h))
        return DT_OK;
    enum dt_status s = take(f, dt_apex_of(m, h));
    if (s == DT_OK)
        s = meet(f, h);
    if (s == DT_OK)
        s = cross(f, dt_next(h));
    return s == DT_OK ? cross(f, dt_prev(h)) : s;
}

/* The triangle of h, the origin of which is in the box: it meets it, and the edge opposite may. It is met here unless
 * another corner in the box comes first. */
static enum dt_status meet_at(struct flood *f, uint32_t h)
{
    const struct dt_mesh *m = &f->t->mesh;
    const struct dt_point *xy = f->t->points.xy;
    enum dt_status s = cross(f, dt_next(h));
    if (s != DT_OK || f->triangles == NULL)
        return s;
    uint32_t v = dt_origin(m, h), a = dt_dest(m, h), b = dt_apex_of(m, h);
    bool first = (a > v || !contains(&f->in, xy[a])) && (b > v || !contains(&f->in, xy[b]));
    return first ? meet(f, h) : DT_OK;
}

/* The neighbours of v, which is in the region, and in a plane the triangles around it. */
static enum dt_status look_around(struct flood *f, uint32_t v)
{
    const struct dt_mesh *m = &f->t->mesh;
    enum dt_status s = DT_OK;
    uint32_t h = m->leaving[v];
    if (h == DT_NONE)
        return s;
    do {
        s = dt_work(f->work, 1);
        dt_fetch_beyond_star(m, h);
        if (s == DT_OK && dt_dest(m, h) != DT_NONE)
            s = take(f, dt_dest(m, h));
        if (s == DT_OK && !f->in.disc && !dt_is_ghost(m, h))
            s = meet_at(f, h);
        h = dt_turn_ccw(m, h);
    } while (s == DT_OK && h != m->leaving[v]);
    return s;
}

/* ---- where a flood starts ---- */

/* *half becomes a half edge of a triangle that meets the box, DT_NONE if there is none. */
static enum dt_status first_triangle(const struct flood *f, uint32_t *half)
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
        if (meets(b, xy[dt_hull_vertex(m, g)], xy[dt_hull_successor(m, g)]))
            *half = dt_twin(m, g);
        g = dt_hull_step(m, g, false);
        s = dt_work(f->work, 1);
    } while (s == DT_OK && *half == DT_NONE && g != m->hull);
    return s;
}

static enum dt_status begin_in_plane(struct flood *f)
{
    uint32_t h;
    enum dt_status s = first_triangle(f, &h);
    if (s != DT_OK || h == DT_NONE)
        return s;
    s = meet(f, h);
    for (int k = 0; k < 3 && s == DT_OK; k++, h = dt_next(h)) {
        s = take(f, dt_origin(&f->t->mesh, h));
        if (s == DT_OK)
            s = cross(f, h);
    }
    return s;
}

static enum dt_status begin(struct flood *f)
{
    const struct dt_mesh *m = &f->t->mesh;
    if (m->vertices == 1)
        return take(f, m->alone);
    if (!f->in.disc)
        return begin_in_plane(f);
    bool tie;
    uint32_t v;
    struct dt_place centre = {f->in.centre, DT_NONE};
    enum dt_status s = dt_nearest_vertex(f->t, &centre, f->work, &v, &tie);
    return s == DT_OK ? take(f, v) : s;
}

/* ---- flood or scan ---- */

/* Whether a scan of the whole set, which costs much less for each result, should replace a search that has found this
 * number of them. */
static bool scan_pays(const struct dt *t, size_t found)
{
    return found > 256 && found > t->points.end / 64;
}

/* From where it starts to all that is in the region, or until a scan pays. */
static enum dt_status flood_on(struct flood *f, size_t first)
{
    const struct dt_mesh *m = &f->t->mesh;
    enum dt_status s = begin(f);
    for (size_t at = first; s == DT_OK && (f->todo.n > 0 || at < f->out->n);) {
        if (scan_pays(f->t, f->out->n - first))
            return DT_OK;
        if (f->todo.n == 0) {
            if (at + 1 < f->out->n)
                dt_fetch(&m->half[m->leaving[f->out->v[at + 1]]]);
            s = look_around(f, f->out->v[at++]);
            continue;
        }
        uint32_t h = f->todo.v[--f->todo.n];
        s = dt_work(f->work, 2);
        if (s == DT_OK)
            s = look_beyond(f, h);
        if (s == DT_OK)
            s = look_beyond(f, dt_twin(m, h));
    }
    return s;
}

/* *scan: a scan pays. */
static enum dt_status flood(const struct dt *t, const struct region *r, struct dt_stop *work,
                            struct dt_ids *out, struct dt_ids *triangles, bool *scan)
{
    struct flood f = {.t = t, .in = *r, .work = work, .out = out, .triangles = triangles};
    size_t n = out->n;
    dt_visited_init(&f.vertices);
    dt_visited_init(&f.edges);
    enum dt_status s = flood_on(&f, n);
    dt_visited_clear(&f.vertices);
    dt_visited_clear(&f.edges);
    free(f.todo.v);
    *scan = scan_pays(t, out->n - n);
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

/* ---- a box among points on a line: what lies in it are neighbours along the line ---- */

/* How p lies to the box along the direction of walk: < 0 before it, 0 inside, > 0 past it. A walk
 * that does not reach the box is past it. dx and dy are the signs of the direction. */
static int along(const struct dt_box *b, struct dt_point p, int dx, int dy)
{
    int x = p.x < b->lo.x ? -1 : p.x > b->hi.x, y = p.y < b->lo.y ? -1 : p.y > b->hi.y;
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

static int sign(double d)
{
    return (d > 0) - (d < 0);
}

/* Appends the vertices in the box from that of g on, ahead; at_end: that one is the end of the
 * line. */
static enum dt_status walk_line(const struct dt *t, const struct dt_box *b, uint32_t g, bool at_end,
                                int dx, int dy, struct dt_stop *work, struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    for (;;) {
        uint32_t v = dt_hull_vertex(m, g);
        int place = along(b, t->points.xy[v], dx, dy);
        enum dt_status s = dt_work(work, 1);
        if (s == DT_OK && place == 0)
            s = dt_ids_append(out, v);
        if (s != DT_OK || place > 0 || at_end)
            return s;
        at_end = dt_hull_turns(m, g);
        g = dt_hull_step(m, g, false);
    }
}

static enum dt_status walk_box(const struct dt *t, const struct dt_box *b, struct dt_stop *work,
                               struct dt_ids *out)
{
    const struct dt_mesh *m = &t->mesh;
    const struct dt_point *xy = t->points.xy;
    uint32_t g = m->hull;
    if (t->hints.grids > 0)
        g = dt_hint_live(&t->hints, m, xy,
                         entry(b, xy[dt_hull_vertex(m, g)], xy[dt_hull_successor(m, g)]));
    struct dt_point p = xy[dt_hull_vertex(m, g)], ahead = xy[dt_hull_successor(m, g)];
    int dx = sign(ahead.x - p.x), dy = sign(ahead.y - p.y);
    enum dt_status s = walk_line(t, b, g, false, dx, dy, work, out);
    uint32_t back = dt_twin(m, g); /* leads back to p */
    if (s != DT_OK || along(b, p, dx, dy) < 0 || dt_hull_turns(m, back))
        return s;
    back = dt_hull_step(m, back, false);
    return walk_line(t, b, dt_hull_step(m, back, false), dt_hull_turns(m, back), -dx, -dy, work,
                     out);
}

/* ---- points ---- */

static enum dt_status within(const struct dt *t, const struct region *r,
                             const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    enum dt_status s = dt_readable(t);
    if (s != DT_OK || t->mesh.vertices == 0)
        return s;
    bool scan = false;
    size_t n = out->n;
    if (!r->disc && dt_mesh_is_line(&t->mesh) && t->mesh.vertices > 1)
        s = walk_box(t, &r->box, &work, out);
    else
        s = flood(t, r, &work, out, NULL, &scan);
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
    return within(t, &(struct region){.disc = true, .centre = centre, .radius = r}, opt, out);
}

/* ---- the triangles that meet a box ---- */

bool dt_triangle_meets(const struct dt_point p[3], struct dt_point lo, struct dt_point hi)
{
    struct dt_box b = {lo, hi}, around = dt_box_of(p, 3);
    return dt_box_overlaps(&around, &b) &&
           (meets(&b, p[0], p[1]) || meets(&b, p[1], p[2]) || meets(&b, p[2], p[0]) ||
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

/* Appends the corners of these triangles to *out, sorted, each once. */
static enum dt_status put_triangles(const struct dt *t, const struct dt_ids *triangles, bool cw,
                                    struct dt_ids *out)
{
    enum dt_status s = dt_ids_reserve(out, 3 * triangles->n);
    if (s != DT_OK || triangles->n == 0)
        return s;
    uint32_t *row = out->v + out->n, *to = row;
    for (size_t i = 0; i < triangles->n; i++, to += 3)
        dt_triangle_ids(t, triangles->v[i], cw, to);
    qsort(row, triangles->n, 3 * sizeof *row, dt_triangle_compare);
    for (to = row + 3, out->n += 3; to < row + 3 * triangles->n; to += 3) {
        if (dt_triangle_compare(to, to - 3) != 0) {
            memmove(out->v + out->n, to, 3 * sizeof *to);
            out->n += 3;
        }
    }
    return DT_OK;
}

enum dt_status dt_within_triangles(const struct dt *t, struct dt_point lo, struct dt_point hi,
                                   bool cw, const struct dt_options *opt, struct dt_ids *out)
{
    struct dt_stop work = dt_stop_of(opt);
    struct dt_box b = {lo, hi};
    struct dt_ids vertices = {0}, triangles = {0};
    bool scan;
    enum dt_status s = dt_readable(t);
    if (s != DT_OK || dt_mesh_is_line(&t->mesh) || lo.x > hi.x || lo.y > hi.y)
        return s;
    s = flood(t, &(struct region){.box = b}, &work, &vertices, &triangles, &scan);
    if (s == DT_OK && scan) {
        triangles.n = 0;
        s = scan_triangles(t, &b, &work, &triangles);
    }
    if (s == DT_OK)
        s = put_triangles(t, &triangles, cw, out);
    free(vertices.v);
    free(triangles.v);
    return s;
}
