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

static void fetch_vertices(struct dt_vicinity *w, const struct dt_points *p, uint32_t v)
{
    uint32_t block = v / DT_BLOCK_VERTICES, first = block * DT_BLOCK_VERTICES;
    if (w->vertices[block % DT_BLOCKS] == block)
        return;
    w->vertices[block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < first + DT_BLOCK_VERTICES && i < p->end; i++) {
        if (i % 4 == 0)
            dt_fetch(&p->xy[i]);
        uint32_t page = p->id[i] / DT_FIELD_PAGE;
        if (page < w->s->pages && w->s->page[page] != NULL)
            dt_fetch(&w->s->page[page][p->id[i] % DT_FIELD_PAGE]);
    }
}

void dt_vicinity_fetch(struct dt_vicinity *w, const struct dt *t, uint32_t triangle)
{
    const struct dt_mesh *m = &t->mesh;
    uint32_t block = triangle / (8 * DT_BLOCK_TRIANGLES), first = block * DT_BLOCK_TRIANGLES;
    w->triangles[block % DT_BLOCKS] = block;
    for (uint32_t i = first; i < first + DT_BLOCK_TRIANGLES && i < m->tri_end; i += 2)
        dt_fetch(&m->half[8 * i]);
    for (uint32_t k = 0; k < 3; k++)
        if (m->half[triangle + k] != DT_NONE)
            fetch_vertices(w, &t->points, m->half[triangle + k]);
}
