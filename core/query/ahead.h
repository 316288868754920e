/* ahead.h - walks side by side, which fetch what several questions (dt_fetch_places, dt_fetch_ids) or edits
 * of a batch are going to need. */
#ifndef DT_AHEAD_H
#define DT_AHEAD_H

#include "core/set/set.h"

/* To places: sets p[].near, and fetches what lies around each. n <= DT_AHEAD. */
void dt_walk_to_places(const struct dt *t, struct dt_place *p, size_t n);

/* What a star is wanted for: the ids of its ring, or a removal of its vertex. */
enum dt_star_use { DT_STAR_READ, DT_STAR_REMOVE };

/* Round n <= DT_AHEAD vertices, DT_NONE among them. */
void dt_walk_stars(const struct dt *t, const uint32_t *v, size_t n, enum dt_star_use use);

#endif
