/* star.c - walks around a vertex; see star.h. */
#include "core/mesh/star.h"

#include "core/mesh/hull.h"

uint32_t dt_star_degree(const struct dt_mesh *m, uint32_t v, uint32_t limit)
{
    uint32_t h = m->leaving[v], degree = 0;
    if (h == DT_NONE)
        return 0;
    do {
        degree += dt_dest(m, h) != DT_NONE;
        h = dt_turn_ccw(m, h);
    } while (degree < limit && h != m->leaving[v]);
    return degree;
}

uint32_t dt_edge_between(const struct dt_mesh *m, uint32_t u, uint32_t v)
{
    uint32_t from_u = m->leaving[u], from_v = m->leaving[v];
    if (from_u == DT_NONE || from_v == DT_NONE || u == v)
        return DT_NONE;
    do {
        if (dt_dest(m, from_u) == v)
            return from_u;
        if (dt_dest(m, from_v) == u)
            return dt_twin(m, from_v);
        from_u = dt_turn_ccw(m, from_u);
        from_v = dt_turn_ccw(m, from_v);
    } while (from_u != m->leaving[u] && from_v != m->leaving[v]);
    return DT_NONE;
}

uint32_t dt_star_ring(const struct dt_mesh *m, const uint32_t *id, uint32_t v, uint32_t *ring,
                      size_t room)
{
    uint32_t h = m->leaving[v], degree = 0;
    if (h == DT_NONE)
        return 0;
    do {
        uint32_t d = dt_dest(m, h);
        if (d != DT_NONE && degree == room)
            return DT_NONE;
        if (d != DT_NONE)
            ring[degree++] = id[d];
        h = dt_turn_ccw(m, h);
    } while (h != m->leaving[v]);
    return degree;
}

/* Whether on the hull, then the ring. */
void dt_star_save(const struct dt_mesh *m, const uint32_t *id, uint32_t v, uint32_t *image)
{
    image[0] = dt_on_hull(m, v);
    dt_star_ring(m, id, v, image + 1, DT_NONE);
}

static void reverse(uint32_t *v, uint32_t n)
{
    for (uint32_t i = 0; i < n / 2; i++) {
        uint32_t swap = v[i];
        v[i] = v[n - 1 - i];
        v[n - 1 - i] = swap;
    }
}

/* Its value and its index are compared as one number, so that no branch depends on the order of the ids. */
static uint32_t index_of_least(const uint32_t *v, uint32_t n)
{
    uint64_t least = (uint64_t)DT_NONE << 32;
    for (uint32_t i = 0; i < n; i++) {
        uint64_t here = (uint64_t)v[i] << 32 | i;
        least = here < least ? here : least;
    }
    return (uint32_t)least;
}

void dt_ring_turn(uint32_t *ring, uint32_t n, bool on_hull, bool cw)
{
    if (cw)
        reverse(ring, n);
    if (on_hull)
        return;
    uint32_t least = index_of_least(ring, n);
    reverse(ring, least);
    reverse(ring + least, n - least);
    reverse(ring, n);
}

void dt_ring_copy(uint32_t *to, const uint32_t *ring, uint32_t n, bool cw)
{
    uint32_t at = index_of_least(ring, n);
    for (uint32_t i = 0; i < n; i++) {
        to[i] = ring[at];
        if (cw)
            at = (at == 0 ? n : at) - 1;
        else
            at = at + 1 == n ? 0 : at + 1;
    }
}
