/* update.h - edits of a live set: its points and its triangulation change together. */
#ifndef DT_UPDATE_H
#define DT_UPDATE_H

#include "core/set.h"

/* Whether edits of t go through the functions below: it is triangulated and no rebuild is
 * pending. */
static inline bool dt_is_live(const struct dt *t)
{
    return t->triangulated && t->current;
}

/* Whether n edits at once are so many that a rebuild is cheaper (measured: tests/bench). */
bool dt_update_is_bulk(const struct dt *t, size_t n);

/* As dt_add, dt_delete (of ascending distinct live ids) and dt_move, for a live set; what they say
 * about failures holds. Should memory run out when the points are done and the mesh is not, the
 * edit succeeds, and the set awaits a rebuild (t->current is false). Cost: a small constant per
 * point, expected. */
enum dt_status dt_update_add(struct dt *t, const struct dt_point *q, size_t n,
                             struct dt_added *out);
enum dt_status dt_update_delete(struct dt *t, const uint32_t *ids, size_t n);
enum dt_status dt_update_move(struct dt *t, uint32_t id, struct dt_point to);

/* As dt_find, for edits: counts how far walks go, which tells that the grid has aged. */
enum dt_where dt_update_find(struct dt *t, struct dt_point q, uint32_t *half);

#endif
