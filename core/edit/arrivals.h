/* arrivals.h - adding many points at once: coincident points, new or existing, are found by sorting all of them
 * (divide.h), without the table of places (core/points/places.h). All vertices of the set are then in the order that a
 * build needs. */
#pragma once

#include "core/points/points.h"

/* Whether n points are better sorted than looked up one after the other: with tolerance 0, if they are many
 * compared with the set. */
bool dt_arrivals_suit(const struct dt_points *p, size_t n);

/* Adds n valid points that suit, all or none, with the result that adding them one after the other has. Cost: O(n +
 * vertices), and 26 bytes for each of them meanwhile. */
enum dt_status dt_arrivals_add(struct dt_points *p, const struct dt_point *q, size_t n,
                               const struct dt_options *opt, struct dt_added *out);

/* The same without new points: renumbers the set's vertices in that order; no vertex may be free. DT_CORRUPT: two of them
 * are at one place. */
enum dt_status dt_arrivals_sort(struct dt_points *p, const struct dt_options *opt);
