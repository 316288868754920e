/* visited.h - a set of small numbers (vertices, triangles) that a search has seen: open addressing,
 * no allocation until it holds more than a few dozen. */
#pragma once

#include "core/delaunay.h"

enum { DT_VISITED_SMALL = 128 };

struct dt_visited {
    uint32_t *slot; /* small or owned; DT_NONE is empty */
    uint32_t n, bits;
    uint32_t small[DT_VISITED_SMALL];
};

/* An initialised set must not be moved: it may point into itself. It begins with less room where fewer keys are expected, since
 * a small search spends much of its time on emptying it. */
void dt_visited_init(struct dt_visited *s, size_t expected);
void dt_visited_clear(struct dt_visited *s);

/* Adds key (not DT_NONE); *fresh says whether it is new. DT_NOMEM leaves the set as it was. */
enum dt_status dt_visited_add(struct dt_visited *s, uint32_t key, bool *fresh);
