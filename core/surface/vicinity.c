/* vicinity.c - see vicinity.h. */
#include "core/surface/vicinity.h"

#include <stdlib.h>
#include <string.h>

enum dt_status dt_vicinity_init(struct dt_vicinity *w, const struct dt_surface *s)
{
    *w = (struct dt_vicinity){.s = s};
    w->triangles = malloc(2 * DT_BLOCKS * sizeof *w->triangles);
    if (w->triangles == NULL)
        return DT_NOMEM;
    memset(w->triangles, 0xff, 2 * DT_BLOCKS * sizeof *w->triangles);
    w->vertices = w->triangles + DT_BLOCKS;
    return DT_OK;
}

void dt_vicinity_clear(struct dt_vicinity *w)
{
    free(w->triangles);
    *w = (struct dt_vicinity){0};
}

void dt_vicinity_fetch_vertices(struct dt_vicinity *w, const struct dt *t, uint32_t block)
{
    const struct dt_points *p = &t->points;
    uint32_t first = block * DT_BLOCK_VERTICES;
    w->vertices[block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < first + DT_BLOCK_VERTICES && i < p->end; i += 4)
        dt_fetch(&p->xy[i]);
    for (uint32_t i = first; i < first + DT_BLOCK_VERTICES && i < p->end; i++)
        dt_fetch(dt_value_place(w->s, p->id[i]));
    for (uint32_t i = first + DT_BLOCK_VERTICES; i < first + 2 * DT_BLOCK_VERTICES && i < p->end;
         i += 16)
        dt_fetch(&p->id[i]);
}

void dt_vicinity_fetch_triangles(struct dt_vicinity *w, const struct dt *t, uint32_t block)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t first = block * DT_BLOCK_TRIANGLES;
    w->triangles[block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < first + DT_BLOCK_TRIANGLES && i < m->tri_end; i += 2)
        dt_fetch(&m->half[8 * i]);
}
