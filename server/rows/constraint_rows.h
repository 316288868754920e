/* constraint_rows.h - the constraints of a set, as words for rows (ROW_CONSTRAINT, ROW_IDS). */
#pragma once

#include "core/delaunay.h"

/* Replaces *ids by the words of ROW_CONSTRAINT of the constraints that end at one of these ids. DT_TOOLONG: that takes more than opt->steps
 * steps, one for each; *ids is unchanged. */
enum dt_status constraint_rows_at(const struct dt *dt, const struct dt_options *opt,
                                  struct dt_ids *ids);

/* Appends the words of the constraints of the number, or of all if that is DT_NONE, in pieces as dt_constraints_read. */
enum dt_status constraint_rows_read(const struct dt *dt, const struct dt_view *view,
                                    uint32_t number, uint32_t *from, size_t steps,
                                    struct dt_ids *ids);

/* Appends the pairs of the edges that are parts of constraints. DT_TOOLONG as above: of edges. */
enum dt_status constraint_edges(const struct dt *dt, const struct dt_options *opt,
                                struct dt_ids *ids);
