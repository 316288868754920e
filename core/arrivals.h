/* arrivals.h - many points at once: which of them coincide with one another, or with those that are
 * there already, found without the table of places (core/places.h). */
#ifndef DT_ARRIVALS_H
#define DT_ARRIVALS_H

#include "core/points.h"

/* Whether n points are better added by dt_arrivals_add: with tolerance 0, if they are many beside
 * those of the set. */
bool dt_arrivals_suit(const struct dt_points *p, size_t n);

/* Adds n points for which there is room (dt_points_reserve), all or none, with the result that one
 * after the other would have; the table of places must be empty. pool may be NULL. DT_TOOSMALL: not
 * possible in this way, which chance alone does not bring about. Cost: O(n + vertices), and 12 bytes
 * for each of them meanwhile; taken off the work, which may be NULL. */
enum dt_status dt_arrivals_add(struct dt_points *p, const struct dt_point *q, uint32_t n,
                               const struct dt_pool *pool, struct dt_work *work,
                               struct dt_added *out);

/* DT_CORRUPT if two of the set's vertices, none of which is free, are at one place; DT_TOOSMALL as
 * above. Cost: O(vertices), and 12 bytes for each of them meanwhile. */
enum dt_status dt_arrivals_distinct(struct dt_points *p, struct dt_work *work);

#endif
