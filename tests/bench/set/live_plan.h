/* live_plan.h - the operations of the live bench, the same for us and for the peer. */
#pragma once

#include "core/delaunay.h"

enum live_kind {
    LIVE_INSERT,
    LIVE_BATCH,
    LIVE_DELETE,
    LIVE_MOVE,
    LIVE_LOCATE,
    LIVE_NEAREST,
    LIVE_KINDS
};

extern const char *const live_names[LIVE_KINDS];

/* n initial points and k operations of each kind; arrays have k elements unless noted. */
struct live_plan {
    size_t n, k;
    struct dt_point *start; /* n */
    struct dt_point *query; /* places to locate, to find the nearest of, to insert */
    struct dt_point *batch; /* to be inserted at once */
    uint32_t *victim;       /* distinct ids to delete */
    uint32_t *mover;        /* ids to move, */
    struct dt_point *moved; /* by a tenth of the mean distance of neighbouring points */
};

struct live_plan live_plan_new(size_t n, size_t k);
void live_plan_free(struct live_plan *p);

double live_ns(double start, size_t k); /* since start (measure_cpu), per operation */
void live_keep(
    uint32_t value); /* uses a value, so that the compiler does not remove its computation */
