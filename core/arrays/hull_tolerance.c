/* hull_tolerance.c - places that rounding has put outside the hull. A place on an edge of the hull can rarely be expressed in doubles, so
 * half of those that a caller computes there are outside.
 *
 * The distance of a place from the hull is at least its distance from the line of any hull edge that it sees. So the first
 * edge identifies most places that are outside. From that edge the search goes along the hull towards the place. */
#include "core/arrays/arrays.h"

#include <math.h>

#include "core/mesh/hull.h"

/* A hull edge from a to b, which has the hull on its left, as a place sees it. */
struct seen {
    uint32_t inner; /* its half edge within the hull */
    double length;
    double beyond; /* how far the place is on the outer side of its line */
    double along;  /* where the place is along that line: 0 at a, `length` at b */
};

static struct seen see_edge(const struct dt *t, uint32_t ghost, struct dt_point q)
{
    const struct dt_point *xy = t->points.xy;
    uint32_t h = dt_twin(&t->mesh, ghost);
    struct dt_point a = xy[dt_origin(&t->mesh, h)], b = xy[dt_dest(&t->mesh, h)];
    double length = hypot(b.x - a.x, b.y - a.y);
    double x = (b.x - a.x) / length, y = (b.y - a.y) / length;
    return (struct seen){.inner = h,
                         .length = length,
                         .beyond = (q.x - a.x) * y - (q.y - a.y) * x,
                         .along = (q.x - a.x) * x + (q.y - a.y) * y};
}

uint32_t dt_beside_hull(const struct dt_arrays *a, struct dt_point q, uint32_t half, double tol,
                        double *along)
{
    const struct dt_mesh *m = &a->t->mesh;
    uint32_t ghost = dt_base(half);
    double limit = tol * a->size;
    bool back = false;
    for (uint32_t left = m->ghosts; tol > 0 && left > 0; left--) {
        struct seen e = see_edge(a->t, ghost, q);
        if (!(e.beyond <= limit))
            return DT_NONE;
        if (e.along >= -limit && e.along <= e.length + limit) {
            *along = fmin(fmax(e.along / e.length, 0), 1);
            return e.inner;
        }
        if (left < m->ghosts && back != (e.along < 0))
            return DT_NONE; /* nearest to it is a corner, which is too far away */
        back = e.along < 0;
        ghost = dt_hull_step(m, ghost, back);
    }
    return DT_NONE;
}
