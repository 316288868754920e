/* circumcentres.c - see circumcentres.h. */
#include "core/cells/circumcentres.h"

#include "core/cells/centre.h"

#include <string.h>

void dt_circumcentres_init(struct dt_circumcentres *c)
{
    memset(c->block, 0xff, sizeof c->block);
}

/* The corners of the records of a block that are triangles, neither ghosts nor dead. Returns their number. */
static uint32_t gather(const struct dt *t, uint32_t block, uint32_t record[DT_CENTRE_BLOCK],
                       struct dt_point corner[DT_CENTRE_BLOCK][3])
{
    uint32_t first = block * DT_CENTRE_BLOCK, n = 0;
    for (uint32_t i = 0; i < DT_CENTRE_BLOCK && first + i < t->mesh.tri_end; i++) {
        const uint32_t *v = t->mesh.half + 8 * (size_t)(first + i);
        if (v[2] >= DT_DEAD)
            continue;
        for (uint32_t k = 0; k < 3; k++)
            corner[n][k] = t->points.xy[v[k]];
        record[n++] = i;
    }
    return n;
}

void dt_circumcentres_find(struct dt_circumcentres *c, const struct dt *t, uint32_t block)
{
    struct dt_point corner[DT_CENTRE_BLOCK][3], spare;
    uint32_t record[DT_CENTRE_BLOCK], place = block % DT_CENTRE_BLOCKS;
    struct dt_point *at = c->at + (size_t)place * DT_CENTRE_BLOCK;
    uint32_t n = gather(t, block, record, corner);
    c->block[place] = block;
    for (uint32_t i = 0; i + 1 < n; i += 2)
        dt_centre_two(corner[i], corner[i + 1], &at[record[i]], &at[record[i + 1]]);
    if (n % 2 == 1)
        dt_centre_two(corner[n - 1], corner[n - 1], &at[record[n - 1]], &spare);
}
