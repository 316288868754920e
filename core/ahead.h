/* ahead.h - the walks to several places side by side, for questions (dt_fetch_places) and batches. */
#ifndef DT_AHEAD_H
#define DT_AHEAD_H

#include "core/set.h"

/* Sets p[].near, and fetches what lies around each place. n <= DT_AHEAD. */
void dt_walk_to_places(const struct dt *t, struct dt_place *p, size_t n);

#endif
