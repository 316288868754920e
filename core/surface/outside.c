/* outside.c - values outside the hull: the value at the nearest place of the hull.
 *
 *          q                A convex hull has one place that is nearest to q: its foot. Along the edges that q sees,
 *          .                the distance falls up to the foot and then grows. So a walk from one of these edges goes
 *          .   foot         back where the foot of its line is before the edge, and on where it is behind; it
 *     a ---+---- b          ends on an edge, or at a corner from which both directions lead away. Each decision is
 *    /            \         the sign of a dot product, and exact. On a line, the walk goes along one side; the edge
 *                           back begins at the end. */
#include "core/exact/predicates.h"
#include "core/mesh/hull.h"
#include "core/surface/value.h"

/* The edge of a ghost, counterclockwise along the hull. */
struct edge {
    struct dt_point a, b;
};

static struct edge edge_of(const struct dt *t, uint32_t ghost)
{
    const struct dt_point *xy = t->points.xy;
    return (struct edge){xy[dt_hull_vertex(&t->mesh, ghost)],
                         xy[dt_hull_successor(&t->mesh, ghost)]};
}

/* ---- the last edge, in doubles ---- */

/* Values are linear along the edge of the ghost, from the end with the smaller id. */
static void use_edge(struct dt_valuer *v, uint32_t ghost)
{
    struct dt_foot_edge *e = &v->edge;
    const struct dt_points *p = &v->t->points;
    uint32_t u = dt_hull_vertex(&v->t->mesh, ghost), w = dt_hull_successor(&v->t->mesh, ghost);
    bool back = p->id[w] < p->id[u];
    struct dt_point a = p->xy[back ? w : u], b = p->xy[back ? u : w];
    double z0 = dt_value_of(v, back ? w : u), z1 = dt_value_of(v, back ? u : w);
    e->ghost = ghost;
    e->a = a;
    e->to = (struct dt_point){b.x - a.x, b.y - a.y};
    e->out = back ? -1 : 1;
    e->square = e->to.x * e->to.x + e->to.y * e->to.y;
    e->least = z0 < z1 ? z0 : z1;
    e->most = z0 < z1 ? z1 : z0;
    e->first = z0;
    e->rise = z1 - z0;
    double largest = fmax(-e->least, e->most);
    e->plain = largest >= DT_MEAN_LEAST && largest <= DT_MEAN_MOST;
}

bool dt_foot_value(struct dt_valuer *v, struct dt_point q, uint32_t ghost, double *out)
{
    struct dt_foot_edge *e = &v->edge;
    if (e->ghost != ghost)
        use_edge(v, ghost);
    double dx = q.x - e->a.x, dy = q.y - e->a.y;
    double x = dx * e->to.x, y = dy * e->to.y, size = fabs(x) + fabs(y);
    double left = e->to.x * dy, right = e->to.y * dx, along = (x + y) / e->square;
    bool sees = e->out * (right - left) > DT_ORIENT_BOUND * (fabs(left) + fabs(right));
    bool is_near = size <= DT_FOOT_NEAR * e->square;
    if (!(e->plain && sees && is_near && along > DT_FOOT_ERROR && along < 1 - DT_FOOT_ERROR))
        return false;
    double value = e->first + along * e->rise;
    *out = value < e->least ? e->least : value > e->most ? e->most : value;
    return true;
}

/* ---- from edge to edge ---- */

bool dt_foot_sees(const struct dt *t, uint32_t ghost, struct dt_point q)
{
    struct edge e = edge_of(t, ghost);
    return dt_orient2d(e.a, e.b, q) < 0;
}

enum dt_status dt_foot_find(struct dt_valuer *v, struct dt_point q, uint32_t *ghost, bool *corner)
{
    const struct dt_mesh *m = &v->t->mesh;
    uint32_t steps = 0;
    *corner = false;
    for (uint32_t g = *ghost;;) {
        struct edge e = edge_of(v->t, g);
        bool before = dt_dot(e.a, e.b, q) <= 0, behind = !before && dt_dot(e.b, e.a, q) <= 0;
        *ghost = g;
        if (!before && !behind)
            return DT_OK;
        g = dt_hull_step(m, g, before);
        e = edge_of(v->t, g);
        *corner = before ? dt_dot(e.b, e.a, q) <= 0 : dt_dot(e.a, e.b, q) <= 0;
        if (*corner) {
            *ghost = before ? *ghost : g;
            return DT_OK;
        }
        enum dt_status s = (++steps & DT_WORK_MASK) == 0 ? dt_work(&v->work, DT_WORK_BLOCK) : DT_OK;
        if (s != DT_OK)
            return s;
    }
}
