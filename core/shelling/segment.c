/* segment.c - the min-max box of a circle segment and the cells it touches, rounded outward.
 *
 * Source: the paper, "Forming triangles", steps 2 to 7. Deviations: the box is around the segment
 * beyond the edge, not around the circle; cells are chosen line by line between two parallels instead
 * of by triangles of cells. */
#include "core/shelling/segment.h"

#include <math.h>

#include "core/exact/bounds.h"

/* The segment of cotangent s, where root = sqrt(1 + s^2). Let c be the circle's centre, r its radius, and e a direction
 * along an axis. The box reaches to the point c + r e if that point is left of the edge: d x (c + r e - a) > 0.
 * Otherwise the box reaches to an end of the edge. The pads exceed the rounding errors: first those relative to a,
 * then those of the sum with a. */
static struct dt_segment segment(const struct dt_edge *edge, double s, double root, double height)
{
    struct dt_point d = edge->d, a = edge->a;
    double size = edge->length * root, r = size / 2;
    double cx = (d.x - s * d.y) / 2, cy = (d.y + s * d.x) / 2;
    double left = s * edge->length + DT_SEGMENT_ROOM * size;
    double pad_x = DT_SEGMENT_PAD * size + 2 * DT_U * fabs(a.x),
           pad_y = DT_SEGMENT_PAD * size + 2 * DT_U * fabs(a.y);
    struct dt_segment g = {.s = s, .height = height * (1 + DT_SEGMENT_ROOM)};
    g.box.hi.x = a.x + ((left > d.y * root ? cx + r : dt_greater(d.x, 0)) + pad_x);
    g.box.lo.x = a.x + ((left > -d.y * root ? cx - r : dt_lesser(d.x, 0)) - pad_x);
    g.box.hi.y = a.y + ((left > -d.x * root ? cy + r : dt_greater(d.y, 0)) + pad_y);
    g.box.lo.y = a.y + ((left > d.x * root ? cy - r : dt_lesser(d.y, 0)) - pad_y);
    return g;
}

/* The circle has the radius height / 2 + length^2 / (8 height). */
struct dt_segment dt_segment_of_height(const struct dt_edge *e, double height)
{
    double rise = height / e->length, fall = e->length / height / 4;
    return segment(e, rise - fall, rise + fall, height);
}

struct dt_segment dt_segment_of_cotangent(const struct dt_edge *e, double s)
{
    double root = sqrt(1 + s * s), half = e->length / 2;
    return segment(e, s, root, s > 0 ? half * (root + s) : half / (root - s));
}

struct dt_segment dt_segment_all(const struct dt_edge *e)
{
    struct dt_point d = e->d, a = e->a;
    struct dt_segment g = {HUGE_VAL, HUGE_VAL, {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}}};
    if (d.x == 0 && d.y > 0)
        g.box.hi.x = a.x;
    if (d.x == 0 && d.y < 0)
        g.box.lo.x = a.x;
    if (d.y == 0 && d.x > 0)
        g.box.lo.y = a.y;
    if (d.y == 0 && d.x < 0)
        g.box.hi.y = a.y;
    return g;
}

/* The coordinates u, v of a and every product with them are off by a few u of the terms that pad
 * sums up. */
static void set_strip(struct dt_window *w, const struct dt_edge *e, double height,
                      const struct dt_cells *c)
{
    double across = c->upright ? e->d.x : e->d.y;
    if (across == 0) {
        w->lo = -HUGE_VAL, w->hi = HUGE_VAL, w->slope = 0;
        return;
    }
    double inverse = 1 / across, slope = (c->upright ? e->d.y : e->d.x) * inverse;
    double u = dt_cells_along(c, e->a), v = dt_cells_across(c, e->a), at = u - v * slope;
    double width = height * c->per_unit * e->length * fabs(inverse);
    double pad = DT_STRIP_PAD * (fabs(u) + (fabs(v) + c->lines) * fabs(slope) + c->length);
    bool left_is_lower = (across > 0) != c->upright; /* upright lines see the mirror image */
    w->lo = at + dt_lesser(slope, 0) - pad - (left_is_lower ? width : 0);
    w->hi = at + dt_greater(slope, 0) + pad + (left_is_lower ? 0 : width);
    w->slope = slope;
}

bool dt_window_set(struct dt_window *w, const struct dt_edge *e, const struct dt_segment *g,
                   const struct dt_cells *c)
{
    double v0 = dt_cells_across(c, g->box.lo), v1 = dt_cells_across(c, g->box.hi);
    double u0 = dt_cells_along(c, g->box.lo), u1 = dt_cells_along(c, g->box.hi);
    w->first_line = dt_cell(v0, c->lines);
    w->last_line = dt_cell(v1, c->lines);
    w->first = dt_cell(u0, c->length);
    w->last = dt_cell(u1, c->length);
    set_strip(w, e, g->height, c);
    return v0 < c->lines && v1 >= 0 && u0 < c->length && u1 >= 0;
}

double dt_segment_reach(const struct dt_edge *e, const struct dt_segment *g,
                        const struct dt_cells *c)
{
    double along = c->side * c->length, across = c->side * c->lines;
    double x1 = dt_lesser(g->box.hi.x, c->lo.x + (c->upright ? across : along));
    double y1 = dt_lesser(g->box.hi.y, c->lo.y + (c->upright ? along : across));
    double x = dt_greater(x1 - e->a.x, e->a.x - dt_greater(g->box.lo.x, c->lo.x));
    double y = dt_greater(y1 - e->a.y, e->a.y - dt_greater(g->box.lo.y, c->lo.y));
    return (dt_greater(dt_greater(x, y), 0) + c->side + e->span) * (1 + DT_REACH_ROOM);
}
