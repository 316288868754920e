/* insert.c - insertion by cavity [Bowyer 1981; Watson 1981], exact and with ties broken as
 * everywhere.
 *
 * All triangles in conflict with the new vertex q are replaced by the star of q:
 *
 *        +-------+                +-------+
 *       / \     / \              / \  .  / \        a real triangle is in conflict if its circle
 *      /   \   /   \            /   . . .   \       has q inside,
 *     +-----\-/-----+    ->    + . . .q. . . +
 *      \   q \     /            \   . . .   /       a ghost if q lies beyond its hull edge, or on
 *       \  /  \   /              \  . . .  /        it between its ends
 *        +------+                 +-------+
 *
 * In the lifted, perturbed picture the conflicts are the faces of a convex surface that q sees. So
 * they are a disc, and the star is again the canonical triangulation. This also holds on the hull and for
 * points on one line. */
#include "core/edit/insert.h"

#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/fixed.h"
#include "core/mesh/hull.h"

/* Whether q lies strictly between a and b on their line. */
static bool between(struct dt_point a, struct dt_point b, struct dt_point q)
{
    return dt_compare_xy(a, q) == dt_compare_xy(q, b);
}

bool dt_conflict(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t, struct dt_point q)
{
    struct dt_point a = xy[m->half[t]], b = xy[m->half[t + 1]];
    if (m->half[t + 2] != DT_NONE)
        return dt_incircle_perturbed(a, b, xy[m->half[t + 2]], q) > 0;
    int side = dt_orient2d(a, b, q);
    return side > 0 || (side == 0 && between(a, b, q));
}

bool dt_is_certain_conflict(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h,
                            struct dt_point q)
{
    const uint32_t *corner = m->half + dt_base(h);
    if (corner[2] == DT_NONE)
        return false;
    double size, det = dt_incircle_rounded(xy[corner[0]], xy[corner[1]], xy[corner[2]], q, &size);
    return det > DT_CLOSE_DET_BOUND * size;
}

/* Vertex v as q sees it. */
static inline struct dt_lifted see(const struct dt_point *xy, uint32_t v, struct dt_point q)
{
    return v == DT_NONE ? dt_lifted_infinity : dt_lift(xy[v], q);
}

/* Prefetches the triangle beyond e.h, and pushes e, which is to be crossed. */
static inline void push(const struct dt_mesh *m, struct dt_cavity *c, struct dt_crossing e)
{
    dt_fetch(&m->half[dt_twin(m, e.h)]);
    c->stack[c->stacked++] = e;
}

/* The hole grows through its edges, counterclockwise, so that the rim comes in that order. The triangle beyond an edge
 * has one more vertex w; with it the edge, seen from q, makes two edges more:
 *
 *              w
 *             / \            The sign of the determinant of a, b and w, lifted, decides whether the triangle is in
 *            /   \           conflict. Two of its three cross products are those of the new edges, a-w and w-b;
 *           b --- a          the third has been computed when a-b was such an edge.
 *              q
 *
 * has_fixed: it does not grow through fixed edges, but through that on which q lies. */
static inline enum dt_status find_cavity(const struct dt_mesh *m, const struct dt_point *xy,
                                         uint32_t t, struct dt_point q, struct dt_cavity *c,
                                         bool has_fixed)
{
    enum dt_status status = DT_OK;
    uint32_t steps = 0;
    dt_cavity_begin(c);
    if (!dt_cavity_add(c, t))
        return DT_NOMEM;
    struct dt_lifted first = see(xy, m->half[t], q), second = see(xy, m->half[t + 1], q);
    struct dt_lifted a = see(xy, m->half[t + 2], q);
    push(m, c, (struct dt_crossing){a, dt_lifted_cross(second, a), t + 1});
    push(m, c, (struct dt_crossing){second, dt_lifted_cross(first, second), t});
    struct dt_crossing e = {first, dt_lifted_cross(a, first), t + 2};
    for (;;) {
        if ((++steps & DT_WORK_MASK) == 0 && (status = dt_work(c->work, DT_WORK_BLOCK)) != DT_OK)
            return status;
        uint32_t beyond = dt_twin(m, e.h);
        struct dt_lifted w = see(xy, dt_apex_of(m, beyond), q);
        double aw = dt_lifted_cross(a, w), wb = dt_lifted_cross(w, e.end);
        double bound, det = dt_lifted_det(a, w, e.end, aw, wb, -e.cross, &bound);
        bool conflict = fabs(det) > bound ? det > 0 : dt_conflict(m, xy, dt_base(beyond), q);
        if (has_fixed && dt_is_fixed(m, e.h) && e.h != c->split)
            conflict = false;
        if (conflict) {
            if (!dt_cavity_add(c, dt_base(beyond)))
                return DT_NOMEM;
            push(m, c, (struct dt_crossing){e.end, wb, dt_prev(beyond)});
            e = (struct dt_crossing){w, aw, dt_next(beyond)};
            continue;
        }
        dt_fetch(&m->leaving[dt_origin(m, e.h)]); /* for dt_hull_keep */
        dt_cavity_add_rim(c, dt_origin(m, e.h), beyond);
        if (c->stacked == 0)
            return dt_work(c->work, steps & DT_WORK_MASK);
        a = e.end;
        e = c->stack[--c->stacked];
    }
}

enum dt_status dt_find_cavity(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t,
                              struct dt_point q, struct dt_cavity *c)
{
    struct dt_cavity hole = *c; /* a copy, which stays in registers */
    enum dt_status status = m->fixed == NULL ? find_cavity(m, xy, t, q, &hole, false)
                                             : find_cavity(m, xy, t, q, &hole, true);
    *c = hole;
    return status;
}

/* Makes record t the triangle of the rim edge from `origin` to `end` and v; returns its half edge
 * on the rim. */
static uint32_t set_star_triangle(struct dt_mesh *m, uint32_t t, uint32_t origin, uint32_t end,
                                  uint32_t v)
{
    if (origin == DT_NONE) {
        dt_set_corners(m, t, end, v, DT_NONE);
        return t + 2;
    }
    if (end == DT_NONE) {
        dt_set_corners(m, t, v, origin, DT_NONE);
        return t + 1;
    }
    dt_set_corners(m, t, origin, end, v);
    return t;
}

/* The star of v inside the hull, clockwise. */
static void fill_inside(struct dt_mesh *m, const struct dt_cavity *c, uint32_t v)
{
    uint32_t after = c->record[0], end = c->rim[0].origin;
    for (uint32_t i = c->rims; i-- > 0;) {
        uint32_t t = c->record[i], origin = c->rim[i].origin;
        dt_set_corners(m, t, origin, end, v);
        dt_link(m, t, c->rim[i].beyond);
        dt_link(m, t + 1, after + 2);
        dt_hull_keep(m, origin, t);
        after = t;
        end = origin;
    }
    m->leaving[v] = after + 2;
}

/* The star of v with ghosts. */
static void fill_at_hull(struct dt_mesh *m, const struct dt_cavity *c, uint32_t v)
{
    uint32_t first = 0, last = 0;
    bool on_hull = false;
    for (uint32_t i = 0; i < c->rims; i++) {
        uint32_t origin = c->rim[i].origin, end = c->rim[i + 1 < c->rims ? i + 1 : 0].origin;
        uint32_t h = set_star_triangle(m, c->record[i], origin, end, v);
        dt_link(m, h, c->rim[i].beyond);
        if (i == 0)
            first = h;
        else
            dt_link(m, dt_next(last), dt_prev(h));
        last = h;
    }
    dt_link(m, dt_next(last), dt_prev(first));

    for (uint32_t i = 0; i < c->rims; i++) {
        uint32_t t = c->record[i], h = dt_twin(m, c->rim[i].beyond), u = c->rim[i].origin;
        if (u != DT_NONE)
            dt_hull_keep(m, u, h);
        if (m->half[t + 2] == DT_NONE) {
            m->ghosts++;
            m->hull = t;
            on_hull |= m->half[t + 1] == v;
        }
        if (m->half[t + 2] == DT_NONE && m->half[t + 1] == v)
            m->leaving[v] = t + 1;
    }
    if (!on_hull)
        m->leaving[v] = dt_prev(first);
}

/* The star of v has replaced the cavity, which was of one face: the edges of the rim are fixed as they were; the spokes
 * are not. */
static void carry_fixed(struct dt_mesh *m, const struct dt_cavity *c)
{
    uint32_t face = dt_face(m, c->record[0]);
    for (uint32_t i = 0; i < c->rims; i++)
        dt_face_begin(m, c->record[i], face);
    dt_keep_rim_fixed(m, c);
}

/* The spoke of v to a corner u of the rim becomes fixed. The triangles from that spoke to the corner w get the face. */
static void fix_spoke(struct dt_mesh *m, const struct dt_cavity *c, uint32_t u, uint32_t covers,
                      uint32_t w, uint32_t face)
{
    uint32_t i = 0;
    while (c->rim[i].origin != u)
        i++;
    dt_fix(m, dt_prev(dt_twin(m, c->rim[i].beyond)), covers);
    for (; c->rim[i].origin != w; i = i + 1 < c->rims ? i + 1 : 0)
        dt_face_set(m, c->record[i], face);
}

/* Replaces the triangles of the cavity, and two records more, by the star of v. */
static void fill_with_star(struct dt_mesh *m, struct dt_cavity *c, uint32_t v)
{
    for (uint32_t i = 0; c->open && i < c->records; i++)
        m->ghosts -= m->half[c->record[i] + 2] == DT_NONE;
    while (c->records < c->rims)
        c->record[c->records++] = dt_mesh_take(m);
    if (c->open)
        fill_at_hull(m, c, v);
    else
        fill_inside(m, c, v);
    if (m->fixed != NULL)
        carry_fixed(m, c);
    m->vertices++;
}

/* The first edge: a and b, a ghost on either side. */
static void insert_second(struct dt_mesh *m, uint32_t a, uint32_t b)
{
    uint32_t g = dt_mesh_take(m), h = dt_mesh_take(m);
    m->half[g + 3] = m->half[h + 3] = 0;
    dt_set_corners(m, g, a, b, DT_NONE);
    dt_set_corners(m, h, b, a, DT_NONE);
    dt_link(m, g, h);
    dt_link(m, g + 1, h + 2);
    dt_link(m, g + 2, h + 1);
    m->leaving[b] = g + 1;
    m->leaving[a] = h + 1;
    m->hull = g;
    m->ghosts = m->vertices = 2;
}

/* v continues a line beyond its end e, corner 0 of the ghost `half`: an edge and two ghosts more.
 *
 *        infinity                    infinity
 *      ---- f ---- e        ->     ---- f ---- e ---- v          above: ghosts (v, e), (e, f), ...
 *        infinity                    infinity                    below: ghosts (f, e), (e, v) */
static void extend_line(struct dt_mesh *m, uint32_t half, uint32_t v,
                        const struct dt_changes *changes)
{
    uint32_t above = dt_base(half), e = m->half[above], below = dt_base(dt_twin(m, above));
    dt_changes_star(changes, e);
    uint32_t in = dt_mesh_take(m), out = dt_mesh_take(m);
    m->half[in + 3] = m->half[out + 3] = 0;
    dt_set_corners(m, in, v, e, DT_NONE);
    dt_set_corners(m, out, e, v, DT_NONE);
    dt_link(m, in, out);
    dt_link(m, in + 1, above + 2);
    dt_link(m, in + 2, out + 1);
    dt_link(m, out + 2, below + 1);
    m->leaving[v] = out + 1;
    m->leaving[e] = in + 1;
    m->ghosts += 2;
    m->vertices++;
}

/* v splits the edge a-b of a line: (a, b) and (b, a) become (a, v), (v, b) and (b, v), (v, a). */
static void split_line(struct dt_mesh *m, uint32_t half, uint32_t v,
                       const struct dt_changes *changes)
{
    uint32_t there = dt_base(half), back = dt_base(dt_twin(m, there));
    uint32_t a = m->half[there], b = m->half[back];
    dt_changes_star(changes, a);
    dt_changes_star(changes, b);
    uint32_t covers = dt_fixed_count(m, there);
    if (covers > 0)
        dt_unfix(m, there, covers);
    uint32_t there_on = dt_mesh_take(m), back_on = dt_mesh_take(m);
    m->half[there_on + 3] = m->half[back_on + 3] = 0;
    dt_set_corners(m, there_on, v, b, DT_NONE);
    dt_set_corners(m, back_on, v, a, DT_NONE);
    dt_link(m, there_on + 1, dt_twin(m, there + 1));
    dt_link(m, back_on + 1, dt_twin(m, back + 1));
    m->half[there + 1] = m->half[back + 1] = v;
    dt_link(m, there, back_on);
    dt_link(m, there_on, back);
    dt_link(m, there + 1, there_on + 2);
    dt_link(m, back + 1, back_on + 2);
    if (covers > 0) {
        dt_fix(m, there, covers);
        dt_fix(m, there_on, covers);
    }
    m->leaving[v] = there + 1;
    m->leaving[b] = there_on + 1;
    m->leaving[a] = back_on + 1;
    m->ghosts += 2;
    m->vertices++;
}

/* Insertion among points on one line. */
static enum dt_status insert_in_line(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                     enum dt_where where, uint32_t half, struct dt_cavity *c)
{
    uint32_t g = dt_base(half);
    int side = dt_orient2d(xy[m->half[g]], xy[m->half[g + 1]], xy[v]);
    if (side == 0) {
        if (where == DT_ON_EDGE)
            split_line(m, half, v, c->changes);
        else
            extend_line(m, half, v, c->changes);
        return DT_OK;
    }
    if (side < 0)
        g = dt_base(dt_twin(m, g));
    enum dt_status status = dt_find_cavity(m, xy, g, xy[v], c);
    if (status != DT_OK)
        return status;
    dt_cavity_report(c);
    fill_with_star(m, c, v);
    dt_hull_settle(m, m->hull, NULL); /* the line's vertices lost the ghosts on one side */
    return DT_OK;
}

/* v splits the fixed edge of half: constraints that cover it cover both parts. */
static void split_fixed(struct dt_mesh *m, uint32_t half, uint32_t v, struct dt_cavity *c)
{
    uint32_t a = dt_origin(m, half), b = dt_dest(m, half), covers = dt_fixed_count(m, half);
    uint32_t left = dt_face(m, half), right = dt_face(m, dt_twin(m, half));
    dt_unfix(m, half, covers);
    fill_with_star(m, c, v);
    fix_spoke(m, c, a, covers, b, right);
    fix_spoke(m, c, b, covers, a, left);
}

enum dt_status dt_insert(struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                         enum dt_where where, uint32_t half, struct dt_cavity *scratch)
{
    if (dt_mesh_make_room(m, v, 2) != DT_OK ||
        (m->fixed != NULL && dt_fixed_reserve(m, 2) != DT_OK))
        return DT_NOMEM;
    if (m->vertices == 0) {
        m->leaving[v] = DT_NONE;
        m->alone = v;
        m->vertices = 1;
        return DT_OK;
    }
    if (m->vertices == 1) {
        dt_changes_star(scratch->changes, half);
        insert_second(m, half, v);
        return DT_OK;
    }
    scratch->split = DT_NONE;
    if (dt_mesh_is_line(m))
        return insert_in_line(m, xy, v, where, half, scratch);
    bool splits = where == DT_ON_EDGE && dt_is_fixed(m, half);
    scratch->split = splits ? half : DT_NONE;
    enum dt_status status = dt_find_cavity(m, xy, dt_base(half), xy[v], scratch);
    if (status != DT_OK)
        return status;
    dt_cavity_report(scratch);
    if (splits)
        split_fixed(m, half, v, scratch);
    else
        fill_with_star(m, scratch, v);
    return DT_OK;
}

void dt_insert_found(struct dt_mesh *m, uint32_t v, struct dt_cavity *c)
{
    dt_cavity_report(c);
    fill_with_star(m, c, v);
}
