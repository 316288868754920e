/* circumcentres.h - circumcentres of triangles, computed for a block of records at a time and kept for a while.
 *
 * Records of triangles, like vertices, are numbered in Morton order by a build. So a walk over the vertices in their order
 * needs the triangles of few blocks at a time, and computes each block about once. */
#ifndef DT_CIRCUMCENTRES_H
#define DT_CIRCUMCENTRES_H

#include "core/set/set.h"

enum {
    DT_CENTRE_BLOCK = 16,   /* records: eight cache lines */
    DT_CENTRE_BLOCKS = 2048 /* that are kept: half a megabyte of centres */
};

struct dt_circumcentres {
    struct dt_point at[DT_CENTRE_BLOCKS * DT_CENTRE_BLOCK];
    uint32_t block[DT_CENTRE_BLOCKS]; /* which one is kept here; DT_NONE: none */
};

/* Nothing is kept. To be called again when the set has been edited. */
void dt_circumcentres_init(struct dt_circumcentres *c);

void dt_circumcentres_find(struct dt_circumcentres *c, const struct dt *t, uint32_t block);

/* That of the triangle of the half edge, which has three corners; until the next call. */
static inline const struct dt_point *dt_circumcentre(struct dt_circumcentres *c, const struct dt *t,
                                                     uint32_t half)
{
    uint32_t triangle = half / 8, block = triangle / DT_CENTRE_BLOCK;
    if (c->block[block % DT_CENTRE_BLOCKS] != block)
        dt_circumcentres_find(c, t, block);
    return &c->at[triangle % (DT_CENTRE_BLOCKS * DT_CENTRE_BLOCK)];
}

#endif
