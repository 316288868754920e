/* renumber.h - the vertices of a set get the numbers that a build has found for them. */
#ifndef DT_RENUMBER_H
#define DT_RENUMBER_H

#include "core/points.h"

/* Renumbers the vertices: new vertex v is the old from[v], in a dense order without free ones.
 * Takes over xy, which holds the coordinates in the new order, and from, both with room for n, and
 * frees its own arrays. DT_NOMEM, DT_CANCELLED: it has taken over nothing, from[] is of no use, and *p is as before,
 * or, if it is disposable, to be freed. opt may be NULL. Cost: linear. */
enum dt_status dt_points_renumber(struct dt_points *p, struct dt_point *xy, uint32_t *from,
                                  uint32_t n, const struct dt_options *opt);

#endif
