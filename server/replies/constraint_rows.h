/* constraint_rows.h - the constraints of a set, as words for rows (ROW_CONSTRAINT, ROW_IDS). */
#ifndef SERVER_CONSTRAINT_ROWS_H
#define SERVER_CONSTRAINT_ROWS_H

#include "core/delaunay.h"

/* Replaces *ids by the words of ROW_CONSTRAINT: of the constraints that end at one of these ids, or, if there are none, of the number, or
 * of all if that is DT_NONE. DT_TOOLONG: there are more constraints than opt->steps; *ids is unchanged. */
enum dt_status constraint_rows(const struct dt *dt, uint32_t number, const struct dt_options *opt,
                               struct dt_ids *ids);

/* Appends the pairs of the edges that are parts of constraints. DT_TOOLONG as above: of edges. */
enum dt_status constraint_edges(const struct dt *dt, const struct dt_options *opt,
                                struct dt_ids *ids);

#endif
