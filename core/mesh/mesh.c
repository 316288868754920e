/* mesh.c - storage and counts of the half-edge mesh; the structure itself is drawn in mesh.h. */
#include "core/mesh/mesh.h"

#include <stdlib.h>

void dt_fixed_end(struct dt_mesh *m)
{
    if (m->fixed != NULL)
        dt_array_free(m->fixed->more);
    free(m->fixed);
    m->fixed = NULL;
}

static size_t fixed_memory(const struct dt_mesh *m)
{
    return m->fixed == NULL ? 0 : sizeof *m->fixed + m->fixed->cap * sizeof *m->fixed->more;
}

void dt_mesh_clear(struct dt_mesh *m)
{
    dt_array_free(m->half);
    dt_array_free(m->leaving);
    dt_fixed_end(m);
    *m = (struct dt_mesh){.pages = m->pages, .free_list = DT_NONE, .hull = DT_NONE};
}

size_t dt_mesh_memory(const struct dt_mesh *m)
{
    return ((size_t)m->tri_cap * 8 + m->vert_cap) * sizeof(uint32_t) + fixed_memory(m);
}

enum dt_status dt_mesh_reserve(struct dt_mesh *m, uint32_t verts, uint32_t tris)
{
    if (verts > m->vert_cap) {
        if (!dt_array_resize(m->pages, &m->leaving, m->vert_cap, verts, sizeof *m->leaving))
            return DT_NOMEM;
        m->vert_cap = verts;
    }
    if (tris > m->tri_cap) {
        if (!dt_array_resize(m->pages, &m->half, (size_t)m->tri_end * 8, (size_t)tris * 8,
                             sizeof *m->half))
            return DT_NOMEM;
        m->tri_cap = tris;
    }
    return DT_OK;
}

enum dt_status dt_mesh_make_room(struct dt_mesh *m, uint32_t v, uint32_t tris)
{
    uint32_t verts = m->vert_cap, end = m->tri_end + (tris > m->dead ? tris - m->dead : 0);
    if (v < verts && end <= m->tri_cap)
        return DT_OK;
    if (v >= verts)
        verts = (uint32_t)dt_array_room(verts, (size_t)v + 1, DT_MAX_POINTS);
    uint32_t known = m->vert_cap;
    uint32_t want =
        end > m->tri_cap ? (uint32_t)dt_array_room(m->tri_cap, end, 2 * DT_MAX_POINTS) : m->tri_cap;
    enum dt_status status = dt_mesh_reserve(m, verts, want);
    for (; known < m->vert_cap; known++) /* it may have grown in spite of a failure */
        m->leaving[known] = DT_NONE;
    return status;
}

bool dt_mesh_is_line(const struct dt_mesh *m)
{
    return m->vertices < 3 || m->ghosts == 2 * m->vertices - 2;
}

uint32_t dt_mesh_triangles(const struct dt_mesh *m)
{
    return m->vertices < 2 ? 0 : 2 * m->vertices - 2 - m->ghosts;
}

uint32_t dt_mesh_edges(const struct dt_mesh *m)
{
    return m->vertices < 2 ? 0 : 3 * m->vertices - 3 - m->ghosts;
}

uint32_t dt_mesh_hull(const struct dt_mesh *m)
{
    return dt_mesh_is_line(m) ? m->vertices : m->ghosts;
}
