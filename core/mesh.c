/* mesh.c - storage and counts of the half-edge mesh; the structure itself is drawn in mesh.h. */
#include "core/mesh.h"

#include <stdlib.h>

void dt_mesh_clear(struct dt_mesh *m)
{
    free(m->half);
    free(m->leaving);
    *m = (struct dt_mesh){.free_list = DT_NONE, .hull = DT_NONE};
}

enum dt_status dt_mesh_reserve(struct dt_mesh *m, uint32_t verts, uint32_t tris)
{
    if (verts > m->vert_cap) {
        uint32_t *leaving = realloc(m->leaving, verts * sizeof *leaving);
        if (leaving == NULL)
            return DT_NOMEM;
        m->leaving = leaving;
        m->vert_cap = verts;
    }
    if (tris > m->tri_cap) {
        uint32_t *half = realloc(m->half, (size_t)tris * 8 * sizeof *half);
        if (half == NULL)
            return DT_NOMEM;
        m->half = half;
        m->tri_cap = tris;
    }
    return DT_OK;
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
