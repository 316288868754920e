/* mend.c - see mend.h. */
#include "core/constraints/mend.h"

#include <stdlib.h>

#include "core/exact/predicates.h"
#include "core/memory/memory.h"
#include "core/mesh/diagonal.h"
#include "core/mesh/fixed.h"

void dt_suspects_clear(struct dt_suspects *s)
{
    free(s->half.v);
    *s = (struct dt_suspects){0};
}

void dt_suspect(struct dt_suspects *s, uint32_t h)
{
    if (dt_ids_append(&s->half, h) != DT_OK)
        s->lost = true;
}

bool dt_must_flip(const struct dt_mesh *m, const struct dt_point *xy, uint32_t h)
{
    uint32_t g = dt_twin(m, h);
    return !dt_is_fixed(m, h) && !dt_is_ghost(m, h) && !dt_is_ghost(m, g) &&
           dt_incircle_perturbed(xy[dt_origin(m, h)], xy[dt_origin(m, g)], xy[dt_apex_of(m, h)],
                                 xy[dt_apex_of(m, g)]) > 0;
}

void dt_flip_noting(struct dt_mesh *m, uint32_t h, const struct dt_changes *changes)
{
    uint32_t g = dt_twin(m, h);
    dt_changes_star(changes, dt_origin(m, h));
    dt_changes_star(changes, dt_origin(m, g));
    dt_changes_star(changes, dt_apex_of(m, h));
    dt_changes_star(changes, dt_apex_of(m, g));
    dt_flip(m, h);
}

static void flip(struct dt_mesh *m, uint32_t h, struct dt_suspects *s,
                 const struct dt_changes *changes)
{
    uint32_t g = dt_twin(m, h);
    dt_flip_noting(m, h, changes);
    m->recycled = true;
    dt_suspect(s, h);
    dt_suspect(s, dt_next(h));
    dt_suspect(s, g);
    dt_suspect(s, dt_next(g));
}

/* There was no memory for a suspect: flips every edge that is not Delaunay. */
static void look_everywhere(struct dt_mesh *m, const struct dt_point *xy, struct dt_suspects *s,
                            const struct dt_changes *changes)
{
    s->lost = false;
    for (uint32_t h = 0; h < 8 * m->tri_end; h = (h & 7) == 2 ? h + 6 : h + 1)
        if (!dt_is_dead(m, h) && dt_must_flip(m, xy, h))
            flip(m, h, s, changes);
}

void dt_mend(struct dt_mesh *m, const struct dt_point *xy, struct dt_suspects *s,
             const struct dt_changes *changes)
{
    do {
        if (s->lost)
            look_everywhere(m, xy, s, changes);
        while (s->half.n > 0) {
            uint32_t h = s->half.v[--s->half.n];
            if (dt_must_flip(m, xy, h))
                flip(m, h, s, changes);
        }
    } while (s->lost);
}
