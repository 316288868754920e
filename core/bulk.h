/* bulk.h - triangulates a whole set, by either engine. */
#ifndef DT_BULK_H
#define DT_BULK_H

#include "core/set.h"

/* Builds mesh and hints of t for its present points; vertices are renumbered into grid order. On
 * success t is current. Else (DT_NOMEM, DT_CANCELLED) t is as before, or to be freed (opt->disposable). */
enum dt_status dt_bulk_build(struct dt *t, const struct dt_options *opt);

#endif
