/* crossings.h - where segments cross: every pair, and the place, rounded once.
 *
 * Two segments cross if either has the ends of the other on opposite sides. All signs are exact. */
#pragma once

#include "core/control/stop.h"

struct dt_segment {
    struct dt_point p, q;
    bool fresh; /* crossings of two that are not are known: there are none */
};

/* Pairs of numbers of segments, the lower one in the upper half. Start with {0}, and the most that there may be. */
struct dt_pairs {
    uint64_t *v; /* owns `cap` */
    size_t n, cap, most;
};

bool dt_segments_cross(const struct dt_segment *a, const struct dt_segment *b);

/* Puts the pairs that cross, at least one of them fresh, into *out, sorted. Some are found several times before
 * that; if there are more than `most`, DT_NOMEM. Cost: O(n log n) for short segments, and their
 * product for those that are in the same places. */
enum dt_status dt_crossings(const struct dt_segment *s, size_t n, struct dt_stop *work,
                            struct dt_pairs *out);

/* The place of the crossing of two segments that cross: each coordinate is the nearest one that dt_coordinate_ok accepts, ties to even. */
struct dt_point dt_crossing_place(const struct dt_segment *a, const struct dt_segment *b);
