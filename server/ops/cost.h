/* cost.h - which work a reactor does itself. Work that takes longer than about 200 us goes to a worker,
 * because all other clients would wait meanwhile.
 *
 * If the amount of work is known in advance, it is estimated here, from measurements (tests/bench) with
 * a safety margin. The cost of searches and of single edits depends on the place: they are tried with a
 * limit on their steps (struct dt_options) and go to a worker if they exceed it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum cost_kind {
    COST_BUILD,  /* per point: a triangulation, or its check */
    COST_GRID,   /* per point: the grid for searches */
    COST_SURVEY, /* per point: the regions that borders enclose */
    COST_COPY,   /* per point: a copy of the set */
    COST_EDIT,   /* per point added or deleted */
    COST_SWEEP,  /* per point that a sweep reads */
    COST_FREE,   /* per KiB returned to the system */
    COST_PAGE    /* per page of a field that is summed up */
};

enum {
    COST_AT_ONCE_NS = 200 * 1000,
    COST_STEPS_AT_ONCE = 2000 /* of a search or an edit */
};

/* Whether a reactor does n units itself. */
static inline bool cost_at_once(enum cost_kind kind, size_t n)
{
    static const unsigned ns[] = {
        [COST_BUILD] = 400,  [COST_GRID] = 100, [COST_COPY] = 100, [COST_EDIT] = 2000,
        [COST_SURVEY] = 400, [COST_SWEEP] = 50, [COST_FREE] = 50,  [COST_PAGE] = 10};
    return n <= COST_AT_ONCE_NS / ns[kind];
}
