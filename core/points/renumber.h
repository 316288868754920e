/* renumber.h - gives the vertices of a set the numbers that a build has chosen. */
#ifndef DT_RENUMBER_H
#define DT_RENUMBER_H

#include "core/points/points.h"

/* Renumbers the vertices, in a dense order without free ones: vertex v represents the point (*id)[v] at (*xy)[v]. There
 * may be new ids, which are reserved. Exchanges these arrays for those of *p. DT_NOMEM, DT_CANCELLED: nothing is
 * exchanged, and *p is as before, or, if it is disposable, to be freed. opt may be NULL: with no more vertices
 * than there have been, it cannot fail then. Cost: linear. */
enum dt_status dt_points_renumber(struct dt_points *p, struct dt_point **xy, uint32_t **id,
                                  uint32_t n, const struct dt_options *opt);

#endif
