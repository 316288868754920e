/* prefetch.h - walks side by side, which prefetch what several queries (dt_fetch_places, dt_fetch_ids) or edits
 * (dt_fetch_edits, and those of a batch) will read. */
#pragma once

#include "core/set/set.h"

/* The purpose of a place: an answer, for which the nearest corner is found and what is around it is fetched, or an
 * insertion, for which the triangle is enough. */
enum dt_place_use { DT_PLACE_READ, DT_PLACE_INSERT };

/* To n <= DT_AHEAD places: sets p[].near. */
void dt_walk_to_places(const struct dt *t, struct dt_place *p, size_t n, enum dt_place_use use);

/* Fetches the data that an insertion into the triangle of the half edge h reads besides that triangle and its neighbours. */
void dt_fetch_around(const struct dt *t, uint32_t h);

/* The purpose of a star: the ids of its ring, or the removal of its vertex. */
enum dt_star_use { DT_STAR_READ, DT_STAR_REMOVE };

/* Around n <= DT_AHEAD vertices, which may include DT_NONE. */
void dt_walk_stars(const struct dt *t, const uint32_t *v, size_t n, enum dt_star_use use);
