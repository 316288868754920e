/* local_move.c - a triangulation of which every triangle turns left and every edge is locally
 * Delaunay is the Delaunay triangulation, so it is enough to look at the triangles and edges that a
 * move touches: those of the star.
 *
 *        O ------- P
 *         \  .   . / \        h: v->P    triangle (v, P, Q)
 *          \   v  /   W       edge P-Q:  W outside the circle of v, P, Q
 *           \  . /   /        edge v-P:  O outside the same circle
 *            \  Q --'
 */
#include "core/local_move.h"

#include "core/hull.h"
#include "core/predicates.h"

enum dt_status dt_stays_delaunay(const struct dt_mesh *m, const struct dt_point *xy, uint32_t v,
                                 struct dt_point to, struct dt_work *work, bool *stays)
{
    enum dt_status status = DT_OK;
    *stays = false;
    if (dt_on_hull(m, v))
        return DT_OK;
    uint32_t first = m->leaving[v], h = first;
    struct dt_point before = xy[dt_dest(m, dt_turn_cw(m, h))];
    do {
        struct dt_point p = xy[dt_dest(m, h)], q = xy[dt_apex_of(m, h)];
        uint32_t beyond = dt_twin(m, dt_next(h));
        if (dt_orient2d(to, p, q) <= 0 || dt_incircle_perturbed(to, p, q, before) > 0)
            return DT_OK;
        if (!dt_is_ghost(m, beyond) &&
            dt_incircle_perturbed(to, p, q, xy[dt_apex_of(m, beyond)]) > 0)
            return DT_OK;
        before = p;
        h = dt_turn_ccw(m, h);
        status = dt_work(work, 1);
    } while (status == DT_OK && h != first);
    *stays = status == DT_OK;
    return status;
}
