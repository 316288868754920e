/* update.h - edits of a set: its points, and if it is live its triangulation, change together. */
#pragma once

#include "core/set/set.h"

/* Whether a batch of n edits is so large that a rebuild is cheaper (measured: tests/bench). */
bool dt_is_large_batch(const struct dt *t, size_t n);

/* As dt_add_many (of valid points, one after the other), dt_delete_many (of ascending distinct live ids) and dt_move_to.
 * A failure leaves the set as it was, with one exception. A large batch, or a batch that is out of memory, may be too
 * expensive to undo vertex by vertex. Then the points are as they were, and the set awaits a rebuild
 * (t->current is false). Cost: a small constant per point, expected. */
enum dt_status dt_update_add(struct dt *t, const struct dt_point *q, size_t n, struct dt_stop *work,
                             struct dt_added *out);
enum dt_status dt_update_delete(struct dt *t, const uint32_t *ids, size_t n, struct dt_stop *work,
                                bool disposable);

/* As dt_update_add, for a batch that is small beside a set that has no grid. Searches walk from one point of the batch to the next, which
 * is cheaper than a grid if the points are near each other. If walks are long, it makes the grid after all. */
enum dt_status dt_update_add_walking(struct dt *t, const struct dt_point *q, size_t n,
                                     struct dt_stop *work, struct dt_added *out);
enum dt_status dt_update_move(struct dt *t, uint32_t id, struct dt_point to, struct dt_stop *work);

/* Moves vertex v, without aliases, if its star allows that with the fixed edges that it has, which are the constraints of
 * its own, to its new place; *moved. */
enum dt_status dt_update_shift(struct dt *t, uint32_t v, struct dt_point to, struct dt_stop *work,
                               bool *moved);

/* Takes the last n points back, which are no ends: dt_take_back without their values. */
void dt_update_take_back(struct dt *t, uint32_t n);

/* dt_add_many within an edit that has begun (dt_views_edit_begin). */
enum dt_status dt_update_add_many(struct dt *t, const struct dt_point *p, size_t n,
                                  const struct dt_options *opt, struct dt_added *out);

/* Prefetches what the deletion or a move of vertex v reads first; its triangles are probably where a build has put
 * them. */
void dt_update_fetch(const struct dt *t, uint32_t v);
