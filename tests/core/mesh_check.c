/* mesh_check.c - see mesh_check.h. */
#include "tests/core/mesh_check.h"

#include "core/exact/predicates.h"
#include "core/mesh/hull.h"
#include "tests/test.h"

/* Mutual twins that agree on their ends, and locally Delaunay. */
static void check_half_edge(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h)
{
    uint32_t w = dt_twin(m, h);
    CHECK((w & 7) < 3 && w < 8 * m->tri_end && !dt_is_dead(m, w));
    CHECK(dt_twin(m, w) == h && dt_origin(m, w) == dt_dest(m, h) &&
          dt_origin(m, h) == dt_dest(m, w));
    if (dt_is_ghost(m, h) || dt_is_ghost(m, w))
        return;
    struct dt_point apex = xy[dt_apex_of(m, h)], beyond = xy[dt_apex_of(m, w)];
    CHECK(dt_incircle_perturbed(xy[dt_origin(m, h)], xy[dt_dest(m, h)], apex, beyond) < 0);
}

/* A real triangle turns left; a ghost and the next one do not turn outwards. Returns whether it is
 * a ghost. */
static bool check_triangle(const struct dt_mesh *m, const struct dt_point *xy, uint32_t t)
{
    uint32_t u = m->half[t], v = m->half[t + 1], w = m->half[t + 2];
    for (uint32_t k = 0; k < 3; k++)
        check_half_edge(m, xy, t + k);
    if (w != DT_NONE) {
        CHECK(dt_orient2d(xy[u], xy[v], xy[w]) > 0);
        return false;
    }
    uint32_t next =
        m->half[dt_twin(m, t + 1) - 1]; /* the ghost u->v is followed by v->next, clockwise */
    CHECK(dt_orient2d(xy[u], xy[v], xy[next]) <= 0);
    return true;
}

static uint32_t count_vertices(const struct dt_mesh *m)
{
    uint32_t n = 0, hull = 0;
    for (uint32_t v = 0; v < m->vert_cap; v++) {
        uint32_t h = m->leaving[v];
        if (h == DT_NONE)
            continue;
        CHECK((h & 7) < 3 && h < 8 * m->tri_end && !dt_is_dead(m, h) && dt_origin(m, h) == v);
        hull += dt_dest(m, h) == DT_NONE;
        n++;
    }
    CHECK_MSG(hull == dt_mesh_hull(m), "%u vertices leave to infinity, %u are on the hull", hull,
              dt_mesh_hull(m));
    return n;
}

void mesh_check(const struct dt_mesh *m, const struct dt_point *xy)
{
    uint32_t live = 0, ghosts = 0;
    for (uint32_t t = 0; t < m->tri_end; t++) {
        if (dt_is_dead(m, 8 * t))
            continue;
        live++;
        ghosts += check_triangle(m, xy, 8 * t);
    }
    CHECK(m->tri_end - m->dead == live && ghosts == m->ghosts);
    CHECK(live == (m->vertices < 2 ? 0 : 2 * m->vertices - 2));
    if (m->vertices < 2)
        return;
    CHECK(count_vertices(m) == m->vertices);
    CHECK(!dt_is_dead(m, m->hull) && (m->hull & 7) == 0 && dt_is_ghost(m, m->hull));
}
