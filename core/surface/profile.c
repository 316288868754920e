/* profile.c - a surface along a straight way: its ends, and where it crosses edges and runs through vertices.
 *
 * Exact signs decide which edges and vertices these are (core/constraints/march.h), so they depend on the triangulation and
 * the places alone. At every moment the walk is at a place of the request, at a vertex, or at an edge that the way crosses:
 *
 *              w                The edge is u->w, with the triangle from which the way comes on its left: u is to the right of
 *            / | \              the way and w to the left. Beyond the edge is the apex x. The way goes on through the
 *     p --- /--+--\---> q       vertex x, or crosses the edge between x and u or between x and w, or it ends at q before that.
 *           \  |  / x
 *            \ u /
 *
 * Numbers are computed from the two ends, the edge and its values, from the right end to the left one. */
#include "core/constraints/crossings.h"
#include "core/constraints/march.h"
#include "core/exact/predicates.h"
#include "core/mesh/hull.h"
#include "core/mesh/star.h"
#include "core/query/query.h"
#include "core/surface/value.h"
#include "core/triangle/cut.h"

#include <math.h>
#include <stdlib.h>

enum stage {
    AT_PLACE,  /* of the request: the first one, or the end of the piece */
    AT_VERTEX, /* on the piece, which the half edge leaves; DT_NONE: the only one */
    AT_EDGE,   /* which the piece crosses */
    ENDED
};

struct dt_profile {
    struct dt_valuer v;
    const struct dt_point *place; /* borrows `places` */
    size_t places, next;          /* the place at the end of the piece */
    enum stage stage;
    uint32_t half;            /* see the stages; AT_PLACE: near the place */
    struct dt_point p, q;     /* the ends of the piece */
    struct dt_double2 before; /* the length of the pieces before */
    struct dt_double2 length; /* of this one */
    double distance;          /* of the last row */
};

enum dt_status dt_profile_begin(const struct dt *t, const struct dt_surface *s,
                                const struct dt_point *place, size_t n,
                                const struct dt_options *opt, struct dt_profile **out)
{
    struct dt_profile *p = malloc(sizeof *p);
    *out = p;
    if (p == NULL)
        return DT_NOMEM;
    *p = (struct dt_profile){.place = place, .places = n, .half = DT_NONE};
    p->stage = n > 0 ? AT_PLACE : ENDED;
    enum dt_status status = dt_valuer_init(&p->v, t, s, opt);
    if (status != DT_OK) {
        dt_profile_free(p);
        *out = NULL;
    }
    return status;
}

void dt_profile_free(struct dt_profile *p)
{
    if (p == NULL)
        return;
    dt_valuer_clear(&p->v);
    free(p);
}

/* ---- the way ---- */

static const struct dt_mesh *mesh_of(const struct dt_profile *p)
{
    return &p->v.t->mesh;
}

static struct dt_point vertex_at(const struct dt_profile *p, uint32_t vertex)
{
    return p->v.t->points.xy[vertex];
}

static int side_of(const struct dt_profile *p, uint32_t vertex)
{
    return dt_orient2d(p->p, p->q, vertex_at(p, vertex));
}

static void come_to(struct dt_profile *p, enum stage stage, uint32_t half)
{
    p->stage = stage;
    p->half = half;
}

/* The way comes to the vertex that the half edge leaves, unless it ends before or at the vertex. */
static void come_to_vertex(struct dt_profile *p, uint32_t half)
{
    struct dt_point at = vertex_at(p, dt_origin(mesh_of(p), half));
    bool ends = dt_compare_xy(at, p->q) != dt_compare_xy(p->p, p->q);
    come_to(p, ends ? AT_PLACE : AT_VERTEX, half);
}

/* The way comes to the edge, which the line through it crosses, unless it ends before or on the edge. */
static void come_to_edge(struct dt_profile *p, uint32_t half)
{
    const struct dt_mesh *m = mesh_of(p);
    struct dt_point u = vertex_at(p, dt_origin(m, half)), w = vertex_at(p, dt_dest(m, half));
    come_to(p, dt_orient2d(u, w, p->q) >= 0 ? AT_PLACE : AT_EDGE, half);
}

/* Goes on into the triangle beyond the edge. */
static void cross(struct dt_profile *p, uint32_t half)
{
    const struct dt_mesh *m = mesh_of(p);
    uint32_t twin = dt_twin(m, half), apex = dt_apex_of(m, twin);
    if (apex == DT_NONE) {
        come_to(p, AT_PLACE, half);
        return;
    }
    int side = side_of(p, apex);
    if (side == 0)
        come_to_vertex(p, dt_prev(twin));
    else
        come_to_edge(p, dt_march_next(m, half, side));
}

/* Goes on from a vertex on the way. */
static enum dt_status leave_vertex(struct dt_profile *p, uint32_t half)
{
    const struct dt_mesh *m = mesh_of(p);
    struct dt_stop *work = &p->v.work;
    uint32_t next, most = dt_work_is_limited(work) ? (uint32_t)work->left : 0,
                   degree = most == 0 ? 0 : dt_star_degree(m, dt_origin(m, half), most);
    enum dt_status status = dt_work(work, degree);
    if (status != DT_OK)
        return status;
    switch (dt_march_begin(m, p->v.t->points.xy, half, p->q, &next)) {
    case DT_MARCH_ALONG:
        come_to_vertex(p, dt_twin(m, next));
        break;
    case DT_MARCH_CROSS:
        come_to_edge(p, next);
        break;
    case DT_MARCH_OUT:
        come_to(p, AT_PLACE, half);
        break;
    }
    return DT_OK;
}

/* Goes on from a place inside of the triangle. */
static void leave_triangle(struct dt_profile *p, uint32_t half)
{
    const struct dt_mesh *m = mesh_of(p);
    uint32_t base = dt_base(half);
    int side[3];
    for (uint32_t k = 0; k < 3; k++) {
        side[k] = side_of(p, dt_origin(m, base + k));
        struct dt_point corner = vertex_at(p, dt_origin(m, base + k));
        if (side[k] == 0 && dt_compare_xy(p->p, corner) == dt_compare_xy(p->p, p->q)) {
            come_to_vertex(p, base + k);
            return;
        }
    }
    for (uint32_t k = 0; k < 3; k++)
        if (side[k] < 0 && side[(k + 1) % 3] > 0) {
            come_to_edge(p, base + k);
            return;
        }
}

/* Goes on from a place on the edge. */
static void leave_edge(struct dt_profile *p, uint32_t half)
{
    const struct dt_mesh *m = mesh_of(p);
    uint32_t twin = dt_twin(m, half);
    struct dt_point u = vertex_at(p, dt_origin(m, half)), w = vertex_at(p, dt_dest(m, half));
    int side = dt_orient2d(u, w, p->q);
    if (side == 0)
        come_to_vertex(p, dt_compare_xy(p->p, w) == dt_compare_xy(p->p, p->q) ? twin : half);
    else
        cross(p, side > 0 ? twin : half);
}

/* ---- from outside ---- */

/* The way comes to a vertex of the hull on the line through it, or leads away from that. */
static void come_to_hull_vertex(struct dt_profile *p, uint32_t half)
{
    struct dt_point at = vertex_at(p, dt_origin(mesh_of(p), half));
    if (dt_compare_xy(p->p, at) == dt_compare_xy(p->p, p->q))
        come_to_vertex(p, half);
    else
        come_to(p, AT_PLACE, half);
}

/* Goes on from a place outside. The ghost lies beyond an edge a->b that the place sees, if it sees the ghost's side of it:
 *
 *        b <------- a        The edges of the hull that p sees are a chain. The way enters where one of them has a on its right
 *         ghost    /         and b on its left, or through a vertex on the way. If both are on its right, that is farther to
 *             p --           the left, beyond b. If a is on the left and b on the right, the way leads away from the hull. */
static enum dt_status enter(struct dt_profile *p, uint32_t ghost)
{
    const struct dt_mesh *m = mesh_of(p);
    enum dt_status status;
    int turned = 0; /* the direction of the search */
    for (uint32_t g = ghost; (status = dt_work(&p->v.work, 1)) == DT_OK;) {
        uint32_t a = dt_origin(m, g), b = dt_dest(m, g);
        bool visible = dt_orient2d(vertex_at(p, a), vertex_at(p, b), p->p) > 0;
        int right = -side_of(p, a), left = side_of(p, b);
        if (!visible || (right < 0 && left < 0))
            come_to(p, AT_PLACE, g);
        else if (right == 0 || left == 0)
            come_to_hull_vertex(p, right == 0 ? g : dt_next(g));
        else if (right > 0 && left > 0)
            come_to_edge(p, g);
        else if (turned == 0 || turned == left) {
            turned = left;
            g = dt_hull_step(m, g, left < 0);
            continue;
        } else
            come_to(p, AT_PLACE, g);
        return DT_OK;
    }
    return status;
}

/* The same if all points are on one line. If the way crosses that line, the search begins near the crossing. */
static enum dt_status enter_line(struct dt_profile *p, uint32_t ghost)
{
    const struct dt_mesh *m = mesh_of(p);
    struct dt_point a = vertex_at(p, dt_origin(m, ghost)), b = vertex_at(p, dt_dest(m, ghost));
    int p_side = dt_orient2d(a, b, p->p), q_side = dt_orient2d(a, b, p->q);
    if (p_side == 0 && q_side == 0) {
        come_to_hull_vertex(p, ghost); /* its corner 0 is the end next to p */
        return DT_OK;
    }
    if (p_side * q_side >= 0) {
        come_to(p, AT_PLACE, ghost);
        return DT_OK;
    }
    struct dt_point at = dt_crossing_place(&(struct dt_segment){.p = p->p, .q = p->q},
                                           &(struct dt_segment){.p = a, .q = b});
    dt_place_find(p->v.t, at, ghost, &ghost);
    ghost = dt_base(ghost);
    a = vertex_at(p, dt_origin(m, ghost));
    b = vertex_at(p, dt_dest(m, ghost));
    return enter(p, dt_orient2d(a, b, p->p) > 0 ? ghost : dt_base(dt_twin(m, ghost)));
}

/* The only vertex there is may be on the way. */
static void pass_alone(struct dt_profile *p)
{
    const struct dt_mesh *m = mesh_of(p);
    come_to(p, AT_PLACE, DT_NONE);
    if (m->vertices != 1)
        return;
    struct dt_point at = vertex_at(p, m->alone);
    int direction = dt_compare_xy(p->p, p->q);
    if (dt_orient2d(p->p, p->q, at) == 0 && dt_compare_xy(p->p, at) == direction &&
        dt_compare_xy(at, p->q) == direction)
        p->stage = AT_VERTEX;
}

/* Goes on from the first end of the piece. */
static enum dt_status set_out(struct dt_profile *p, enum dt_where where, uint32_t half)
{
    if (half == DT_NONE) {
        pass_alone(p);
        return DT_OK;
    }
    switch (where) {
    case DT_ON_VERTEX:
        return leave_vertex(p, half);
    case DT_ON_EDGE:
        leave_edge(p, half);
        return DT_OK;
    case DT_INSIDE:
        leave_triangle(p, half);
        return DT_OK;
    case DT_OUTSIDE:
        break;
    }
    return dt_mesh_is_line(mesh_of(p)) ? enter_line(p, half) : enter(p, half);
}

/* ---- rows ---- */

/* The length of the piece. */
static struct dt_double2 length_of(struct dt_point p, struct dt_point q)
{
    struct dt_double2 x = dt_double2_difference(q.x, p.x), y = dt_double2_difference(q.y, p.y);
    struct dt_double2 square = dt_double2_add(dt_double2_multiply(x, x), dt_double2_multiply(y, y));
    return square.hi == 0 ? square : dt_double2_root(square, sqrt(square.hi));
}

/* Rounding never makes it less than that of the row before. */
static double distance_at(struct dt_profile *p, struct dt_double2 on_piece)
{
    double distance = dt_double2_add(p->before, on_piece).hi;
    p->distance = distance > p->distance ? distance : p->distance;
    return p->distance;
}

/* The share of the piece that lies before a place on it. */
static struct dt_double2 share_at(const struct dt_profile *p, struct dt_point at)
{
    struct dt_double2 x = dt_double2_difference(p->q.x, p->p.x),
                      y = dt_double2_difference(p->q.y, p->p.y);
    return fabs(x.hi) >= fabs(y.hi) ? dt_double2_divide(dt_double2_difference(at.x, p->p.x), x)
                                    : dt_double2_divide(dt_double2_difference(at.y, p->p.y), y);
}

/* The end of the piece, and the beginning of the next one. */
static enum dt_status pass_place(struct dt_profile *p, struct dt_profile_row *row)
{
    struct dt_point at = p->place[p->next];
    uint32_t half;
    enum dt_where where = dt_place_find(p->v.t, at, p->half, &half);
    enum dt_status status = dt_value_there(&p->v, at, where, half, &row->value);
    if (status != DT_OK)
        return status;
    row->x = at.x;
    row->y = at.y;
    row->distance = distance_at(p, p->length);
    p->before = dt_double2_add(p->before, p->length);
    p->length = (struct dt_double2){0, 0};
    p->p = at;
    p->half = half;
    if (++p->next == p->places) {
        p->stage = ENDED;
        return DT_OK;
    }
    p->q = p->place[p->next];
    if (dt_compare_xy(p->p, p->q) == 0)
        return DT_OK;
    p->length = length_of(p->p, p->q);
    return set_out(p, where, half);
}

static enum dt_status pass_vertex(struct dt_profile *p, struct dt_profile_row *row)
{
    const struct dt_mesh *m = mesh_of(p);
    uint32_t half = p->half;
    struct dt_point at = vertex_at(p, half == DT_NONE ? m->alone : dt_origin(m, half));
    enum dt_status status = dt_value_there(&p->v, at, DT_ON_VERTEX, half, &row->value);
    if (status != DT_OK)
        return status;
    row->x = at.x;
    row->y = at.y;
    row->distance = distance_at(p, dt_double2_multiply(share_at(p, at), p->length));
    if (half != DT_NONE)
        return leave_vertex(p, half);
    come_to(p, AT_PLACE, half);
    return DT_OK;
}

static enum dt_status pass_edge(struct dt_profile *p, struct dt_profile_row *row)
{
    const struct dt_mesh *m = mesh_of(p);
    uint32_t half = p->half;
    struct dt_cut c =
        dt_cut_of(p->p, p->q, vertex_at(p, dt_origin(m, half)), vertex_at(p, dt_dest(m, half)));
    row->x = c.at.x;
    row->y = c.at.y;
    row->value = dt_value_along(&p->v, half, c.across);
    row->distance = distance_at(p, dt_double2_multiply(c.along, p->length));
    cross(p, half);
    return DT_OK;
}

static enum dt_status pass(struct dt_profile *p, struct dt_profile_row *row)
{
    enum { STEPS = 8 };
    enum dt_status status = dt_work(&p->v.work, STEPS);
    if (status != DT_OK)
        return status;
    switch (p->stage) {
    case AT_PLACE:
        return pass_place(p, row);
    case AT_VERTEX:
        return pass_vertex(p, row);
    case AT_EDGE:
        return pass_edge(p, row);
    case ENDED:
        break;
    }
    return DT_OK;
}

enum dt_status dt_profile_read(struct dt_profile *p, struct dt_profile_row *row, size_t room,
                               size_t *n)
{
    enum dt_status status = DT_OK;
    for (*n = 0; *n < room && p->stage != ENDED && status == DT_OK; *n += status == DT_OK)
        status = pass(p, &row[*n]);
    return status;
}
