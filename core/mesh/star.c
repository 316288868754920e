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

void dt_ring_turn(uint32_t *ring, uint32_t n, bool on_hull, bool cw)
{
    if (cw)
        reverse(ring, n);
    if (on_hull)
        return;
    uint32_t least = 0;
    for (uint32_t i = 1; i < n; i++)
        if (ring[i] < ring[least])
            least = i;
    if (least == 0)
        return;
    reverse(ring, least);
    reverse(ring + least, n - least);
    reverse(ring, n);
}
